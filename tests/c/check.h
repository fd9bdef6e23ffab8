/* What the C programs share. */

#pragma once

#include "vm_nostd.h"

/* What the platform has: a way out for bytes, and an end. */
void platform_write(const void *bytes, unsigned length);
int platform_end(int failed);

/* The line of the first misuse that was not refused; 0 if all were. */
int misuse(void);
/* The same of joints and controllers; and what they compute, written. */
int control(void);
int play_control(void);
/* Any number in any input. */
int anything(void);

#define CHECK(condition) do { if (!(condition)) return __LINE__; } while (0)

/* The paper's validation muscle. */
static inline VmMuscleParams deltoid_posterior(void) {
    VmMuscleParams params = {
        .version = VM_VERSION,
        .fiber_count = 2,
        .mass_kg = 97.5e-3,
        .fascicle_length_m = 0.11,
        .tendon_length_m = 0.02,
        .max_path_length_m = 0.184,
        .recruitment_saturation = 0.8,
    };
    vm_params_paper(&params.elements, &params.fibers[0], &params.fibers[1]);
    params.fibers[0].fraction = 0.6;
    params.fibers[1].fraction = 0.4;
    return params;
}

static inline int equal(const char *text, const char *other) {
    while (*text && *text == *other) {
        text++;
        other++;
    }
    return *text == *other;
}
