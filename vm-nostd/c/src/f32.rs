//! Muscles computed in float.

use crate::params::{VmMuscleParams, refused};
use crate::result::{VmError, VmResult};
use crate::slot::{Slot, VmMode, keep, mode_of, words};
use core::mem::MaybeUninit;
use model::{BankedMuscle, ContinuousMuscle, FesMuscle, Input, TimeStep};

/// Bytes of a VmMuscleF32.
pub const VM_MUSCLE_F32_SIZE: usize = 584;
/// Words of its saved state.
pub const VM_F32_STATE_WORDS: usize = 22;

/// A muscle computed in float.
pub type VmMuscleF32 = Slot<f32, 0x564D_4633>;

const _: () =
    assert!(size_of::<VmMuscleF32>() == VM_MUSCLE_F32_SIZE && align_of::<VmMuscleF32>() == 8);
const _: () = assert!(words::<f32>() == VM_F32_STATE_WORDS);

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputF32 {
    /// Activation U, or strength of the stimulus (FES); 0..1.
    pub activation: f32,
    /// Path length at the tick's end, m.
    pub path_length_m: f32,
    /// Stimulation frequency, pps; 0..500 (FES only).
    pub stimulation_frequency_pps: f32,
}

/// Outputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmOutputF32 {
    /// Tendon force, N; never negative.
    pub force_n: f32,
    /// Fascicle length, L_ce0.
    pub fascicle_length: f32,
    /// Fascicle velocity, L_ce0/s, positive when lengthening.
    pub fascicle_velocity: f32,
    /// Tendon force relative to F0.
    pub relative_force: f32,
    /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
    pub status: u16,
}

/// A saved state.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmStateF32 {
    /// The words, for storage.
    pub words: [u32; VM_F32_STATE_WORDS],
}

/// Builds a muscle for a time step (s; 1e-4 to 2e-3), at rest in the middle of its path. `size` is
/// `sizeof(*muscle)`. On VM_RESULT_PARAMETER `error`, which may be null, has the field, value and
/// limits.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_build(
    muscle: Option<&mut MaybeUninit<VmMuscleF32>>,
    size: usize,
    params: Option<&VmMuscleParams>,
    mode: u32,
    time_step_s: f64,
    error: Option<&mut VmError>,
) -> VmResult {
    let (Some(muscle), Some(params)) = (muscle, params) else { return VmResult::NullPointer };
    if size != VM_MUSCLE_F32_SIZE {
        return VmResult::Size;
    }
    let built = params.model().and_then(|params| {
        let step = TimeStep::from_seconds(time_step_s)?;
        let path = params.middle_path() as f32;
        Ok(match mode_of(mode)? {
            VmMode::Continuous => {
                let muscle = ContinuousMuscle::build(&params, step)?;
                let state = muscle.rest(path)?;
                BankedMuscle::Continuous(muscle, state)
            }
            VmMode::Fes => {
                let muscle = FesMuscle::build(&params, step)?;
                let state = muscle.rest(path)?;
                BankedMuscle::Fes(muscle, state)
            }
        })
    });
    match built {
        Ok(built) => {
            Slot::put(muscle, built);
            VmResult::Ok
        }
        Err(refusal) => refused(refusal, error),
    }
}

/// Puts a muscle at rest on a path. VM_RESULT_PARAMETER if the path is out of range; the muscle is
/// unchanged.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_rest(muscle: Option<&mut VmMuscleF32>, path_length_m: f32) -> VmResult {
    let Some(slot) = muscle else { return VmResult::NullPointer };
    let rested = slot.get_mut().and_then(|muscle| {
        let path = path_length_m;
        match muscle {
            BankedMuscle::Continuous(muscle, state) => muscle.rest(path).map(|rest| *state = rest),
            BankedMuscle::Fes(muscle, state) => muscle.rest(path).map(|rest| *state = rest),
        }
        .map_err(|_| VmResult::Parameter)
    });
    rested.err().unwrap_or(VmResult::Ok)
}

/// Steps a muscle by one tick. Inputs out of range are clipped and flagged in `output->status`.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_step(
    muscle: Option<&mut VmMuscleF32>,
    input: Option<&VmInputF32>,
    output: Option<&mut VmOutputF32>,
) -> VmResult {
    let (Some(slot), Some(input), Some(place)) = (muscle, input, output) else {
        return VmResult::NullPointer;
    };
    let muscle = match slot.get_mut() {
        Ok(muscle) => muscle,
        Err(result) => return result,
    };
    let output = muscle.step(Input {
        activation: input.activation,
        path_length: input.path_length_m,
        stimulation_frequency: input.stimulation_frequency_pps,
    });
    *place = VmOutputF32 {
        force_n: output.force,
        fascicle_length: output.fascicle_length,
        fascicle_velocity: output.fascicle_velocity,
        relative_force: output.relative_force,
        status: output.status.bits(),
    };
    VmResult::Ok
}

/// Saves a muscle's state, with a fingerprint of muscle, mode and time step.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_save(
    muscle: Option<&VmMuscleF32>,
    saved: Option<&mut VmStateF32>,
) -> VmResult {
    let (Some(slot), Some(VmStateF32 { words })) = (muscle, saved) else {
        return VmResult::NullPointer;
    };
    match slot.get() {
        Ok(BankedMuscle::Continuous(muscle, state)) => keep(muscle.save(state), words),
        Ok(BankedMuscle::Fes(muscle, state)) => keep(muscle.save(state), words),
        Err(result) => return result,
    }
    VmResult::Ok
}

/// Restores a saved state. VM_RESULT_OTHER_MUSCLE if it is of another muscle, mode or time step,
/// VM_RESULT_STATE if it is out of range; the muscle is then unchanged.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_restore(
    muscle: Option<&mut VmMuscleF32>,
    saved: Option<&VmStateF32>,
) -> VmResult {
    let (Some(slot), Some(VmStateF32 { words })) = (muscle, saved) else {
        return VmResult::NullPointer;
    };
    let restored = slot.get_mut().and_then(|muscle| {
        match muscle {
            BankedMuscle::Continuous(muscle, state) => {
                muscle.restore(*words).map(|was| *state = was)
            }
            BankedMuscle::Fes(muscle, state) => muscle.restore(*words).map(|was| *state = was),
        }
        .map_err(VmResult::from)
    });
    restored.err().unwrap_or(VmResult::Ok)
}

/// Checksums of a muscle's coefficients, which never change, and of its state, which changes with
/// every tick. Firmware compares them to detect a flipped bit.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_f32_checksums(
    muscle: Option<&VmMuscleF32>,
    coefficients: Option<&mut u32>,
    state: Option<&mut u32>,
) -> VmResult {
    let (Some(slot), Some(coefficients), Some(state)) = (muscle, coefficients, state) else {
        return VmResult::NullPointer;
    };
    match slot.get() {
        Ok(muscle) => {
            *coefficients = muscle.coefficients_checksum();
            *state = muscle.state_checksum();
            VmResult::Ok
        }
        Err(result) => result,
    }
}
