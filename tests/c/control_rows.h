/* Joint, prosthesis and FES controller in one arithmetic. Before it is included, F(fes_build) names a function, T(Fes) a
   type, NUMBER(n) and AMOUNT(n) 256ths of the arithmetic, and OTHER(fes_step) a function of another. */

static int A(control)(void) {
    static T(Joint) joint;
    static T(Prosthesis) prosthesis;
    static T(Fes) fes, copy;
    static W words[WORDS(PROSTHESIS)], more[WORDS(FES) + 1];
    static union {
        uint64_t aligned[2];
        unsigned char bytes[16];
    } crooked;
    const VmJointParams of_joint = joint_params();
    const VmProsthesisParams of_prosthesis = prosthesis_params();
    const VmFesParams of_fes = fes_params();
    VmFesParams bad = of_fes;
    const T(ProsthesisInput) input = {{AMOUNT(64), AMOUNT(16)}, NUMBER(200)};
    const T(Target) target = {NUMBER(220), NUMBER(10), 0, 0};
    const T(Sensors) sensors = {NUMBER(200), 0};
    const N angles[2] = {NUMBER(100), NUMBER(100)}, ones[2] = {NUMBER(128), NUMBER(64)};
    T(ProsthesisCommand) command, again;
    T(FesCommand) pulses, other;
    T(Posture) posture;
    N torques[2];
    VmControlInfo info;
    VmError error;
    uint32_t coefficients, state, changed;
    size_t needed;
    unsigned index;

#define REFUSED(result, call) CHECK((call) == VM_RESULT_##result)

    /* Nothing was built: zeros, then garbage. */
    for (unsigned pass = 0; pass < 2; pass++) {
        REFUSED(NOT_BUILT, F(joint_posture)(&joint, angles, 1, &posture));
        REFUSED(NOT_BUILT, F(joint_checksum)(&joint, &state));
        REFUSED(NOT_BUILT, F(prosthesis_rest)(&prosthesis, NUMBER(200)));
        REFUSED(NOT_BUILT, F(prosthesis_step)(&prosthesis, &input, &command));
        REFUSED(NOT_BUILT, F(prosthesis_save)(&prosthesis, words, WORDS(PROSTHESIS)));
        REFUSED(NOT_BUILT, F(fes_start)(&fes, NUMBER(200)));
        REFUSED(NOT_BUILT, F(fes_step)(&fes, &target, &sensors, &pulses));
        REFUSED(NOT_BUILT, F(fes_info)(&fes, &info));
        REFUSED(NOT_BUILT, F(fes_restore)(&fes, more, WORDS(FES)));
        REFUSED(NOT_BUILT, F(fes_checksums)(&fes, &coefficients, &state));
        for (index = 0; index < sizeof fes; index++) ((unsigned char *)&fes)[index] = (unsigned char)(0xa5 ^ index);
        for (index = 0; index < sizeof joint; index++) ((unsigned char *)&joint)[index] = (unsigned char)(0xa5 ^ index);
    }
    /* Null pointers and alignment. */
    REFUSED(NULL_POINTER, F(joint_build)(0, sizeof joint, &of_joint, &error));
    REFUSED(NULL_POINTER, F(joint_build)(&joint, sizeof joint, 0, &error));
    REFUSED(NULL_POINTER, F(prosthesis_build)(0, sizeof prosthesis, &of_prosthesis, 1e-3, &error));
    REFUSED(NULL_POINTER, F(prosthesis_build)(&prosthesis, sizeof prosthesis, 0, 1e-3, &error));
    REFUSED(NULL_POINTER, F(fes_build)(0, sizeof fes, &of_fes, 1e-3, &error));
    REFUSED(NULL_POINTER, F(fes_build)(&fes, sizeof fes, 0, 1e-3, &error));
    REFUSED(NULL_POINTER, F(fes_size)(2, 0));
    REFUSED(NULL_POINTER, F(joint_size)(1, 2, 0));
#define CROOKED(type) ((type *)(void *)(crooked.bytes + 1))
    REFUSED(ALIGNMENT, F(joint_build)(CROOKED(T(Joint)), sizeof joint, &of_joint, &error));
    REFUSED(ALIGNMENT, F(prosthesis_build)(CROOKED(T(Prosthesis)), sizeof prosthesis, &of_prosthesis, 1e-3, &error));
    REFUSED(ALIGNMENT, F(fes_build)(CROOKED(T(Fes)), sizeof fes, &of_fes, 1e-3, &error));
    REFUSED(ALIGNMENT, F(fes_build)(&fes, sizeof fes, CROOKED(const VmFesParams), 1e-3, &error));
    REFUSED(ALIGNMENT, F(fes_build)(&fes, sizeof fes, &of_fes, 1e-3, CROOKED(VmError)));
    /* Sizes and numbers. */
    CHECK(F(joint_size)(1, 2, &needed) == VM_RESULT_OK && needed <= sizeof joint);
    REFUSED(SIZE, F(joint_build)(&joint, needed - 1, &of_joint, &error));
    CHECK(equal(error.field, "size") && error.least == (double)needed);
    CHECK(F(prosthesis_size)(2, &needed) == VM_RESULT_OK && needed <= sizeof prosthesis);
    REFUSED(SIZE, F(prosthesis_build)(&prosthesis, needed - 1, &of_prosthesis, 1e-3, &error));
    CHECK(F(fes_size)(2, &needed) == VM_RESULT_OK && needed <= sizeof fes);
    REFUSED(SIZE, F(fes_build)(&fes, needed - 1, &of_fes, 1e-3, &error));
    REFUSED(PARAMETER, F(joint_size)(3, 2, &needed));
    REFUSED(PARAMETER, F(joint_size)(2, 7, &needed));
    REFUSED(PARAMETER, F(fes_size)(7, &needed));
    REFUSED(PARAMETER, F(fes_build)(&fes, sizeof fes, &of_fes, 1.0, &error));
    CHECK(equal(error.field, "time_step_s") && error.muscle == -1);
    bad.muscles[1].version++;
    REFUSED(VERSION, F(fes_build)(&fes, sizeof fes, &bad, 1e-3, &error));
    REFUSED(NOT_BUILT, F(fes_step)(&fes, &target, &sensors, &pulses));

    /* A joint: counts, another arithmetic, NULL. */
    REFUSED(OK, F(joint_build)(&joint, sizeof joint, &of_joint, &error));
    REFUSED(SIZE, F(joint_posture)(&joint, angles, 0, &posture));
    REFUSED(NULL_POINTER, F(joint_posture)(&joint, 0, 1, &posture));
    REFUSED(NULL_POINTER, F(joint_posture)(&joint, angles, 1, 0));
    REFUSED(NOT_BUILT, OTHER(joint_checksum)((void *)&joint, &state));
    REFUSED(OK, F(joint_posture)(&joint, angles, 1, &posture));
    CHECK(posture.status == 0 && posture.muscles[0].moment_arms[0] > 0 && posture.muscles[1].moment_arms[0] < 0);
    CHECK(posture.muscles[0].moment_arms[1] == 0 && posture.muscles[2].path_length == 0);
    REFUSED(SIZE, F(joint_torques)(&joint, &posture, ones, 1, torques, 1));
    REFUSED(SIZE, F(joint_torques)(&joint, &posture, ones, 2, torques, 0));
    REFUSED(NULL_POINTER, F(joint_torques)(&joint, 0, ones, 2, torques, 1));
    REFUSED(OK, F(joint_torques)(&joint, &posture, ones, 2, torques, 1));
    /* 0.5 of 2,594 N at 29.3 mm against 0.25 of 5,699 N at about 40 mm. */
    CHECK(torques[0] < AMOUNT(-10 * 256) && torques[0] > AMOUNT(-30 * 256));
    REFUSED(SIZE, F(joint_stiffnesses)(&joint, &posture, ones, ones, 1, torques, 1));
    REFUSED(OK, F(joint_stiffnesses)(&joint, &posture, ones, ones, 2, torques, 1));

    /* A prosthesis. */
    REFUSED(OK, F(prosthesis_build)(&prosthesis, sizeof prosthesis, &of_prosthesis, 1e-3, &error));
    REFUSED(NOT_RESTED, F(prosthesis_step)(&prosthesis, &input, &command));
    REFUSED(NOT_RESTED, F(prosthesis_save)(&prosthesis, words, WORDS(PROSTHESIS)));
    REFUSED(NOT_RESTED, F(prosthesis_checksums)(&prosthesis, &coefficients, &state));
    REFUSED(NOT_BUILT, OTHER(prosthesis_rest)((void *)&prosthesis, 0));
    CHECK(F(prosthesis_info)(&prosthesis, &info) == VM_RESULT_OK && info.fiber_count == 2);
    CHECK(info.state_words == WORDS(PROSTHESIS));
    REFUSED(OK, F(prosthesis_rest)(&prosthesis, NUMBER(200)));
    REFUSED(NULL_POINTER, F(prosthesis_step)(&prosthesis, 0, &command));
    REFUSED(NULL_POINTER, F(prosthesis_step)(&prosthesis, &input, 0));
    for (index = 0; index < 100; index++) REFUSED(OK, F(prosthesis_step)(&prosthesis, &input, &command));
    CHECK(command.status == 0 && command.activations[0] > command.activations[1]);
    REFUSED(SIZE, F(prosthesis_save)(&prosthesis, words, WORDS(PROSTHESIS) - 1));
    REFUSED(OK, F(prosthesis_save)(&prosthesis, words, WORDS(PROSTHESIS)));
    REFUSED(OK, F(prosthesis_checksums)(&prosthesis, &coefficients, &state));
    REFUSED(OK, F(prosthesis_step)(&prosthesis, &input, &command));
    REFUSED(SIZE, F(prosthesis_restore)(&prosthesis, words, WORDS(PROSTHESIS) - 1));
    REFUSED(OK, F(prosthesis_restore)(&prosthesis, words, WORDS(PROSTHESIS)));
    CHECK(F(prosthesis_checksums)(&prosthesis, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    REFUSED(OK, F(prosthesis_step)(&prosthesis, &input, &again));
    CHECK(again.torque_nm == command.torque_nm && again.stiffness_nm_per_rad == command.stiffness_nm_per_rad);
    /* In fixed point a lag has two words. */
    words[1] = words[2] = (W)~(W)0 >> 1;
    REFUSED(STATE, F(prosthesis_restore)(&prosthesis, words, WORDS(PROSTHESIS)));

    /* An FES controller. */
    REFUSED(OK, F(fes_build)(&fes, sizeof fes, &of_fes, 1e-3, &error));
    REFUSED(NOT_RESTED, F(fes_step)(&fes, &target, &sensors, &pulses));
    REFUSED(NOT_RESTED, F(fes_save)(&fes, more, WORDS(FES)));
    REFUSED(NOT_RESTED, F(fes_checksums)(&fes, &coefficients, &state));
    REFUSED(NOT_BUILT, OTHER(fes_start)((void *)&fes, 0));
    REFUSED(NOT_BUILT, F(prosthesis_rest)((void *)&fes, 0));
    REFUSED(OK, F(fes_start)(&fes, NUMBER(200)));
    REFUSED(NULL_POINTER, F(fes_step)(&fes, 0, &sensors, &pulses));
    REFUSED(NULL_POINTER, F(fes_step)(&fes, &target, 0, &pulses));
    REFUSED(NULL_POINTER, F(fes_step)(&fes, &target, &sensors, 0));
    for (index = 0; index < 100; index++) REFUSED(OK, F(fes_step)(&fes, &target, &sensors, &pulses));
    CHECK(pulses.activations[0] > 0 && pulses.amplitude_ma[0] == AMOUNT(16 * 256) && pulses.width_us[0] > 0);
    CHECK(F(fes_info)(&fes, &info) == VM_RESULT_OK && info.state_words < WORDS(FES));
    REFUSED(SIZE, F(fes_save)(&fes, more, info.state_words - 1));
    REFUSED(OK, F(fes_save)(&fes, more, info.state_words));
    REFUSED(OK, F(fes_checksums)(&fes, &coefficients, &state));
    REFUSED(OK, F(fes_step)(&fes, &target, &sensors, &pulses));
    REFUSED(OK, F(fes_restore)(&fes, more, info.state_words));
    CHECK(F(fes_checksums)(&fes, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    /* A copy goes on with the same bits. */
    copy = fes;
    REFUSED(OK, F(fes_step)(&copy, &target, &sensors, &other));
    CHECK(other.torque_nm == pulses.torque_nm && other.width_us[0] == pulses.width_us[0]);
    /* Of another muscle, even where only the inverse knows it; built again, it has no state. */
    bad = of_fes;
    bad.muscles[1].fibers[0].force_length_width *= 1.01;
    REFUSED(OK, F(fes_build)(&fes, sizeof fes, &bad, 1e-3, &error));
    REFUSED(NOT_RESTED, F(fes_step)(&fes, &target, &sensors, &pulses));
    REFUSED(OTHER_MUSCLE, F(fes_restore)(&fes, more, info.state_words));
    /* A build that is refused leaves the controller that was there. */
    bad.cocontraction_nm = -1.0;
    REFUSED(OK, F(fes_start)(&fes, NUMBER(200)));
    REFUSED(PARAMETER, F(fes_build)(&fes, sizeof fes, &bad, 1e-3, 0));
    REFUSED(OK, F(fes_step)(&fes, &target, &sensors, &pulses));
#undef CROOKED
#undef REFUSED
    return 0;
}

/* Words of a command that has so many 32-bit ones before two flags of muscles and its own. */
#define WRITE(command, count)                                                                                         \
    do {                                                                                                              \
        const uint32_t flags[3] = {(command).muscles[0], (command).muscles[1], (command).status};                     \
        platform_write(&(command), 4 * (count));                                                                      \
        platform_write(flags, sizeof flags);                                                                          \
    } while (0)

static int A(play)(void) {
    static T(Joint) joint;
    static T(Prosthesis) prosthesis;
    static T(Fes) fes;
    const VmJointParams of_joint = joint_params();
    const VmProsthesisParams of_prosthesis = prosthesis_params();
    const VmFesParams of_fes = fes_params();
    CHECK(F(joint_build)(&joint, sizeof joint, &of_joint, 0) == VM_RESULT_OK);
    CHECK(F(prosthesis_build)(&prosthesis, sizeof prosthesis, &of_prosthesis, 1e-3, 0) == VM_RESULT_OK);
    CHECK(F(prosthesis_rest)(&prosthesis, NUMBER(200)) == VM_RESULT_OK);
    CHECK(F(fes_build)(&fes, sizeof fes, &of_fes, 1e-3, 0) == VM_RESULT_OK);
    CHECK(F(fes_start)(&fes, NUMBER(200)) == VM_RESULT_OK);
    for (int32_t tick = 0; tick < TICKS; tick++) {
        /* The last angles are beyond the knee's range. */
        const N angle = NUMBER(100 + tick);
        const T(ProsthesisInput) input = {{AMOUNT(tick * 37 % 129 - 64), AMOUNT(tick * 11 % 65 - 32)}, angle};
        const T(Target) target = {NUMBER(120 + tick), NUMBER(tick % 50), NUMBER(tick % 7), AMOUNT(tick % 300)};
        const T(Sensors) sensors = {angle, 0};
        const N forces[2] = {NUMBER(tick % 200), NUMBER(tick % 90)};
        T(ProsthesisCommand) command;
        T(FesCommand) pulses;
        T(Posture) posture;
        N found[2];
        CHECK(F(prosthesis_step)(&prosthesis, &input, &command) == VM_RESULT_OK);
        WRITE(command, 4);
        CHECK(F(fes_step)(&fes, &target, &sensors, &pulses) == VM_RESULT_OK);
        WRITE(pulses, 8);
        CHECK(F(joint_posture)(&joint, &angle, 1, &posture) == VM_RESULT_OK);
        CHECK(F(joint_torques)(&joint, &posture, forces, 2, &found[0], 1) == VM_RESULT_OK);
        CHECK(F(joint_stiffnesses)(&joint, &posture, forces, forces, 2, &found[1], 1) == VM_RESULT_OK);
        platform_write(found, sizeof found);
        for (unsigned muscle = 0; muscle < 2; muscle++) {
            platform_write(posture.muscles[muscle].moment_arms, 4);
            platform_write(posture.muscles[muscle].arm_slopes, 4);
        }
    }
    return 0;
}
#undef WRITE
