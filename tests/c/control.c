/* Joint, prosthesis and FES controller of every arithmetic: misuse, and what they compute as little-endian words. */

#include "knee.h"

/* Ticks that are played; out of 8 every one after the other misses a sensor. */
#define TICKS 400

#define A(name) name##_f32
#define F(name) vm_f32_##name
#define T(name) Vm##name##F32
#define SIZE(thing) VM_##thing##_F32_SIZE
#define WORDS(thing) VM_##thing##_F32_WORDS
#define W uint32_t
#define N float
/* Numbers and amounts of 256ths. */
#define NUMBER(n) ((float)(n) / 256.0f)
#define AMOUNT(n) ((float)(n) / 256.0f)
#define OTHER(name) vm_fixed_##name
#include "control_rows.h"
#undef A
#undef F
#undef T
#undef SIZE
#undef WORDS
#undef N
#undef NUMBER
#undef AMOUNT
#undef OTHER

#define A(name) name##_fixed
#define F(name) vm_fixed_##name
#define T(name) Vm##name##Fixed
#define SIZE(thing) VM_##thing##_FIXED_SIZE
#define WORDS(thing) VM_##thing##_FIXED_WORDS
#define N int32_t
#define NUMBER(n) ((int32_t)(n) * 65536)
#define AMOUNT(n) ((int32_t)(n) * 256)
#define OTHER(name) vm_f32_##name
#include "control_rows.h"

