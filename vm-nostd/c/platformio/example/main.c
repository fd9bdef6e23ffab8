/* Half a second of a muscle; ends with 0 if its force is what a muscle of 266 N may hold. */

#include <stdio.h>
#include <vm_nostd.h>

int main(void) {
    static VmMuscleF32 muscle;
    VmMuscleParams params = {.version = VM_VERSION, .fiber_count = 2, .mass_kg = 97.5e-3, .fascicle_length_m = 0.11};
    VmOutputF32 output = {0};
    VmError error;
    params.tendon_length_m = 0.02;
    params.max_path_length_m = 0.184;
    params.recruitment_saturation = 0.8;
    vm_params_paper(&params.elements, &params.fibers[0], &params.fibers[1]);
    if (vm_f32_build(&muscle, sizeof muscle, &params, VM_MODE_FES, 1e-3, &error) != VM_RESULT_OK) {
        printf("%s = %g: must be between %g and %g\n", error.field, error.value, error.least, error.most);
        return 1;
    }
    vm_f32_rest(&muscle, 0.16f);
    for (int tick = 0; tick < 500; tick++) {
        const VmInputF32 input = {0.5f, 0.16f, 25.0f};
        if (vm_f32_step(&muscle, &input, &output) != VM_RESULT_OK) return 1;
    }
    printf("%.3f N, status %u\n", (double)output.force_n, (unsigned)output.status);
    return output.force_n > 20.0f && output.force_n < 266.0f && output.status == 0 ? 0 : 1;
}
