// A muscle stepped every millisecond; its force goes to the serial port.

#include <vm_nostd.h>

static VmMuscleFixed muscle;
static VmOutputFixed output;
static unsigned long next;

void setup() {
  Serial.begin(115200);
  // Static: it takes 1.5 KB.
  static VmMuscleParams params;
  params.version = VM_VERSION;
  params.fiber_count = 2;
  params.mass_kg = 97.5e-3;
  params.fascicle_length_m = 0.11;
  params.tendon_length_m = 0.02;
  params.max_path_length_m = 0.184;
  params.recruitment_saturation = 0.8;
  vm_params_paper(&params.elements, &params.fibers[0], &params.fibers[1]);
  VmError error;
  if (vm_fixed_build(&muscle, sizeof muscle, &params, VM_MODE_FES, 1e-3, &error) != VM_RESULT_OK) {
    Serial.println(error.field);
  }
  vm_fixed_rest(&muscle, 160000);
  next = millis();
}

void loop() {
  if (millis() - next < 1) return;
  next++;
  VmInputFixed input = {160000, 500, 250};
  // A muscle that was refused says so here.
  if (vm_fixed_step(&muscle, &input, &output) != VM_RESULT_OK) return;
  if (next % 100 == 0) Serial.println(output.force_mn);
}
