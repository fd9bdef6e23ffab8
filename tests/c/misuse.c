/* Misuse of every arithmetic, and the name of every field that is refused. */

#include "check.h"
#include "words_f32.h"
#include "words_fixed.h"

#define A(name) name##_f32
#define F(name) vm_f32_##name
#define T(name) Vm##name##F32
#define W uint32_t
#define N float
#define Q float
#define Q_UNIT 1.0f
#define NUMBER 0.5f
#define PATH 0.16f
#define FAR 1.0f
#define FORCE_UNIT 1.0f
#define INPUT {0.5f, 0.16f, 20.0f}
#define BEYOND {1.5f, 0.16f, 20.0f}
#define STATE_WORDS VM_F32_STATE_WORDS
#define OTHER(name) vm_fixed_##name
#define WORDS deltoid_posterior_fes_f32_words
#define READ deltoid_posterior_fes_f32
#define OTHER_WORDS deltoid_posterior_fes_fixed_words
#include "misuse_rows.h"
#undef A
#undef F
#undef T
#undef N
#undef Q
#undef Q_UNIT
#undef NUMBER
#undef PATH
#undef FAR
#undef FORCE_UNIT
#undef INPUT
#undef BEYOND
#undef STATE_WORDS
#undef OTHER
#undef WORDS
#undef READ
#undef OTHER_WORDS

#define A(name) name##_fixed
#define F(name) vm_fixed_##name
#define T(name) Vm##name##Fixed
#define N int32_t
#define Q int32_t
#define Q_UNIT 65536
#define NUMBER 8388608
#define PATH 160000
#define FAR 1000000
#define FORCE_UNIT 1000
#define INPUT {160000, 500, 200}
#define BEYOND {160000, 1500, 200}
#define STATE_WORDS VM_FIXED_STATE_WORDS
#define OTHER(name) vm_f32_##name
#define WORDS deltoid_posterior_fes_fixed_words
#define READ deltoid_posterior_fes_fixed
#define OTHER_WORDS deltoid_posterior_fes_f32_words
#include "misuse_rows.h"

/* Fields of doubles. */
typedef struct {
    const char *name;
    size_t offset;
} Field;

#define OF(type, field) {#field, offsetof(type, field)}

static const Field of_muscle[] = {
    OF(VmMuscleParams, mass_kg), OF(VmMuscleParams, fascicle_length_m), OF(VmMuscleParams, tendon_length_m),
    OF(VmMuscleParams, max_path_length_m), OF(VmMuscleParams, recruitment_saturation),
};
static const Field of_elements[] = {
    OF(VmElements, tendon_stiffness), OF(VmElements, tendon_toe), OF(VmElements, tendon_slack_length),
    OF(VmElements, parallel_stiffness), OF(VmElements, parallel_toe), OF(VmElements, parallel_slack_length),
    OF(VmElements, parallel_viscosity), OF(VmElements, compression_strength), OF(VmElements, compression_steepness),
    OF(VmElements, compression_onset_length), OF(VmElements, specific_tension), OF(VmElements, density),
};
/* Two values of shortening and three of lengthening, all named by their array. */
static const Field of_fibers[] = {
    OF(VmFiber, fraction), OF(VmFiber, half_force_frequency), OF(VmFiber, minimum_frequency),
    OF(VmFiber, maximum_frequency), OF(VmFiber, force_length_width), OF(VmFiber, force_length_skewness),
    OF(VmFiber, force_length_roundness), OF(VmFiber, maximum_velocity), OF(VmFiber, shortening),
    OF(VmFiber, lengthening), OF(VmFiber, lengthening_velocity), OF(VmFiber, activation_scale),
    OF(VmFiber, activation_exponent), OF(VmFiber, activation_length_dependence), OF(VmFiber, rise_s),
    OF(VmFiber, rise_per_frequency_s), OF(VmFiber, fall_s), OF(VmFiber, fall_per_activation_s),
    OF(VmFiber, effective_length_time_s), OF(VmFiber, sag_resting_level), OF(VmFiber, sag_firing_level),
    OF(VmFiber, sag_time_s), OF(VmFiber, yield_depth), OF(VmFiber, yield_velocity), OF(VmFiber, yield_time_s),
};

