//! Muscles computed in fixed point.

use crate::params::{VmMuscleParams, refused};
use crate::result::{VmError, VmResult};
use crate::slot::{Slot, VmMode, keep, mode_of, words};
use core::mem::MaybeUninit;
use model::{BankedMuscle, ContinuousMuscle, FesMuscle, Fixed, Input, Scalar, TimeStep};

/// Bytes of a VmMuscleFixed.
pub const VM_MUSCLE_FIXED_SIZE: usize = 704;
/// Words of its saved state.
pub const VM_FIXED_STATE_WORDS: usize = 31;

/// A muscle computed in fixed point.
pub type VmMuscleFixed = Slot<Fixed, 0x564D_5158>;

const _: () =
    assert!(size_of::<VmMuscleFixed>() == VM_MUSCLE_FIXED_SIZE && align_of::<VmMuscleFixed>() == 8);
const _: () = assert!(words::<Fixed>() == VM_FIXED_STATE_WORDS);

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputFixed {
    /// Path length at the tick's end, um.
    pub path_length_um: i32,
    /// Activation U, or strength of the stimulus (FES), thousandths; 0..1000.
    pub activation_per_mille: u16,
    /// Stimulation frequency, tenths of a pps; 0..5000 (FES only).
    pub stimulation_tenths_pps: u16,
}

/// Outputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmOutputFixed {
    /// Tendon force, mN; never negative.
    pub force_mn: i32,
    /// Fascicle length, 2^-24 L_ce0.
    pub fascicle_length: i32,
    /// Fascicle velocity, 2^-24 L_ce0/s, positive when lengthening.
    pub fascicle_velocity: i32,
    /// Tendon force relative to F0, 2^-24 F0: finer than mN if F0 is below 16,777 N.
    pub relative_force: i32,
    /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
    pub status: u16,
}

/// A saved state.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmStateFixed {
    /// The words, for storage.
    pub words: [u32; VM_FIXED_STATE_WORDS],
}

/// Builds a muscle for a time step (s; 1e-4 to 2e-3), at rest in the middle of its path. `size` is
/// `sizeof(*muscle)`. On VM_RESULT_PARAMETER `error`, which may be null, has the field, value and
/// limits.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_fixed_build(
    muscle: Option<&mut MaybeUninit<VmMuscleFixed>>,
    size: usize,
    params: Option<&VmMuscleParams>,
    mode: u32,
    time_step_s: f64,
    error: Option<&mut VmError>,
) -> VmResult {
    let (Some(muscle), Some(params)) = (muscle, params) else { return VmResult::NullPointer };
    if size != VM_MUSCLE_FIXED_SIZE {
        return VmResult::Size;
    }
    let built = params.model().and_then(|params| {
        let step = TimeStep::from_seconds(time_step_s)?;
        let path = Fixed::path_length(params.middle_path());
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
pub extern "C" fn vm_fixed_rest(
    muscle: Option<&mut VmMuscleFixed>,
    path_length_um: i32,
) -> VmResult {
    let Some(slot) = muscle else { return VmResult::NullPointer };
    let rested = slot.get_mut().and_then(|muscle| {
        let path = Input::<Fixed>::from_integers(0, path_length_um, 0).path_length;
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
pub extern "C" fn vm_fixed_step(
    muscle: Option<&mut VmMuscleFixed>,
    input: Option<&VmInputFixed>,
    output: Option<&mut VmOutputFixed>,
) -> VmResult {
    let (Some(slot), Some(input), Some(place)) = (muscle, input, output) else {
        return VmResult::NullPointer;
    };
    let muscle = match slot.get_mut() {
        Ok(muscle) => muscle,
        Err(result) => return result,
    };
    let output = muscle.step(Input::<Fixed>::from_integers(
        input.activation_per_mille,
        input.path_length_um,
        input.stimulation_tenths_pps,
    ));
    *place = VmOutputFixed {
        force_mn: output.force,
        fascicle_length: output.fascicle_length.to_bits(),
        fascicle_velocity: output.fascicle_velocity.to_bits(),
        relative_force: output.relative_force.to_bits(),
        status: output.status.bits(),
    };
    VmResult::Ok
}

/// Saves a muscle's state, with a fingerprint of muscle, mode and time step.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_fixed_save(
    muscle: Option<&VmMuscleFixed>,
    saved: Option<&mut VmStateFixed>,
) -> VmResult {
    let (Some(slot), Some(VmStateFixed { words })) = (muscle, saved) else {
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
pub extern "C" fn vm_fixed_restore(
    muscle: Option<&mut VmMuscleFixed>,
    saved: Option<&VmStateFixed>,
) -> VmResult {
    let (Some(slot), Some(VmStateFixed { words })) = (muscle, saved) else {
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
pub extern "C" fn vm_fixed_checksums(
    muscle: Option<&VmMuscleFixed>,
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
