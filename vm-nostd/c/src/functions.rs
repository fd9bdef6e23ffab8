//! The functions of an arithmetic, written once. cbindgen does not expand macros: for the header,
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
        $STATE_WORDS:ident, $MUSCLE_BASE:ident, $MUSCLE_PER_TYPE:ident, $UNITS_BASE:ident, $UNITS_PER_TYPE:ident,
        $STEADY_BASE:ident, $STEADY_PER_TYPE:ident,
        $S:ident, $Muscle:ident, $Input:ident, $Output:ident, $Info:ident, $Steady:ident,
        $SteadyOutput:ident, $Fatigue:ident, $Curve:ident,
        $Path:ident, $Number:ident, $Amount:ident, $Newtons:ident, $Word:ident,
        $size:ident, $build:ident, $build_units:ident, $rest:ident, $step:ident, $observe:ident,
        $info:ident, $save:ident, $restore:ident, $checksums:ident, $fatigued:ident,
        $fatigue_build:ident, $fatigue_advance:ident, $fatigue_save:ident, $fatigue_restore:ident,
        $curve_build:ident, $curve_activation:ident, $curve_amplitude:ident, $curve_width:ident,
        $curve_checksum:ident, $steady_build:ident, $steady_force:ident, $steady_activation:ident,
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

/// Steady state under FES.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct $SteadyOutput {
    /// Tendon force, in the unit of force.
    pub force: $Newtons,
    /// Activation, 0..1.
    pub activation: $Number,
    /// Tendon force relative to F0.
    pub relative_force: $Number,
    /// Fascicle length, L_ce0.
    pub fascicle_length: $Number,
    /// VM_STATUS_ flags; VM_STATUS_FORCE_UNREACHABLE if no activation holds the force.
    pub status: u16,
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

/// Builds fatigue for a time step, rested. `size` is that of the memory.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fatigue_build(
    fatigue: *mut $Fatigue,
    size: usize,
    params: *const VmFatigueParams,
    time_step_s: f64,
    error: *mut VmError,
) -> VmResult {
    told(extras::build_fatigue::<$S, _>(fatigue, size, params, time_step_s, error), error)
}

/// Advances fatigue by the activation and stimulation frequency of a tick (100 pps for natural
/// recruitment). Gives the fitness, 0..1.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fatigue_advance(
    fatigue: *mut $Fatigue,
    input: *const $Input,
    fitness: *mut $Number,
) -> VmResult {
    plain(extras::advance_fatigue::<$S, _, _>(fatigue, input, fitness))
}

/// Multiplies the forces of an output by a fitness.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fatigued(output: *mut $Output, fitness: $Number) -> VmResult {
    let outcome = || {
        let mut output_now = read(output)?;
        output_now.tire(<$S as Arithmetic>::number_from(fitness));
        Place::new(output)?.put(output_now);
        Ok(())
    };
    plain(outcome())
}

/// Saves fatigue: 3 words, or 4 in fixed point, with a fingerprint of parameters and time step.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fatigue_save(
    fatigue: *const $Fatigue,
    words: *mut $Word,
    count: usize,
) -> VmResult {
    plain(extras::save_fatigue::<$S, _>(fatigue, words, count))
}

/// Restores fatigue, with the results of a muscle's restore.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $fatigue_restore(
    fatigue: *mut $Fatigue,
    words: *const $Word,
    count: usize,
) -> VmResult {
    plain(extras::restore_fatigue::<$S, _>(fatigue, words, count))
}

/// Builds a recruitment curve. `size` is that of the memory.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $curve_build(
    curve: *mut $Curve,
    size: usize,
    params: *const VmCurveParams,
    error: *mut VmError,
) -> VmResult {
    told(extras::build_curve::<$S, _>(curve, size, params, error), error)
}

/// Activation (0..1) that a pulse of amplitude (mA) and width (us) recruits, and VM_PULSE_ flags.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $curve_activation(
    curve: *const $Curve,
    amplitude_ma: $Amount,
    width_us: $Amount,
    activation: *mut $Number,
    status: *mut u16,
) -> VmResult {
    plain(extras::on_curve::<$S, _, _>(curve, activation, status, |curve| {
        let (activation, status) = curve.activation(<$S>::pulse(amplitude_ma, width_us));
        (activation.number(), status)
    }))
}

/// Amplitude (mA) with which a pulse of a width (us) recruits an activation.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $curve_amplitude(
    curve: *const $Curve,
    activation: $Number,
    width_us: $Amount,
    amplitude_ma: *mut $Amount,
    status: *mut u16,
) -> VmResult {
    plain(extras::on_curve::<$S, _, _>(curve, amplitude_ma, status, |curve| {
        let width = <$S>::amount_from(width_us);
        let (amplitude, status) = curve.amplitude_for(<$S>::number_from(activation), width);
        (<$S>::amount(amplitude), status)
    }))
}

/// Width (us) with which a pulse of an amplitude (mA) recruits an activation.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $curve_width(
    curve: *const $Curve,
    activation: $Number,
    amplitude_ma: $Amount,
    width_us: *mut $Amount,
    status: *mut u16,
) -> VmResult {
    plain(extras::on_curve::<$S, _, _>(curve, width_us, status, |curve| {
        let amplitude = <$S>::amount_from(amplitude_ma);
        let (width, status) = curve.width_for(<$S>::number_from(activation), amplitude);
        (<$S>::amount(width), status)
    }))
}

/// Checksum of a curve's coefficients.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $curve_checksum(curve: *const $Curve, checksum: *mut u32) -> VmResult {
    plain(extras::curve_checksum::<$S, _>(curve, checksum))
}

/// Builds the steady state of FES, for the inverse. `size` is that of the memory.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $steady_build(
    steady: *mut $Steady,
    size: usize,
    params: *const VmMuscleParams,
    error: *mut VmError,
) -> VmResult {
    told(extras::build_steady::<$S, _>(steady, STEADY_MARK, size, params, error), error)
}

/// Steady force of an input.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $steady_force(
    steady: *const $Steady,
    input: *const $Input,
    output: *mut $SteadyOutput,
) -> VmResult {
    let outcome = || {
        let place = Place::new(output)?;
        let question = Question::Force(read(input)?.input());
        place.put(extras::ask_steady::<$S, _>(steady, STEADY_MARK, question)?.into());
        Ok(())
    };
    plain(outcome())
}

/// Activation that holds a force at the path and stimulation frequency of an input, whose
/// activation is not used. The nearest one, flagged, if none does.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn $steady_activation(
    steady: *const $Steady,
    force: $Newtons,
    input: *const $Input,
    output: *mut $SteadyOutput,
) -> VmResult {
    let outcome = || {
        let place = Place::new(output)?;
        let input = InputOf::<$S>::input(read(input)?);
        let force = <$S as Arithmetic>::newtons_from(force);
        let question =
            Question::Activation(force, input.path_length, input.stimulation_frequency);
        place.put(extras::ask_steady::<$S, _>(steady, STEADY_MARK, question)?.into());
        Ok(())
    };
    plain(outcome())
}
// </functions>

impl From<model::Steady<$S>> for $SteadyOutput {
    fn from(steady: model::Steady<$S>) -> Self {
        Self {
            force: <$S as Arithmetic>::newtons(steady.force),
            activation: steady.activation.number(),
            relative_force: steady.relative_force.number(),
            fascicle_length: steady.fascicle_length.number(),
            status: steady.status.bits(),
        }
    }
}

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
