/* Muscles of one to six fibre types, of a library with the feature `types`: the words that
   vm-nostd/cores/src/bin/types.rs writes, too. */

#include "check.h"

#define TICKS 300
#define MOST 6

static VmMuscleParams params(uint32_t types) {
    VmMuscleParams params = {
        .version = VM_VERSION,
        .fiber_count = types,
        .mass_kg = 97.5e-3,
        .fascicle_length_m = 0.11,
        .tendon_length_m = 0.02,
        .max_path_length_m = 0.184,
        .recruitment_saturation = 0.8,
    };
    VmFiber *const fibers = params.fibers;
    vm_params_human(&params.elements, &fibers[0], &fibers[1], &fibers[3]);
    fibers[2] = fibers[1];
    fibers[4] = fibers[5] = fibers[3];
    for (uint32_t index = 0; index < types; index++) fibers[index].fraction = 1.0 / types;
    return params;
}

#define PLAY(arithmetic, Arithmetic, ARITHMETIC, first, ...)                                                          \
    static int play_##arithmetic(uint32_t types, uint32_t mode) {                                                     \
        static uint64_t memory[VM_MUSCLE_##ARITHMETIC##_BYTES(MOST) / 8];                                             \
        VmMuscle##Arithmetic *const muscle = (VmMuscle##Arithmetic *)(void *)memory;                                  \
        const VmMuscleParams of_muscle = params(types);                                                               \
        size_t size;                                                                                                  \
        CHECK(vm_##arithmetic##_size(types, mode, &size) == VM_RESULT_OK && size <= sizeof memory);                   \
        CHECK(vm_##arithmetic##_build(muscle, size - 8, &of_muscle, mode, 1e-3, 0) == VM_RESULT_SIZE);                \
        CHECK(vm_##arithmetic##_build(muscle, size, &of_muscle, mode, 1e-3, 0) == VM_RESULT_OK);                      \
        CHECK(vm_##arithmetic##_rest(muscle, first) == VM_RESULT_OK);                                                 \
        for (int tick = 0; tick < TICKS; tick++) {                                                                    \
            const VmInput##Arithmetic input = {__VA_ARGS__};                                                          \
            VmOutput##Arithmetic output;                                                                              \
            CHECK(vm_##arithmetic##_step(muscle, &input, &output) == VM_RESULT_OK);                                   \
            const uint32_t status = output.status;                                                                    \
            platform_write(&output, 16);                                                                              \
            platform_write(&status, 4);                                                                               \
        }                                                                                                             \
        return 0;                                                                                                     \
    }
PLAY(f32, F32, F32, 0.15625f, (float)(tick % 65) / 64.0f, 0.15625f + (float)(tick % 33) / 4096.0f,
     (float)(20 + tick % 16))
PLAY(fixed, Fixed, FIXED, 156250, 156250 + tick % 33 * 244, (uint16_t)(tick % 65 * 15), (uint16_t)(200 + tick % 16 * 10))

int main(void) {
    int line = 0;
    for (uint32_t types = 1; types <= MOST; types++) {
        for (uint32_t mode = VM_MODE_CONTINUOUS; line == 0 && mode <= VM_MODE_FES; mode++) line = play_f32(types, mode);
        for (uint32_t mode = VM_MODE_CONTINUOUS; line == 0 && mode <= VM_MODE_FES; mode++) line = play_fixed(types, mode);
    }
    return platform_end(line);
}
