/* What can be misused in one arithmetic, and what comes of it. Before it is included, F(build) names a function,
   T(Muscle) a type, and PATH, FORCE, INPUT and BEYOND values of the arithmetic. */

static int A(misuse)(void) {
    static union {
        T(Muscle) muscle;
        unsigned char bytes[sizeof(T(Muscle))];
    } memory;
    static union {
        uint64_t aligned;
        unsigned char bytes[sizeof(VmMuscleParams) + 8];
    } crooked;
    T(Muscle) *const muscle = &memory.muscle;
    T(Muscle) *const odd = (T(Muscle) *)(void *)(memory.bytes + 1);
    const VmMuscleParams *const odd_params = (const VmMuscleParams *)(void *)(crooked.bytes + 4);
    const size_t size = sizeof memory;
    const VmMuscleParams params = deltoid_posterior();
    VmMuscleParams bad;
    const T(Input) input = INPUT, beyond = BEYOND;
    T(Input) inputs[2];
    T(Output) output, again;
    T(Output) outputs[2];
    T(Info) info;
    VmError error;
    W words[40], other_words[40];
    uint32_t coefficients, state, changed;
    size_t needed;
    unsigned index;

#define REFUSED(result, call) CHECK((call) == VM_RESULT_##result)
#define CROOKED(type, place) ((type *)(void *)((unsigned char *)(place) + 1))

    for (index = 0; index < sizeof crooked.bytes; index++) crooked.bytes[index] = 0;
    for (index = 0; index < size; index++) memory.bytes[index] = 0;
    inputs[0] = inputs[1] = input;

    /* Nothing was built. */
    REFUSED(NOT_BUILT, F(step)(muscle, &input, &output));
    REFUSED(NOT_BUILT, F(observe)(muscle, &output));
    REFUSED(NOT_BUILT, F(rest)(muscle, PATH));
    REFUSED(NOT_BUILT, F(info)(muscle, &info));
    REFUSED(NOT_BUILT, F(save)(muscle, words, 40));
    REFUSED(NOT_BUILT, F(restore)(muscle, words, 40));
    REFUSED(NOT_BUILT, F(checksums)(muscle, &coefficients, &state));
    /* Garbage. */
    for (index = 0; index < size; index++) memory.bytes[index] = (unsigned char)(0xa5 ^ (index * 7));
    REFUSED(NOT_BUILT, F(step)(muscle, &input, &output));
    REFUSED(NOT_BUILT, F(rest)(muscle, PATH));
    /* Null pointers. */
    REFUSED(NULL_POINTER, F(build)(0, size, &params, VM_MODE_FES, 1e-3, &error));
    REFUSED(NULL_POINTER, F(build)(muscle, size, 0, VM_MODE_FES, 1e-3, &error));
    REFUSED(NULL_POINTER, F(step)(0, &input, &output));
    REFUSED(NULL_POINTER, F(step)(muscle, 0, &output));
    REFUSED(NULL_POINTER, F(step)(muscle, &input, 0));
    REFUSED(NULL_POINTER, F(observe)(muscle, 0));
    REFUSED(NULL_POINTER, F(rest)(0, PATH));
    REFUSED(NULL_POINTER, F(info)(muscle, 0));
    REFUSED(NULL_POINTER, F(save)(muscle, 0, 40));
    REFUSED(NULL_POINTER, F(restore)(muscle, 0, 40));
    REFUSED(NULL_POINTER, F(checksums)(muscle, 0, &state));
    REFUSED(NULL_POINTER, F(checksums)(muscle, &coefficients, 0));
    REFUSED(NULL_POINTER, F(size)(2, VM_MODE_FES, 0));
    REFUSED(NULL_POINTER, F(fatigued)(0, NUMBER));
    /* Alignment. */
    REFUSED(ALIGNMENT, F(build)(odd, size, &params, VM_MODE_FES, 1e-3, &error));
    REFUSED(ALIGNMENT, F(build)(muscle, size, odd_params, VM_MODE_FES, 1e-3, &error));
    REFUSED(ALIGNMENT, F(build)(muscle, size, &params, VM_MODE_FES, 1e-3, CROOKED(VmError, &error)));
    REFUSED(ALIGNMENT, F(step)(odd, &input, &output));
    REFUSED(ALIGNMENT, F(step)(muscle, CROOKED(T(Input), inputs), &output));
    REFUSED(ALIGNMENT, F(step)(muscle, &input, CROOKED(T(Output), outputs)));
    REFUSED(ALIGNMENT, F(rest)(odd, PATH));
    REFUSED(ALIGNMENT, F(save)(muscle, CROOKED(W, words), 39));
    REFUSED(ALIGNMENT, F(restore)(muscle, CROOKED(W, words), 39));
    REFUSED(ALIGNMENT, F(checksums)(muscle, CROOKED(uint32_t, words), &state));
    /* Size and version. */
    CHECK(F(size)(2, VM_MODE_CONTINUOUS, &needed) == VM_RESULT_OK && needed <= size);
    REFUSED(SIZE, F(build)(muscle, needed - 8, &params, VM_MODE_CONTINUOUS, 1e-3, &error));
    CHECK(equal(error.field, "size") && error.value == (double)(needed - 8) && error.least == (double)needed);
    REFUSED(SIZE, F(build)(muscle, 0, &params, VM_MODE_FES, 1e-3, 0));
    bad = params;
    bad.version = VM_VERSION + 1;
    REFUSED(VERSION, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, &error));
    /* Kinds that there are not. */
    REFUSED(PARAMETER, F(build)(muscle, size, &params, 4, 1e-3, &error));
    CHECK(equal(error.field, "mode") && error.value == 4.0);
    REFUSED(PARAMETER, F(size)(7, VM_MODE_FES, &needed));
    bad = params;
    bad.fiber_count = 7;
    REFUSED(PARAMETER, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, &error));
    CHECK(equal(error.field, "fiber_count") && error.value == 7.0 && error.fiber == -1);
    /* Parameters, named with value and limits. */
    bad = params;
    bad.mass_kg = -1.0;
    REFUSED(PARAMETER, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, &error));
    CHECK(equal(error.field, "mass_kg") && error.fiber == -1 && error.value == -1.0 && error.least == 1e-5);
    bad = params;
    bad.accuracy_class = 3;
    REFUSED(PARAMETER, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, &error));
    CHECK(equal(error.field, "accuracy_class") && error.value == 3.0 && error.most == 2.0);
    bad = params;
    bad.fibers[1].has_sag = 7;
    REFUSED(PARAMETER, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, &error));
    CHECK(equal(error.field, "has_sag") && error.fiber == 1 && error.value == 7.0 && error.most == 1.0);
    REFUSED(PARAMETER, F(build)(muscle, size, &params, VM_MODE_FES, 1.0, 0));
    REFUSED(PARAMETER, F(build)(muscle, size, &params, VM_MODE_FES, 1.0, &error));
    CHECK(equal(error.field, "time_step_s") && error.value == 1.0);
    /* None of that has built a muscle. */
    REFUSED(NOT_BUILT, F(step)(muscle, &input, &output));

    /* Stepped before it has a state. */
    REFUSED(OK, F(build)(muscle, size, &params, VM_MODE_FES, 1e-3, &error));
    REFUSED(NOT_RESTED, F(step)(muscle, &input, &output));
    REFUSED(NOT_RESTED, F(observe)(muscle, &output));
    REFUSED(NOT_RESTED, F(save)(muscle, words, 40));
    REFUSED(NOT_RESTED, F(checksums)(muscle, &coefficients, &state));
    REFUSED(PARAMETER, F(rest)(muscle, FAR));
    REFUSED(NOT_RESTED, F(step)(muscle, &input, &output));
    REFUSED(OK, F(info)(muscle, &info));
    CHECK(info.fiber_count == 2 && info.mode == VM_MODE_FES && info.accuracy_class == VM_CLASS_STANDARD);
    CHECK(info.state_words == STATE_WORDS);
    CHECK(info.max_isometric_force > 265 * FORCE_UNIT && info.max_isometric_force < 267 * FORCE_UNIT);
    CHECK(info.shortest_path < PATH && info.longest_path > PATH);
    REFUSED(OK, F(rest)(muscle, info.shortest_path));
    REFUSED(OK, F(rest)(muscle, info.longest_path));
    REFUSED(OK, F(rest)(muscle, PATH));
    /* Curves. */
    {
        T(FiberCurves) of_fiber;
        T(ElementCurves) of_elements;
        REFUSED(OK, F(fiber_curves)(muscle, 0, 2 * NUMBER, 0, 2 * NUMBER, &of_fiber));
        CHECK(of_fiber.force_length > 2 * NUMBER * 99 / 100 && of_fiber.force_velocity > 2 * NUMBER * 99 / 100);
        CHECK(of_fiber.activation_frequency > NUMBER / 4 && of_fiber.activation_frequency < 2 * NUMBER);
        REFUSED(PARAMETER, F(fiber_curves)(muscle, 2, 2 * NUMBER, 0, NUMBER, &of_fiber));
        REFUSED(NULL_POINTER, F(fiber_curves)(muscle, 0, NUMBER, 0, NUMBER, 0));
        REFUSED(OK, F(element_curves)(muscle, 2 * NUMBER, PATH, &of_elements));
        CHECK(of_elements.parallel >= 0 && of_elements.compression <= 0 && of_elements.tendon > NUMBER);
        REFUSED(NULL_POINTER, F(element_curves)(muscle, NUMBER, PATH, 0));
    }
    /* Functions of another arithmetic. */
    REFUSED(NOT_BUILT, OTHER(checksums)((void *)muscle, &coefficients, &state));
    /* What a muscle cannot be in leaves it as it was. */
    REFUSED(OK, F(checksums)(muscle, &coefficients, &state));
    REFUSED(PARAMETER, F(rest)(muscle, FAR));
    REFUSED(SIZE, F(save)(muscle, words, info.state_words - 1));
    REFUSED(OK, F(save)(muscle, words, info.state_words));
    REFUSED(SIZE, F(restore)(muscle, words, info.state_words - 1));
    words[2] = (W)~(W)0 >> 1;
    REFUSED(STATE, F(restore)(muscle, words, info.state_words));
    CHECK(F(checksums)(muscle, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    /* Saved and restored, it goes on with the same bits. */
    REFUSED(OK, F(save)(muscle, words, 40));
    CHECK(F(step)(muscle, &input, &output) == VM_RESULT_OK && output.status == 0);
    CHECK(F(checksums)(muscle, &coefficients, &changed) == VM_RESULT_OK && changed != state);
    REFUSED(OK, F(observe)(muscle, &again));
    CHECK(again.relative_force == output.relative_force && again.fascicle_length == output.fascicle_length);
    REFUSED(OK, F(restore)(muscle, words, 40));
    CHECK(F(checksums)(muscle, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    /* Outputs may share a place. */
    REFUSED(OK, F(checksums)(muscle, &changed, &changed));
    CHECK(changed == state);
    /* Out of range is clipped, and said. */
    REFUSED(OK, F(step)(muscle, &beyond, &output));
    CHECK(output.status == VM_STATUS_ACTIVATION_CLIPPED);
    /* Built again, it has no state, and refuses that of another muscle, mode or time step. */
    bad = params;
    bad.mass_kg *= 1.01;
    REFUSED(OK, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, 0));
    REFUSED(NOT_RESTED, F(step)(muscle, &input, &output));
    REFUSED(OTHER_MUSCLE, F(restore)(muscle, words, 40));
    REFUSED(OK, F(build)(muscle, size, &params, VM_MODE_CONTINUOUS, 1e-3, 0));
    REFUSED(OTHER_MUSCLE, F(restore)(muscle, words, 40));
    REFUSED(OK, F(build)(muscle, size, &params, VM_MODE_FES, 5e-4, 0));
    REFUSED(OTHER_MUSCLE, F(restore)(muscle, words, 40));
    /* A build that is refused leaves the muscle that was there. */
    REFUSED(OK, F(build)(muscle, size, &params, VM_MODE_FES, 1e-3, 0));
    REFUSED(OK, F(restore)(muscle, words, 40));
    bad.mass_kg = 0.0;
    REFUSED(PARAMETER, F(build)(muscle, size, &bad, VM_MODE_FES, 1e-3, 0));
    REFUSED(OK, F(step)(muscle, &input, &output));

    /* Words: a muscle from them has the bits of a built one. */
    {
        uint32_t copy[sizeof WORDS / sizeof WORDS[0] + 1], read, stepped;
        const size_t count = sizeof WORDS / sizeof WORDS[0];
#define TAKE(words, count, types, mode, class, tick)                                                                  \
    F(from_words)(muscle, size, words, count, types, mode, class, tick, &error)
#define DIFFERS(name, found, wanted)                                                                                  \
    CHECK(equal(error.field, "words: " name) && error.value == (found) && error.least == (wanted) &&                  \
          error.most == (wanted) && error.fiber == -1)
        REFUSED(OK, F(build)(muscle, size, &params, VM_MODE_FES, 1e-3, 0));
        REFUSED(OK, F(rest)(muscle, PATH));
        for (index = 0; index < 300; index++) REFUSED(OK, F(step)(muscle, &input, &output));
        REFUSED(OK, F(checksums)(muscle, &coefficients, &state));
        REFUSED(OK, READ(muscle, size, &error));
        REFUSED(NOT_RESTED, F(step)(muscle, &input, &output));
        REFUSED(OK, F(rest)(muscle, PATH));
        for (index = 0; index < 300; index++) REFUSED(OK, F(step)(muscle, &input, &output));
        REFUSED(OK, F(checksums)(muscle, &read, &stepped));
        CHECK(read == coefficients && stepped == state && output.relative_force > 0);
        REFUSED(OK, F(info)(muscle, &info));
        CHECK(info.mode == VM_MODE_FES && info.accuracy_class == VM_CLASS_STANDARD && info.fiber_count == 2);
        /* What is refused leaves the muscle that was there. */
        for (index = 0; index < count; index++) copy[index] = WORDS[index];
        copy[count] = 0;
        REFUSED(NULL_POINTER, F(from_words)(0, size, WORDS, count, 2, VM_MODE_FES, 0, 1e-3, &error));
        REFUSED(NULL_POINTER, TAKE(0, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        REFUSED(ALIGNMENT, TAKE(CROOKED(uint32_t, copy), count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        REFUSED(ALIGNMENT, F(from_words)(odd, size, WORDS, count, 2, VM_MODE_FES, 0, 1e-3, &error));
        REFUSED(ALIGNMENT,
                F(from_words)(muscle, size, WORDS, count, 2, VM_MODE_FES, 0, 1e-3, CROOKED(VmError, &error)));
        REFUSED(SIZE, F(from_words)(muscle, 8, WORDS, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3, &error));
        CHECK(equal(error.field, "size") && error.value == 8.0);
        REFUSED(SIZE, TAKE(WORDS, (size_t)-1, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        REFUSED(PARAMETER, TAKE(WORDS, count, 7, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        CHECK(equal(error.field, "fiber_count") && error.value == 7.0);
        REFUSED(PARAMETER, TAKE(WORDS, count, 2, 9, VM_CLASS_STANDARD, 1e-3));
        CHECK(equal(error.field, "mode") && error.value == 9.0);
        REFUSED(PARAMETER, TAKE(WORDS, count, 2, VM_MODE_FES, 3, 1e-3));
        CHECK(equal(error.field, "accuracy_class") && error.value == 3.0);
        REFUSED(PARAMETER, TAKE(WORDS, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1.0));
        CHECK(equal(error.field, "time_step_s") && error.value == 1.0);
        REFUSED(WORDS, TAKE(OTHER_WORDS, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        CHECK(equal(error.field, "words: arithmetic") && error.value != error.least);
        REFUSED(WORDS, TAKE(WORDS, count, 2, VM_MODE_CONTINUOUS, VM_CLASS_STANDARD, 1e-3));
        DIFFERS("mode", VM_MODE_FES, VM_MODE_CONTINUOUS);
        REFUSED(WORDS, TAKE(WORDS, count, 2, VM_MODE_FES, VM_CLASS_FINE, 1e-3));
        DIFFERS("accuracy_class", VM_CLASS_STANDARD, VM_CLASS_FINE);
        REFUSED(WORDS, TAKE(WORDS, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 5e-4));
        CHECK(equal(error.field, "words: time_step_s") && error.value > 0.99e-3 && error.least < 0.51e-3);
        REFUSED(WORDS, TAKE(WORDS, count - 1, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        DIFFERS("count", (double)(count - 1), (double)count);
        REFUSED(WORDS, TAKE(copy, count + 1, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        DIFFERS("count", (double)(count + 1), (double)count);
        REFUSED(WORDS, TAKE(WORDS, 0, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        DIFFERS("count", 0.0, (double)count);
        for (index = 0; index < count; index++) {
            copy[index] ^= 1u << index % 32;
            REFUSED(WORDS, TAKE(copy, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
            copy[index] = WORDS[index];
        }
        CHECK(equal(error.field, "words: checksum") && error.value != error.least);
        copy[0]++;
        REFUSED(WORDS, F(from_words)(muscle, size, copy, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3, 0));
        REFUSED(WORDS, TAKE(copy, count, 2, VM_MODE_FES, VM_CLASS_STANDARD, 1e-3));
        CHECK(equal(error.field, "words: version") && error.value == error.least + 1.0);
        REFUSED(OK, F(checksums)(muscle, &read, &stepped));
        CHECK(read == coefficients && stepped == state);
#undef TAKE
#undef DIFFERS
    }
    /* Fatigue. */
    {
        static T(Fatigue) fatigue;
        VmFatigueParams tiring = {18.0, 30.0, 0.0, 0.6};
        N fitness, rested;
        REFUSED(NOT_BUILT, F(fatigue_advance)(&fatigue, &input, &fitness));
        REFUSED(NULL_POINTER, F(fatigue_build)(0, sizeof fatigue, &tiring, 1e-3, &error));
        REFUSED(SIZE, F(fatigue_build)(&fatigue, 8, &tiring, 1e-3, &error));
        tiring.recovery_time_s = 0.0;
        REFUSED(PARAMETER, F(fatigue_build)(&fatigue, sizeof fatigue, &tiring, 1e-3, &error));
        CHECK(equal(error.field, "recovery_time_s") && error.least == 1.0);
        tiring.recovery_time_s = 30.0;
        REFUSED(OK, F(fatigue_build)(&fatigue, sizeof fatigue, &tiring, 1e-3, &error));
        REFUSED(NULL_POINTER, F(fatigue_advance)(&fatigue, 0, &fitness));
        REFUSED(OK, F(fatigue_save)(&fatigue, other_words, 40));
        REFUSED(OK, F(fatigue_advance)(&fatigue, &input, &rested));
        for (index = 0; index < 1000; index++) REFUSED(OK, F(fatigue_advance)(&fatigue, &input, &fitness));
        CHECK(fitness < rested);
        again = output;
        REFUSED(OK, F(fatigued)(&output, fitness));
        CHECK(output.relative_force < again.relative_force);
        REFUSED(OK, F(fatigue_restore)(&fatigue, other_words, 40));
        REFUSED(OK, F(fatigue_advance)(&fatigue, &input, &fitness));
        CHECK(fitness == rested);
        REFUSED(OTHER_MUSCLE, F(fatigue_restore)(&fatigue, words, 40));
        REFUSED(SIZE, F(fatigue_restore)(&fatigue, other_words, 1));
        REFUSED(NOT_BUILT, OTHER(fatigue_save)((void *)&fatigue, other_words, 40));
        REFUSED(NOT_BUILT, F(checksums)((void *)&fatigue, &coefficients, &state));
    }
    /* Recruitment curve and inverse. */
    {
        static T(Curve) curve;
        static T(Steady) steady;
        VmCurveParams of_electrode = {4e-3, 12e-3, 200e-6, 2.0};
        T(SteadyOutput) held;
        N activation;
        Q answer;
        uint16_t flags;
        REFUSED(NOT_BUILT, F(curve_activation)(&curve, 16 * Q_UNIT, 200 * Q_UNIT, &activation, &flags));
        REFUSED(SIZE, F(curve_build)(&curve, 8, &of_electrode, 0));
        of_electrode.chronaxie_s = 0.0;
        REFUSED(PARAMETER, F(curve_build)(&curve, sizeof curve, &of_electrode, &error));
        CHECK(equal(error.field, "chronaxie_s") && error.value == 0.0);
        of_electrode.chronaxie_s = 200e-6;
        REFUSED(OK, F(curve_build)(&curve, sizeof curve, &of_electrode, &error));
        REFUSED(OK, F(curve_activation)(&curve, 16 * Q_UNIT, 200 * Q_UNIT, &activation, &flags));
        CHECK(flags == 0 && activation > NUMBER * 99 / 100 && activation < NUMBER * 101 / 100);
        REFUSED(OK, F(curve_amplitude_for)(&curve, activation, 200 * Q_UNIT, &answer, &flags));
        CHECK(flags == 0 && answer > 15 * Q_UNIT && answer < 17 * Q_UNIT);
        REFUSED(OK, F(curve_width_for)(&curve, activation, 16 * Q_UNIT, &answer, &flags));
        CHECK(flags == 0 && answer > 190 * Q_UNIT && answer < 210 * Q_UNIT);
        REFUSED(OK, F(curve_width_for)(&curve, activation, 1 * Q_UNIT, &answer, &flags));
        CHECK(flags == VM_PULSE_UNREACHABLE);
        REFUSED(OK, F(curve_checksum)(&curve, &state));
        REFUSED(NULL_POINTER, F(curve_checksum)(&curve, 0));
        REFUSED(NOT_BUILT, OTHER(curve_checksum)((void *)&curve, &state));
        REFUSED(NOT_BUILT, F(fatigue_save)((void *)&curve, other_words, 40));

        REFUSED(NOT_BUILT, F(steady_force)(&steady, &input, &held));
        REFUSED(SIZE, F(steady_build)(&steady, 8, &params, &error));
        REFUSED(OK, F(steady_build)(&steady, sizeof steady, &params, &error));
        REFUSED(OK, F(steady_activation_for)(&steady, 20 * FORCE_UNIT, &input, &held));
        CHECK(held.status == 0 && held.force > 19 * FORCE_UNIT && held.force < 21 * FORCE_UNIT);
        REFUSED(OK, F(steady_activation_for)(&steady, 900 * FORCE_UNIT, &input, &held));
        CHECK(held.status == VM_STATUS_FORCE_UNREACHABLE);
        REFUSED(OK, F(steady_force)(&steady, &input, &held));
        CHECK(held.force > 10 * FORCE_UNIT);
        REFUSED(ALIGNMENT, F(steady_force)(&steady, CROOKED(T(Input), inputs), &held));
    }
#undef REFUSED
#undef CROOKED
    return 0;
}