/* Fields are refused by the names that the structs give them. */
static int names(void) {
    static VmFesF32 fes;
    static VmProsthesisF32 prosthesis;
    static VmJointF32 joint;
    VmError error;
#define NAMED(type, thing, change, name, at)                                                                          \
    do {                                                                                                              \
        type params = thing##_params();                                                                               \
        params.change;                                                                                                \
        CHECK(vm_f32_##thing##_build(&thing, sizeof thing, &params, 1e-3, &error) == VM_RESULT_PARAMETER);            \
        CHECK(equal(error.field, name) && error.muscle == (at));                                                      \
    } while (0)
#define FES(change, name, at) NAMED(VmFesParams, fes, change, name, at)
#define PROSTHESIS(change, name, at) NAMED(VmProsthesisParams, prosthesis, change, name, at)
    FES(range.least_rad = 9.0, "least_rad", -1);
    FES(range.most_rad = -9.0, "most_rad", -1);
    FES(muscles[1].mass_kg = 0.0, "mass_kg", 1);
    FES(muscles[1].fiber_count = 3, "fiber_count", 1);
    FES(muscles[0].fibers[1].rise_s = -1.0, "rise_s", 0);
    FES(paths[1].length_m = 0.0, "length_m", 1);
    FES(paths[0].length_m = 3.0, "length_m: shortest path in the joints' range, m", 0);
    FES(paths[0].reference_rad[0] = 9.0, "reference_rad", 0);
    FES(paths[0].terms[0][2] = 9.0, "terms", 0);
    FES(paths[1].action[0] = 4, "action", 1);
    FES(paths[1].action[0] = VM_ACTION_FLEXES, "terms: moment arm of a flexor, m", 1);
    FES(limb.inertia_kg_m2 = -1.0, "inertia_kg_m2", -1);
    FES(limb.damping_nm_s_per_rad = -1.0, "damping_nm_s_per_rad", -1);
    FES(limb.gravity_nm = -1.0, "gravity_nm", -1);
    FES(limb.hanging_angle_rad = 9.0, "hanging_angle_rad", -1);
    FES(electrodes[1].threshold_a = 0.0, "threshold_a", 1);
    FES(modulation[1].modulated = 2, "modulated", 1);
    FES(modulation[0].amplitude_a = 1.0, "amplitude_a", 0);
    FES(modulation[1].width_s = 1.0, "width_s", 1);
    FES(stimulation_frequency_pps = 0.0, "stimulation_frequency_pps", -1);
    FES(cocontraction_nm = -1.0, "cocontraction_nm", -1);
    FES(feedback.proportional = -1.0, "proportional", -1);
    FES(feedback.integral_per_s = -1.0, "integral_per_s", -1);
    FES(feedback.derivative_s = -1.0, "derivative_s", -1);
    FES(feedback.derivative_filter_s = 0.0, "derivative_filter_s", -1);
    FES(feedback.most_integral_nm = -1.0, "most_integral_nm", -1);
    FES(expected_lag_s = 0.0, "expected_lag_s", -1);
    FES(lead_filter_time_s = 0.0, "lead_filter_time_s", 0);
    FES(fatigue[0].recovery_time_s = 0.0, "recovery_time_s", 0);
    FES(has_fatigue[1] = 7, "has_fatigue", 1);
    FES(least_fitness = 0.0, "least_fitness", -1);
    FES(gain.time_s = 0.0, "time_s", -1);
    FES(gain.least_gain = 0.0, "least_gain", -1);
    FES(gain.most_gain = 0.0, "most_gain", -1);
    FES(gain.excitation_nm = 0.0, "excitation_nm", -1);
    FES(has_gain = 2, "has_gain", -1);
    FES(least_torque_nm = 1.0, "least_torque_nm", -1);
    FES(most_torque_nm = -1.0, "most_torque_nm", -1);
    FES(measured = 2, "measured", -1);
    PROSTHESIS(envelopes[1].rest_mv = -1.0, "rest_mv", 1);
    PROSTHESIS(envelopes[0].maximal_mv = 0.0, "maximal_mv", 0);
    PROSTHESIS(envelopes[1].cutoff_frequency_hz = 0.0, "cutoff_frequency_hz", 1);
    PROSTHESIS(envelopes[1].delay_s = 0.2, "delay_s", 1);
    PROSTHESIS(envelopes[1].shape = 1.0, "shape", 1);
    PROSTHESIS(torque.least_nm = -1e9, "least_nm", -1);
    PROSTHESIS(torque.most_nm = -1e9, "most_nm", -1);
    PROSTHESIS(torque.rate_nm_per_s = 0.0, "rate_nm_per_s", -1);
    PROSTHESIS(stiffness.least_nm_per_rad = -1e9, "least_nm_per_rad", -1);
    PROSTHESIS(stiffness.most_nm_per_rad = -1e9, "most_nm_per_rad", -1);
    PROSTHESIS(stiffness.rate_nm_per_rad_s = 0.0, "rate_nm_per_rad_s", -1);
#define JOINT(change, name, at)                                                                                       \
    do {                                                                                                              \
        VmJointParams params = joint_params();                                                                        \
        params.change;                                                                                                \
        CHECK(vm_f32_joint_build(&joint, sizeof joint, &params, &error) == VM_RESULT_PARAMETER);                      \
        CHECK(equal(error.field, name) && error.muscle == (at) && error.fiber == -1);                                 \
    } while (0)
    JOINT(angle_count = 0, "angle_count", -1);
    JOINT(angle_count = 3, "angle_count", -1);
    JOINT(muscle_count = 0, "muscle_count", -1);
    JOINT(muscle_count = 7, "muscle_count", -1);
    JOINT(muscles[1].path.action[0] = 9, "action", 1);
    JOINT(muscles[1].max_isometric_force_n = 0.0, "max_isometric_force_n", 1);
    JOINT(muscles[1].fascicle_length_m = 0.0, "fascicle_length_m", 1);
    JOINT(ranges[0].most_rad = 0.0, "most_rad", -1);
    return 0;
}

/* Presets, and a muscle on a path. */
static int presets(void) {
    VmAngleRange range[2];
    VmMuscleParams muscles[2];
    VmPath paths[2];
    VmJointMuscle muscle;
    VmDerived derived;
    VmError error;
    for (uint32_t preset = VM_PRESET_ANKLE; preset <= VM_PRESET_ELBOW; preset++) {
        CHECK(vm_joint_preset(preset, range, muscles, paths) == VM_RESULT_OK);
        CHECK(range[0].least_rad < range[0].most_rad);
        CHECK(paths[0].action[0] == VM_ACTION_FLEXES && paths[1].action[0] == VM_ACTION_EXTENDS);
        for (unsigned index = 0; index < 2; index++) {
            CHECK(vm_params_derive(&muscles[index], &derived, &error) == VM_RESULT_OK);
            CHECK(vm_joint_muscle(&muscles[index], &paths[index], &muscle, &error) == VM_RESULT_OK);
            CHECK(muscle.max_isometric_force_n == derived.max_isometric_force_n);
            CHECK(muscle.fascicle_length_m == muscles[index].fascicle_length_m);
        }
    }
    CHECK(vm_joint_preset(VM_PRESET_ELBOW, 0, 0, 0) == VM_RESULT_OK);
    CHECK(vm_joint_preset(3, range, muscles, paths) == VM_RESULT_PARAMETER);
    CHECK(vm_joint_preset(0, (VmAngleRange *)(void *)((unsigned char *)range + 1), muscles, paths) == VM_RESULT_ALIGNMENT);
    CHECK(vm_joint_muscle(0, paths, &muscle, &error) == VM_RESULT_NULL_POINTER);
    CHECK(vm_joint_muscle(muscles, 0, &muscle, &error) == VM_RESULT_NULL_POINTER);
    CHECK(vm_joint_muscle(muscles, paths, 0, &error) == VM_RESULT_NULL_POINTER);
    muscles[0].mass_kg = -1.0;
    CHECK(vm_joint_muscle(muscles, paths, &muscle, &error) == VM_RESULT_PARAMETER && equal(error.field, "mass_kg"));
    muscles[0].version = 0;
    CHECK(vm_joint_muscle(muscles, paths, &muscle, &error) == VM_RESULT_VERSION);
    return 0;
}

/* Lines of the rows are told apart by 3000 and 4000, those of this file by 5000. */
int control(void) {
    int line = control_f32();
    if (line) return 3000 + line;
    line = control_fixed();
    if (line) return 4000 + line;
    line = names();
    if (line == 0) line = presets();
    return line ? 5000 + line : 0;
}

int play_control(void) {
    int line = play_f32();
    return line ? line : play_fixed();
}
