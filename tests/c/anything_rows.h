/* Any number in one arithmetic. Before it is included, ODD is one, INPUT an input of a muscle. */

static int A(anything)(void) {
    static T(Muscle) muscle;
    static T(Fatigue) fatigue;
    static T(Curve) curve;
    static T(Steady) steady;
    static T(Joint) joint;
    static T(Prosthesis) prosthesis;
    static T(Fes) fes;
    static W words[WORDS(PROSTHESIS)];
    const VmMuscleParams of_muscle = deltoid_posterior();
    const VmFatigueParams tiring = {18.0, 30.0, 0.0, 0.6};
    const VmCurveParams electrode = {4e-3, 12e-3, 200e-6, 2.0};
    const VmJointParams of_joint = joint_params();
    const VmProsthesisParams of_prosthesis = prosthesis_params();
    VmFesParams of_fes = fes_params();
    T(FiberCurves) of_fiber;
    T(ElementCurves) of_elements;
    T(Output) output;
    T(SteadyOutput) held;
    T(Posture) posture;
    T(ProsthesisCommand) command;
    T(FesCommand) pulses;
    N answer, found[2];
    uint16_t flags;
#define OK(call) CHECK((call) == VM_RESULT_OK)
#define SHARE(value) CHECK((value) >= 0 && (value) <= ONE)

    for (uint32_t mode = VM_MODE_CONTINUOUS; mode <= VM_MODE_FES; mode++) {
        OK(F(build)(&muscle, sizeof muscle, &of_muscle, mode, 1e-3, 0));
        OK(F(rest)(&muscle, PATH));
        for (unsigned index = 0; index < DRAWS / 4; index++) {
            const T(Input) input = INPUT;
            OK(F(step)(&muscle, &input, &output));
            CHECK(output.FORCE >= 0 && FINITE(output.FORCE) && FINITE(output.relative_force));
            CHECK(output.fascicle_length > 0 && FINITE(output.fascicle_length) && FINITE(output.fascicle_velocity));
            OK(F(save)(&muscle, words, STATE_WORDS));
            OK(F(restore)(&muscle, words, STATE_WORDS));
            OK(F(fiber_curves)(&muscle, 1, ODD, ODD, ODD, &of_fiber));
            SHARE(of_fiber.force_length);
            SHARE(of_fiber.activation_frequency);
            CHECK(of_fiber.force_velocity >= 0 && FINITE(of_fiber.force_velocity));
            OK(F(element_curves)(&muscle, ODD, ODD, &of_elements));
            OK(F(stiffness)(&muscle, &answer));
            CHECK(FINITE(answer));
            (void)F(rest)(&muscle, ODD);
        }
    }
    OK(F(fatigue_build)(&fatigue, sizeof fatigue, &tiring, 1e-3, 0));
    OK(F(curve_build)(&curve, sizeof curve, &electrode, 0));
    OK(F(steady_build)(&steady, sizeof steady, &of_muscle, 0));
    for (unsigned index = 0; index < DRAWS; index++) {
        const T(Input) input = INPUT;
        OK(F(fatigue_advance)(&fatigue, &input, &answer));
        SHARE(answer);
        OK(F(fatigue_save)(&fatigue, words, 4));
        OK(F(fatigue_restore)(&fatigue, words, 4));
        /* Also of what is no fitness. */
        OK(F(observe)(&muscle, &output));
        answer = ODD;
        CHECK(F(fatigued)(&output, answer) == (answer >= 0 && answer <= ONE ? VM_RESULT_OK : VM_RESULT_PARAMETER));
        CHECK(output.FORCE >= 0 && output.relative_force >= 0 && FINITE(output.FORCE));
        OK(F(curve_activation)(&curve, ODD, ODD, &answer, &flags));
        SHARE(answer);
        OK(F(curve_amplitude_for)(&curve, ODD, ODD, &answer, &flags));
        CHECK(answer >= 0 && FINITE(answer));
        OK(F(curve_width_for)(&curve, ODD, ODD, &answer, &flags));
        CHECK(answer >= 0 && FINITE(answer));
        OK(F(steady_force)(&steady, &input, &held));
        CHECK(held.force >= 0 && FINITE(held.force) && held.fascicle_length > 0);
        OK(F(steady_activation_for)(&steady, ODD, &input, &held));
        SHARE(held.activation);
    }

    OK(F(joint_build)(&joint, sizeof joint, &of_joint, 0));
    for (unsigned index = 0; index < DRAWS; index++) {
        const N angle = ODD, shares[2] = {ONE / 2, ONE / 4};
        OK(F(joint_posture)(&joint, &angle, 1, &posture));
        CHECK(posture.muscles[0].moment_arms[0] > 0 && posture.muscles[1].moment_arms[0] < 0);
        OK(F(joint_torques)(&joint, &posture, shares, 2, found, 1));
        CHECK(found[0] > TORQUE(-100) && found[0] < TORQUE(100));
    }
    OK(F(prosthesis_build)(&prosthesis, sizeof prosthesis, &of_prosthesis, 1e-3, 0));
    for (unsigned index = 0; index < DRAWS / 4; index++) {
        const T(ProsthesisInput) input = {{ODD, ODD}, ODD};
        if (index % 100 == 0) OK(F(prosthesis_rest)(&prosthesis, ODD));
        OK(F(prosthesis_step)(&prosthesis, &input, &command));
        CHECK(command.torque_nm >= TORQUE(-401) && command.torque_nm <= TORQUE(401));
        CHECK(command.stiffness_nm_per_rad >= 0 && command.stiffness_nm_per_rad <= TORQUE(2001));
        SHARE(command.activations[0]);
        SHARE(command.activations[1]);
        OK(F(prosthesis_save)(&prosthesis, words, WORDS(PROSTHESIS)));
        OK(F(prosthesis_restore)(&prosthesis, words, WORDS(PROSTHESIS)));
    }
    /* In fixed point 2 s over a filter of 0.02 s is refused for torques. */
    of_fes.feedback.derivative_s = 1.0;
    for (of_fes.measured = VM_MEASURED_ANGLE; of_fes.measured <= VM_MEASURED_TORQUE; of_fes.measured++) {
        OK(F(fes_build)(&fes, sizeof fes, &of_fes, 1e-3, 0));
        for (unsigned index = 0; index < DRAWS / 4; index++) {
            const T(Target) target = {ODD, ODD, ODD, ODD};
            const T(Sensors) sensors = {ODD, ODD};
            if (index % 100 == 0) OK(F(fes_start)(&fes, ODD));
            OK(F(fes_step)(&fes, &target, &sensors, &pulses));
            CHECK(pulses.torque_nm >= TORQUE(-81) && pulses.torque_nm <= TORQUE(61));
            CHECK(pulses.gain > 0 && pulses.gain <= 2 * ONE);
            for (unsigned muscle_index = 0; muscle_index < 2; muscle_index++) {
                SHARE(pulses.activations[muscle_index]);
                CHECK(pulses.amplitude_ma[muscle_index] >= 0 && FINITE(pulses.amplitude_ma[muscle_index]));
                CHECK(pulses.width_us[muscle_index] >= 0 && FINITE(pulses.width_us[muscle_index]));
            }
            OK(F(fes_save)(&fes, words, WORDS(FES)));
            OK(F(fes_restore)(&fes, words, WORDS(FES)));
        }
    }
#undef OK
#undef SHARE
    return 0;
}
