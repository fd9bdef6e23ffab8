/* Both arithmetics and both modes, played the inputs that the test has written; the bits of every tick go out as
   little-endian words. Before that, everything that can be misused is. */

#include "inputs.h"
#include "vm_nostd.h"

/* What the platform has: a way out for bytes, and an end. */
void platform_write(const void *bytes, unsigned length);
int platform_end(int failed);

#define CHECK(condition) do { if (!(condition)) return __LINE__; } while (0)

static VmMuscleF32 muscle_f32;
static VmMuscleFixed muscle_fixed;

static VmMuscleParams deltoid_posterior(void) {
    VmMuscleParams params = {
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

static int equal(const char *text, const char *other) {
    while (*text && *text == *other) {
        text++;
        other++;
    }
    return *text == *other;
}

/* The line of the first misuse that was not refused; 0 if all were. */
static int misuse(void) {
    const VmMuscleParams params = deltoid_posterior();
    const VmInputF32 input = {0.5f, 0.16f, 20.0f};
    VmOutputF32 output;
    VmError error;
    VmStateF32 saved;
    uint32_t coefficients, state, changed;

    /* Nothing was built yet. */
    CHECK(vm_f32_step(&muscle_f32, &input, &output) == VM_RESULT_NOT_BUILT);
    CHECK(vm_f32_rest(&muscle_f32, 0.16f) == VM_RESULT_NOT_BUILT);
    CHECK(vm_f32_save(&muscle_f32, &saved) == VM_RESULT_NOT_BUILT);
    /* Null pointers. */
    CHECK(vm_f32_build(0, sizeof muscle_f32, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_NULL_POINTER);
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, 0, VM_MODE_FES, 1e-3, &error) == VM_RESULT_NULL_POINTER);
    CHECK(vm_f32_step(0, &input, &output) == VM_RESULT_NULL_POINTER);
    vm_params_paper(0, 0, 0);
    /* A header of another version. */
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32 - 8, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_SIZE);
    /* Parameters, named with value and limits. */
    VmMuscleParams bad = params;
    bad.mass_kg = -1.0;
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &bad, VM_MODE_FES, 1e-3, &error) == VM_RESULT_PARAMETER);
    CHECK(equal(error.field, "mass") && error.fiber == -1 && error.value == -1.0 && error.least == 1e-5);
    bad = params;
    bad.accuracy_class = 3;
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &bad, VM_MODE_FES, 1e-3, &error) == VM_RESULT_PARAMETER);
    CHECK(equal(error.field, "accuracy_class") && error.fiber == -1 && error.value == 3.0 && error.most == 2.0);
    bad = params;
    bad.fibers[1].has_sag = 7;
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &bad, VM_MODE_FES, 1e-3, &error) == VM_RESULT_PARAMETER);
    CHECK(equal(error.field, "has_sag") && error.fiber == 1 && error.value == 7.0 && error.most == 1.0);
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &params, 2, 1e-3, &error) == VM_RESULT_PARAMETER);
    CHECK(equal(error.field, "mode") && error.value == 2.0);
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &params, VM_MODE_FES, 1.0, 0) == VM_RESULT_PARAMETER);
    CHECK(vm_f32_step(&muscle_f32, &input, &output) == VM_RESULT_NOT_BUILT);

    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &params, VM_MODE_FES, 1e-3, &error) == VM_RESULT_OK);
    CHECK(vm_f32_rest(&muscle_f32, 0.16f) == VM_RESULT_OK);
    /* What a muscle cannot be in leaves it as it was. */
    CHECK(vm_f32_checksums(&muscle_f32, &coefficients, &state) == VM_RESULT_OK);
    CHECK(vm_f32_rest(&muscle_f32, 1.0f) == VM_RESULT_PARAMETER);
    CHECK(vm_f32_save(&muscle_f32, 0) == VM_RESULT_NULL_POINTER);
    CHECK(vm_f32_save(&muscle_f32, &saved) == VM_RESULT_OK);
    saved.words[1] = 0x7fc00000;
    CHECK(vm_f32_restore(&muscle_f32, &saved) == VM_RESULT_STATE);
    CHECK(vm_f32_checksums(&muscle_f32, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    /* Saved and restored, it goes on with the same bits. */
    CHECK(vm_f32_save(&muscle_f32, &saved) == VM_RESULT_OK);
    CHECK(vm_f32_step(&muscle_f32, &input, &output) == VM_RESULT_OK && output.status == 0);
    CHECK(vm_f32_checksums(&muscle_f32, &coefficients, &changed) == VM_RESULT_OK && changed != state);
    CHECK(vm_f32_restore(&muscle_f32, &saved) == VM_RESULT_OK);
    CHECK(vm_f32_checksums(&muscle_f32, &coefficients, &changed) == VM_RESULT_OK && changed == state);
    /* Another muscle, mode or time step refuses it. */
    static VmMuscleF32 other;
    VmMuscleParams heavier = params;
    heavier.mass_kg *= 1.01;
    CHECK(vm_f32_build(&other, sizeof other, &heavier, VM_MODE_FES, 1e-3, 0) == VM_RESULT_OK);
    CHECK(vm_f32_restore(&other, &saved) == VM_RESULT_OTHER_MUSCLE);
    CHECK(vm_f32_build(&other, sizeof other, &params, VM_MODE_CONTINUOUS, 1e-3, 0) == VM_RESULT_OK);
    CHECK(vm_f32_restore(&other, &saved) == VM_RESULT_OTHER_MUSCLE);
    CHECK(vm_f32_build(&other, sizeof other, &params, VM_MODE_FES, 5e-4, 0) == VM_RESULT_OK);
    CHECK(vm_f32_restore(&other, &saved) == VM_RESULT_OTHER_MUSCLE);
    CHECK(vm_f32_build(&other, sizeof other, &params, VM_MODE_FES, 1e-3, 0) == VM_RESULT_OK);
    CHECK(vm_f32_restore(&other, &saved) == VM_RESULT_OK);
    /* Out of range is clipped, and said. */
    const VmInputF32 beyond = {1.5f, 0.16f, 20.0f};
    CHECK(vm_f32_step(&muscle_f32, &beyond, &output) == VM_RESULT_OK);
    CHECK(output.status == VM_STATUS_ACTIVATION_CLIPPED);
    return 0;
}

static int play_f32(uint32_t mode) {
    const VmMuscleParams params = deltoid_posterior();
    CHECK(vm_f32_build(&muscle_f32, sizeof muscle_f32, &params, mode, 1e-3, 0) == VM_RESULT_OK);
    CHECK(vm_f32_rest(&muscle_f32, inputs_f32[0].path_length_m) == VM_RESULT_OK);
    for (unsigned tick = 1; tick < sizeof inputs_f32 / sizeof inputs_f32[0]; tick++) {
        VmOutputF32 output;
        CHECK(vm_f32_step(&muscle_f32, &inputs_f32[tick], &output) == VM_RESULT_OK);
        const uint32_t status = output.status;
        platform_write(&output, 16);
        platform_write(&status, 4);
    }
    return 0;
}

static int play_fixed(uint32_t mode) {
    const VmMuscleParams params = deltoid_posterior();
    CHECK(vm_fixed_build(&muscle_fixed, sizeof muscle_fixed, &params, mode, 1e-3, 0) == VM_RESULT_OK);
    CHECK(vm_fixed_rest(&muscle_fixed, inputs_fixed[0].path_length_um) == VM_RESULT_OK);
    for (unsigned tick = 1; tick < sizeof inputs_fixed / sizeof inputs_fixed[0]; tick++) {
        VmOutputFixed output;
        CHECK(vm_fixed_step(&muscle_fixed, &inputs_fixed[tick], &output) == VM_RESULT_OK);
        const uint32_t status = output.status;
        platform_write(&output, 16);
        platform_write(&status, 4);
    }
    return 0;
}

int main(void) {
    int line = misuse();
    for (uint32_t mode = VM_MODE_CONTINUOUS; line == 0 && mode <= VM_MODE_FES; mode++) {
        line = play_f32(mode);
        if (line == 0) line = play_fixed(mode);
    }
    return platform_end(line);
}
