//! Published joints.

use crate::choice::choice;
use crate::control::VM_ANTAGONISTS;
use crate::control::joint_params::{VmAngleRange, VmPath};
use crate::outcome::plain;
use crate::params::{VM_MAX_FIBERS, VM_VERSION, VmElements, VmFiber, VmMuscleParams};
use crate::pointer::Place;
use crate::result::VmResult;
use model::MuscleParams;
use model::control::{ANKLE, ELBOW, JointPreset, KNEE};

/// Tibialis anterior and soleus; 0 is a right angle between foot and shank, dorsiflexion positive.
pub const VM_PRESET_ANKLE: u32 = 0;
/// Hamstrings and quadriceps, with the hip held; 0 is the straight knee.
pub const VM_PRESET_KNEE: u32 = 1;
/// Biceps and triceps; 0 is the straight elbow.
pub const VM_PRESET_ELBOW: u32 = 2;

const PRESETS: [(u32, &JointPreset); 3] =
    [(VM_PRESET_ANKLE, &ANKLE), (VM_PRESET_KNEE, &KNEE), (VM_PRESET_ELBOW, &ELBOW)];

fn muscle_of(params: &MuscleParams<2>) -> VmMuscleParams {
    let fiber = |fiber: &model::FiberParams| VmFiber {
        fraction: fiber.fraction,
        ..VmFiber::of(&fiber.fiber_type)
    };
    let [slow, fast] = params.fibers.each_ref().map(fiber);
    // Those beyond `fiber_count` are not read.
    let mut fibers = [fast; VM_MAX_FIBERS];
    fibers[0] = slow;
    VmMuscleParams {
        version: VM_VERSION,
        accuracy_class: crate::params::VM_CLASS_STANDARD,
        fiber_count: 2,
        mass_kg: params.mass,
        fascicle_length_m: params.fascicle_length,
        tendon_length_m: params.tendon_length,
        max_path_length_m: params.max_path_length,
        recruitment_saturation: params.recruitment_saturation,
        elements: VmElements::from(&params.elements),
        fibers,
    }
}

/// Range, flexor and extensor of a published joint: VM_PRESET_ANKLE, VM_PRESET_KNEE or
/// VM_PRESET_ELBOW. `muscles` and `paths` have room for two; null pointers are skipped.
/// VM_RESULT_PARAMETER if there is no such preset.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_joint_preset(
    preset: u32,
    range: *mut VmAngleRange,
    muscles: *mut VmMuscleParams,
    paths: *mut VmPath,
) -> VmResult {
    let outcome = || {
        let range = Place::optional(range)?;
        let muscles = Place::optional(muscles.cast::<[VmMuscleParams; VM_ANTAGONISTS]>())?;
        let paths = Place::optional(paths.cast::<[VmPath; VM_ANTAGONISTS]>())?;
        let preset = choice("preset", preset, &PRESETS).map_err(|_| VmResult::Parameter)?;
        if let Some(place) = range {
            place.put(preset.range.into());
        }
        if let Some(place) = muscles {
            place.put(preset.muscles.map(|muscle| muscle_of(&muscle.params())));
        }
        if let Some(place) = paths {
            place.put(preset.muscles.map(|muscle| muscle.path().into()));
        }
        Ok(())
    };
    plain(outcome())
}