#define COUNT(list) (sizeof list / sizeof list[0])

/* Every number that is none is refused by its field's name. */
static int names(void) {
    static VmMuscleF32 muscle;
    VmMuscleParams params;
    VmError error;
    /* No compiler folds this into an error. */
    volatile double zero = 0.0;
    const double none = zero / zero;
    size_t index;
    CHECK(COUNT(of_elements) * sizeof(double) == sizeof(VmElements));
    CHECK((COUNT(of_fibers) - 2 + 2 + 3 + 1) * sizeof(double) == sizeof(VmFiber));
#define NAMED(list, base, at)                                                                                         \
    for (index = 0; index < COUNT(list); index++) {                                                                  \
        params = deltoid_posterior();                                                                                \
        /* A fast type that yields as a slow one does. */                                                            \
        params.fibers[1].has_yield = 1;                                                                              \
        params.fibers[1].yield_depth = params.fibers[0].yield_depth;                                                 \
        params.fibers[1].yield_velocity = params.fibers[0].yield_velocity;                                           \
        params.fibers[1].yield_time_s = params.fibers[0].yield_time_s;                                               \
        *(double *)(void *)((unsigned char *)(base) + list[index].offset) = none;                                    \
        CHECK(vm_f32_build(&muscle, sizeof muscle, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_PARAMETER);      \
        CHECK(equal(error.field, list[index].name) && error.fiber == at && error.value != error.value);              \
    }
    NAMED(of_muscle, &params, -1)
    NAMED(of_elements, &params.elements, -1)
    NAMED(of_fibers, &params.fibers[1], 1)
    /* What is derived from a field is named after it. */
    params = deltoid_posterior();
    params.mass_kg = 1e-4;
    CHECK(vm_fixed_build(0, 0, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_NULL_POINTER);
    {
        static VmMuscleFixed fixed;
        CHECK(vm_fixed_build(&fixed, sizeof fixed, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_PARAMETER);
        CHECK(equal(error.field, "mass_kg: F0, N") && error.least == 1.0);
    }
    return 0;
}

static int others(void) {
    const VmMuscleParams params = deltoid_posterior();
    VmMuscleParams bad = params;
    VmDerived derived;
    VmError error;
    VmElements elements[2];
    CHECK(vm_version() == VM_VERSION);
    CHECK(vm_params_derive(&params, &derived, &error) == VM_RESULT_OK);
    CHECK(derived.max_isometric_force_n > 265.9 && derived.max_isometric_force_n < 266.1);
    CHECK(derived.path_domain_m[0] < derived.middle_path_m && derived.middle_path_m < derived.path_domain_m[1]);
    CHECK(vm_params_derive(0, &derived, &error) == VM_RESULT_NULL_POINTER);
    bad.elements.density = 1.0;
    CHECK(vm_params_derive(&bad, &derived, &error) == VM_RESULT_PARAMETER && equal(error.field, "density"));
    CHECK(vm_params_paper(0, 0, 0) == VM_RESULT_OK);
    CHECK(vm_params_human(elements, 0, 0, 0) == VM_RESULT_OK && elements[0].density > 1000.0);
    CHECK(vm_params_feline(elements, &bad.fibers[0], &bad.fibers[1], &bad.fibers[2]) == VM_RESULT_OK);
    CHECK(bad.fibers[0].rank == 1 && bad.fibers[1].rank == 2 && bad.fibers[2].rank == 3);
    CHECK(vm_params_paper((VmElements *)(void *)((unsigned char *)elements + 1), 0, 0) == VM_RESULT_ALIGNMENT);
    return 0;
}

/* Lines of this file are below 1000; those of the rows are told apart by 1000 and 2000. */
int misuse(void) {
    int line = misuse_f32();
    if (line) return 1000 + line;
    line = misuse_fixed();
    if (line) return 2000 + line;
    line = names();
    return line ? line : others();
}
