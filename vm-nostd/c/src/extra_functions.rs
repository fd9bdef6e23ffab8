//! The functions of fatigue, recruitment curve and inverse in an arithmetic, as `functions.rs`.

macro_rules! extra_functions {
    ($($key:ident = $value:ident,)*) => {
        $crate::extra_functions::expand_extra! { $($value,)* }
    };
}
pub(crate) use extra_functions;

#[rustfmt::skip]
macro_rules! expand_extra {
    (
        $S:ident, $Input:ident, $Output:ident, $Steady:ident, $SteadyOutput:ident, $Fatigue:ident,
        $Curve:ident, $Number:ident, $Amount:ident, $Newtons:ident, $Word:ident, $fatigued:ident,
        $fatigue_build:ident, $fatigue_advance:ident, $fatigue_save:ident, $fatigue_restore:ident,
        $curve_build:ident, $curve_activation:ident, $curve_amplitude:ident, $curve_width:ident,
        $curve_checksum:ident, $steady_build:ident, $steady_force:ident, $steady_activation:ident,
    ) => {

// <functions>
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
    };
}
pub(crate) use expand_extra;
