/* Parameters of a knee, for what uses joints and controllers. */

#pragma once

#include "check.h"

/* Knee, with feedback, fatigue of the flexor and an estimated gain. */
static inline VmFesParams fes_params(void) {
    VmFesParams params = {
        .limb = {0.3, 0.5, 15.0, 1.5},
        .electrodes = {{4e-3, 12e-3, 200e-6, 2.0}, {4e-3, 12e-3, 200e-6, 2.0}},
        .modulation = {{VM_MODULATE_WIDTH, 16e-3, 0.0}, {VM_MODULATE_AMPLITUDE, 0.0, 300e-6}},
        .stimulation_frequency_pps = 33.0,
        .cocontraction_nm = 1.0,
        .feedback = {30.0, 60.0, 2.0, 0.02, 20.0},
        .expected_lag_s = 0.1,
        .lead_filter_time_s = 0.03,
        .fatigue = {{18.0, 30.0, 0.2, 0.6}},
        .least_fitness = 0.3,
        .gain = {5.0, 0.3, 2.0, 2.0},
        .least_torque_nm = -80.0,
        .most_torque_nm = 60.0,
        .has_fatigue = {1, 0},
        .has_gain = 1,
    };
    vm_joint_preset(VM_PRESET_KNEE, &params.range, params.muscles, params.paths);
    return params;
}

static inline VmProsthesisParams prosthesis_params(void) {
    VmProsthesisParams params = {
        .envelopes = {{0.01, 0.51, 4.0, 0.0, 0.0}, {0.01, 0.51, 4.0, 0.03, -1.0}},
        .torque = {-400.0, 400.0, 1e5},
        .stiffness = {0.0, 2000.0, 1e6},
    };
    vm_joint_preset(VM_PRESET_KNEE, &params.range, params.muscles, params.paths);
    return params;
}

static inline VmJointParams joint_params(void) {
    VmJointParams params = {.version = VM_VERSION, .angle_count = 1, .muscle_count = 2};
    VmMuscleParams muscles[2];
    VmPath paths[2];
    vm_joint_preset(VM_PRESET_KNEE, &params.ranges[0], muscles, paths);
    for (unsigned index = 0; index < 2; index++) {
        vm_joint_muscle(&muscles[index], &paths[index], &params.muscles[index], 0);
    }
    return params;
}
