//! The functions of a muscle in an arithmetic, written once. cbindgen does not expand macros: for
//! the header,
//! `tests/tests/c_api.rs` replaces each `$name` by what an arithmetic's file gives for it.

macro_rules! functions {
    ($($key:ident = $value:ident,)*) => {
        $crate::functions::expand! { $($value,)* }
    };
}
pub(crate) use functions;

#[rustfmt::skip]
macro_rules! expand {
    (
        $STATE_WORDS:ident, $MUSCLE_BASE:ident, $MUSCLE_PER_TYPE:ident, $UNITS_BASE:ident,
        $UNITS_PER_TYPE:ident, $STEADY_BASE:ident, $STEADY_PER_TYPE:ident, $S:ident,
        $Muscle:ident, $Input:ident, $Output:ident, $Info:ident, $Steady:ident, $Fatigue:ident,
        $Curve:ident, $FiberCurves:ident, $ElementCurves:ident, $Path:ident, $Number:ident,
        $Newtons:ident, $Word:ident, $size:ident, $build:ident, $build_units:ident, $rest:ident,
        $step:ident, $observe:ident, $info:ident, $save:ident, $restore:ident, $checksums:ident,
        $fiber_curves:ident, $element_curves:ident,
    ) => {

// <functions>
/// What a built muscle says of itself.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct $Info {
    /// Maximal isometric force F0, in the unit of force.
    pub max_isometric_force: $Newtons,
    /// Shortest path, in the unit of path.
    pub shortest_path: $Path,
    /// Longest path.
    pub longest_path: $Path,
    /// Number of fibre types.
    pub fiber_count: u32,
    /// VmMode.
    pub mode: u32,
    /// Accuracy class.
    pub accuracy_class: u32,
    /// Words of a saved state.
    pub state_words: u32,
}

/// Curves of a fibre type.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct $FiberCurves {
    /// FL, 0..1.
    pub force_length: $Number,
    /// FV, at least 0; 1 at a velocity of 0.
    pub force_velocity: $Number,
    /// Af, 0..1.
    pub activation_frequency: $Number,
}

/// Curves of the elements, F0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct $ElementCurves {
    /// F_pe1 without viscosity.
    pub parallel: $Number,
    /// F_pe2 at full activation, at most 0.
    pub compression: $Number,
    /// F_se, at least 0.
    pub tendon: $Number,
}

/// Bytes of memory that a muscle of `fiber_count` types in a mode needs. VM_RESULT_PARAMETER if
/// this library has none of that kind.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $size(fiber_count: u32, mode: u32, size: *mut usize) -> VmResult {
    plain(muscle::needed::<$S>(fiber_count, mode, size))
}

/// Builds a muscle for a time step (s; 1e-4 to 2e-3) in VM_MODE_CONTINUOUS or VM_MODE_FES. `size`
/// is that of the memory. `error`, which may be null, has details of VM_RESULT_PARAMETER and
/// VM_RESULT_SIZE. Rest or restore comes next. A muscle that was there is replaced.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $build(
    muscle: *mut $Muscle,
    size: usize,
    params: *const VmMuscleParams,
    mode: u32,
    time_step_s: f64,
    error: *mut VmError,
) -> VmResult {
    let order = Order { size, params, units: core::ptr::null(), mode, time_step_s, error };
    told(muscle::build::<$S, _>(muscle, MARK, &order), error)
}

/// The same in any mode; `units` are those of the discrete modes.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $build_units(
    muscle: *mut $Muscle,
    size: usize,
    params: *const VmMuscleParams,
    units: *const VmUnits,
    mode: u32,
    time_step_s: f64,
    error: *mut VmError,
) -> VmResult {
    let order = Order { size, params, units, mode, time_step_s, error };
    told(muscle::build::<$S, _>(muscle, MARK, &order), error)
}

/// Puts a muscle at rest on a path. VM_RESULT_PARAMETER if the path is out of range; the muscle is
/// unchanged.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $rest(muscle: *mut $Muscle, path_length: $Path) -> VmResult {
    plain(muscle::rest::<$S, _>(muscle, MARK, path_length))
}

/// Steps a muscle by one tick. Inputs out of range are clipped and flagged in `output->status`.
/// VM_RESULT_NOT_RESTED before the first rest or restore.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $step(
    muscle: *mut $Muscle,
    input: *const $Input,
    output: *mut $Output,
) -> VmResult {
    plain(muscle::step::<$S, _, _, _>(muscle, MARK, input, output))
}

/// The state as an output, without a step; no flags.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $observe(muscle: *const $Muscle, output: *mut $Output) -> VmResult {
    plain(muscle::observe::<$S, _, _>(muscle, MARK, output))
}

/// F0, path range and kind of a muscle.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $info(muscle: *const $Muscle, info: *mut $Info) -> VmResult {
    let outcome = || {
        let place = Place::new(info)?;
        let facts = muscle::facts::<$S, _>(muscle, MARK)?;
        place.put($Info {
            max_isometric_force: facts.force,
            shortest_path: facts.paths.0,
            longest_path: facts.paths.1,
            fiber_count: facts.types,
            mode: facts.mode,
            accuracy_class: facts.class,
            state_words: facts.words,
        });
        Ok(())
    };
    plain(outcome())
}

