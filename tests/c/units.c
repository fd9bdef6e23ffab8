/* Motor units, of a library with the feature `units`: rules of sizes, refusals, and a state that comes back. */

#include "check.h"

int units(void) {
    static uint64_t memory[VM_UNITS_F32_BYTES(2) / 8];
    static uint64_t fixed_memory[VM_UNITS_FIXED_BYTES(2) / 8];
    static VmMuscleF32 small;
    static const double sizes[3] = {1.0, 2.0, 3.0};
    static uint32_t words[1024];
    VmMuscleF32 *const muscle = (VmMuscleF32 *)(void *)memory;
    VmMuscleFixed *const fixed = (VmMuscleFixed *)(void *)fixed_memory;
    const VmMuscleParams params = deltoid_posterior();
    const VmInputF32 input = {0.4f, 0.16f, 0.0f};
    const VmInputFixed fixed_input = {160000, 400, 0};
    VmOutputF32 output, again;
    VmOutputFixed fixed_output;
    VmInfoF32 info;
    VmError error;
    VmUnits rules = {0};
    size_t size;
    rules.fibers[0].rule = VM_UNITS_GEOMETRIC;
    rules.fibers[0].count = 20;
    rules.fibers[0].growth = 0.05;
    rules.fibers[1].rule = VM_UNITS_LISTED;
    rules.fibers[1].count = 3;
    rules.fibers[1].sizes = sizes;

    for (uint32_t mode = VM_MODE_DISCRETE; mode <= VM_MODE_EFFECTIVE_LENGTH; mode++) {
        CHECK(vm_f32_size(2, mode, &size) == VM_RESULT_OK && size <= sizeof memory);
        CHECK(vm_fixed_size(2, mode, &size) == VM_RESULT_OK && size <= sizeof fixed_memory);
        CHECK(vm_f32_build_units(&small, sizeof small, &params, &rules, mode, 1e-3, &error) == VM_RESULT_SIZE);
        CHECK(vm_f32_build(muscle, sizeof memory, &params, mode, 1e-3, &error) == VM_RESULT_NULL_POINTER);
        rules.fibers[0].count = 62;
        CHECK(vm_f32_build_units(muscle, sizeof memory, &params, &rules, mode, 1e-3, &error) == VM_RESULT_PARAMETER);
        rules.fibers[0].count = 20;
        rules.fibers[0].rule = 4;
        CHECK(vm_f32_build_units(muscle, sizeof memory, &params, &rules, mode, 1e-3, &error) == VM_RESULT_PARAMETER);
        CHECK(equal(error.field, "rule") && error.fiber == 0 && error.value == 4.0);
        rules.fibers[0].rule = VM_UNITS_GEOMETRIC;
        rules.fibers[1].sizes = 0;
        CHECK(vm_f32_build_units(muscle, sizeof memory, &params, &rules, mode, 1e-3, 0) == VM_RESULT_NULL_POINTER);
        rules.fibers[1].sizes = sizes;
        CHECK(vm_f32_build_units(muscle, sizeof memory, &params, &rules, mode, 1e-3, &error) == VM_RESULT_OK);
        CHECK(vm_fixed_build_units(fixed, sizeof fixed_memory, &params, &rules, mode, 1e-3, &error) == VM_RESULT_OK);
        CHECK(vm_f32_step(muscle, &input, &output) == VM_RESULT_NOT_RESTED);
        CHECK(vm_f32_rest(muscle, 0.16f) == VM_RESULT_OK && vm_fixed_rest(fixed, 160000) == VM_RESULT_OK);
        for (unsigned tick = 0; tick < 300; tick++) {
            CHECK(vm_f32_step(muscle, &input, &output) == VM_RESULT_OK && output.status == 0);
            CHECK(vm_fixed_step(fixed, &fixed_input, &fixed_output) == VM_RESULT_OK && fixed_output.status == 0);
        }
        CHECK(output.force_n > 10.0f && output.force_n < 266.0f);
        /* 0.4 % of F0 is what fixed point promises. */
        CHECK(fixed_output.force_mn > (output.force_n - 1.1f) * 1e3f);
        CHECK(fixed_output.force_mn < (output.force_n + 1.1f) * 1e3f);
        CHECK(vm_f32_info(muscle, &info) == VM_RESULT_OK && info.mode == mode && info.state_words <= 1024);
        CHECK(vm_f32_save(muscle, words, info.state_words - 1) == VM_RESULT_SIZE);
        CHECK(vm_f32_save(muscle, words, 1024) == VM_RESULT_OK);
        CHECK(vm_f32_step(muscle, &input, &output) == VM_RESULT_OK);
        CHECK(vm_f32_restore(muscle, words, 1024) == VM_RESULT_OK);
        CHECK(vm_f32_step(muscle, &input, &again) == VM_RESULT_OK && again.force_n == output.force_n);
    }
    return 0;
}
