/* Both arithmetics and both modes, played the inputs that the test has written, and the controllers; the bits of every
   tick go out as little-endian words. Before that, everything that can be misused is. */

#include "check.h"
#include "inputs.h"

static VmMuscleF32 muscle_f32;
static VmMuscleFixed muscle_fixed;

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
    if (line == 0) line = control();
    for (uint32_t mode = VM_MODE_CONTINUOUS; line == 0 && mode <= VM_MODE_FES; mode++) {
        line = play_f32(mode);
        if (line == 0) line = play_fixed(mode);
    }
    if (line == 0) line = play_control();
    return platform_end(line);
}