/// Saves a muscle's state, with a fingerprint of muscle, mode and time step. VM_RESULT_SIZE if
/// there is no room for its words: see state_words of info.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $save(muscle: *const $Muscle, words: *mut $Word, count: usize) -> VmResult {
    plain(muscle::save::<$S, _>(muscle, MARK, words, count))
}

/// Restores a saved state. VM_RESULT_OTHER_MUSCLE if it is of another muscle, mode or time step,
/// VM_RESULT_STATE if it is out of range; the muscle is then unchanged.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $restore(muscle: *mut $Muscle, words: *const $Word, count: usize) -> VmResult {
    plain(muscle::restore::<$S, _>(muscle, MARK, words, count))
}

/// Checksums of a muscle's coefficients, which never change, and of its state, which changes with
/// every tick. Firmware compares them to detect a flipped bit.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $checksums(
    muscle: *const $Muscle,
    coefficients: *mut u32,
    state: *mut u32,
) -> VmResult {
    plain(muscle::checksums::<$S, _>(muscle, MARK, coefficients, state))
}

/// Curves of a fibre type (index from 0) as a tick computes them, at a fascicle length (L_ce0), a
/// velocity (L_ce0/s) and a frequency (f_0.5). VM_RESULT_PARAMETER if there is no such type.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fiber_curves(
    muscle: *const $Muscle,
    fiber: u32,
    fascicle_length: $Number,
    fascicle_velocity: $Number,
    frequency: $Number,
    curves: *mut $FiberCurves,
) -> VmResult {
    let outcome = || {
        let place = Place::new(curves)?;
        let at = [fascicle_length, fascicle_velocity, frequency].map(<$S>::number_from);
        let [length, velocity, activation] = muscle::fiber_curves(muscle, MARK, fiber, at)?;
        place.put($FiberCurves {
            force_length: length.number(),
            force_velocity: velocity.number(),
            activation_frequency: activation.number(),
        });
        Ok(())
    };
    plain(outcome())
}

/// Curves of the elements at a fascicle length (L_ce0) on a path, of which the tendon has the rest.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $element_curves(
    muscle: *const $Muscle,
    fascicle_length: $Number,
    path_length: $Path,
    curves: *mut $ElementCurves,
) -> VmResult {
    let outcome = || {
        let place = Place::new(curves)?;
        let length = <$S>::number_from(fascicle_length);
        let path = <$S as Arithmetic>::path_from(path_length);
        let [parallel, compression, tendon] =
            muscle::element_curves::<$S, _>(muscle, MARK, length, path)?;
        place.put($ElementCurves {
            parallel: parallel.number(),
            compression: compression.number(),
            tendon: tendon.number(),
        });
        Ok(())
    };
    plain(outcome())
}

// </functions>

const _: () = {
    /// The header's sizes have room for what is built, and waste little.
    const fn fits(needed: usize, given: usize) {
        assert!(needed <= given, "the model has grown: raise the sizes at the top of this file");
        assert!(given <= needed + 128, "the model has shrunk: lower the sizes");
    }
    use $crate::slot::bytes;
    macro_rules! each {
        ($N:literal) => {
            let muscle = $MUSCLE_BASE + $N * $MUSCLE_PER_TYPE;
            fits(bytes::<$crate::kinds::Held<$S, model::NaturalContinuous, $N>>(), muscle);
            fits(bytes::<$crate::kinds::Held<$S, model::IntramuscularFes, $N>>(), muscle);
            fits(bytes::<model::SteadyFes<$S, $N>>(), $STEADY_BASE + $N * $STEADY_PER_TYPE);
            #[cfg(feature = "units")]
            assert!(
                bytes::<$crate::kinds::Held<$S, $crate::kinds::Effective, $N>>()
                    <= $UNITS_BASE + $N * $UNITS_PER_TYPE
            );
        };
    }
    // Used with the feature `units` only.
    let _units = $UNITS_BASE + 2 * $UNITS_PER_TYPE;
    each!(2);
    use model::{IntramuscularFes, NaturalContinuous, State};
    assert!(State::<$S, NaturalContinuous, 2>::SAVED_WORDS == $STATE_WORDS);
    assert!(State::<$S, IntramuscularFes, 2>::SAVED_WORDS == $STATE_WORDS);
    assert!(size_of::<$Muscle>() == $MUSCLE_BASE + 2 * $MUSCLE_PER_TYPE);
    assert!(size_of::<$Steady>() == $STEADY_BASE + 2 * $STEADY_PER_TYPE);
    #[cfg(feature = "types")]
    {
        each!(1);
        each!(3);
        each!(4);
        each!(5);
        each!(6);
    }
    fits(size_of::<extras::FatigueSlot<$S>>(), size_of::<$Fatigue>());
    fits(size_of::<extras::CurveSlot<$S>>(), size_of::<$Curve>());
};
    };
}
pub(crate) use expand;
