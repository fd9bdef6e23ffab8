//! Rise and fall of excitation: two first-order lags in series with one time constant,
//! df_int/dt = (drive - f_int)/Tf, df_eff/dt = (f_int - f_eff)/Tf.
//!
//! Rising (f_int >= f_eff): Tf = Tf1 L² + Tf2 f_env; falling: Tf = (Tf3 + Tf4 Af)/L.

use crate::error::{ParameterError, within};
use crate::scalar::cold::cold_path;
use crate::scalar::{Lags, Scalar};
use crate::summed::summed;
use crate::tick::time_step::TimeStep;
use core::array::from_fn;

/// Time constants of excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExcitationParams {
    /// T_f1, s per L_ce0²; 0.005 to 0.5.
    #[doc(alias = "Tf1")]
    pub rise: f64,
    /// T_f2, s per f0.5; 0 to 0.5.
    #[doc(alias = "Tf2")]
    pub rise_per_frequency: f64,
    /// T_f3, s L_ce0; 0.005 to 0.5.
    #[doc(alias = "Tf3")]
    pub fall: f64,
    /// T_f4, s L_ce0; 0 to 0.5.
    #[doc(alias = "Tf4")]
    pub fall_per_activation: f64,
}

impl ExcitationParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("excitation.rise", self.rise, 5e-3, 0.5)?;
        within("excitation.rise_per_frequency", self.rise_per_frequency, 0.0, 0.5)?;
        within("excitation.fall", self.fall, 5e-3, 0.5)?;
        within("excitation.fall_per_activation", self.fall_per_activation, 0.0, 0.5)
    }
}

summed! {
    /// The two lags of one fibre type.
    #[derive(Clone, Copy, Debug)]
    pub struct Excitation<S: Scalar> {
        /// A tick, in the unit of the time constants, which is 2^k ticks.
        tick: S,
        // Time constants, in that unit.
        rise: S,
        rise_per_frequency: S,
        fall: S,
        fall_per_activation: S,
    }
}

/// The two lags after a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excited<S: Scalar> {
    /// f_int at the tick's end.
    pub(crate) intermediate: S::Wide,
    /// f_eff at mid-tick.
    pub(crate) effective_at_middle: S,
    /// f_eff at the tick's end.
    pub(crate) effective: S::Wide,
}

/// Range of fascicle length (L_ce0) and frequency (f0.5) for which the unit of time constants is
/// chosen; beyond it they saturate.
const LONGEST_FASCICLE: f64 = 2.0;
const SHORTEST_FASCICLE: f64 = 0.4;
const HIGHEST_FREQUENCY: f64 = 100.0;
/// Upper bound of a time constant, in its unit.
const LARGEST_TIME_CONSTANT: f64 = 100.0;

impl<S: Scalar> Excitation<S> {
    pub(crate) fn new(params: &ExcitationParams, step: TimeStep) -> Self {
        let longest = params.rise * LONGEST_FASCICLE * LONGEST_FASCICLE
            + params.rise_per_frequency * HIGHEST_FREQUENCY
            + (params.fall + params.fall_per_activation) / SHORTEST_FASCICLE;
        let mut unit = step.seconds();
        while longest > LARGEST_TIME_CONSTANT * unit {
            unit *= 2.0;
        }
        Self {
            tick: S::from_f64(step.seconds() / unit),
            rise: S::from_f64(params.rise / unit),
            rise_per_frequency: S::from_f64(params.rise_per_frequency / unit),
            fall: S::from_f64(params.fall / unit),
            fall_per_activation: S::from_f64(params.fall_per_activation / unit),
        }
    }
}

/// Inputs and initial state of the two lags of a type in a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExcitationInput<'a, S: Scalar> {
    pub(crate) excitation: &'a Excitation<S>,
    /// f_int at the start of the tick.
    pub(crate) intermediate: S::Wide,
    /// f_eff at the start of the tick.
    pub(crate) effective: S::Wide,
    /// Target of f_int, f0.5.
    pub(crate) drive: S,
    /// f_env at mid-tick, f0.5.
    pub(crate) frequency: S,
    /// Factor of Tf4 at mid-tick, 0..1.
    pub(crate) slowing: S,
}

/// Advances the lags of several types by one tick, side by side.
///
/// `length` is the mid-tick fascicle length; `reciprocal` is 1/length with the length clamped to
/// the validity range of the filaments' equations. As functions of x = ∫dt/Tf the two lags are
/// linear and are solved exactly. If f_int and f_eff cross within the tick, x is the sum of the
/// parts before and after the crossing.
#[inline(always)]
pub(crate) fn advance<S: Scalar, const N: usize>(
    types: [ExcitationInput<'_, S>; N],
    length: S,
    reciprocal: S,
) -> [Excited<S>; N] {
    let square = length * length;
    let rising = types
        .each_ref()
        .map(|t| t.excitation.rise * square + t.excitation.rise_per_frequency * t.frequency);
    let falling = types
        .each_ref()
        .map(|t| (t.excitation.fall + t.excitation.fall_per_activation * t.slowing) * reciprocal);
    let lead = types.each_ref().map(|t| S::of(t.intermediate) - S::of(t.effective));
    let excess = types.each_ref().map(|t| S::of(t.intermediate) - t.drive);
    let rises: [bool; N] = from_fn(|i| {
        // If f_int = f_eff, the sign of the derivative of f_int - f_eff decides.
        lead[i] > S::ZERO || lead[i] == S::ZERO && excess[i] <= S::ZERO
    });
    let time_constants: [S; N] = from_fn(|i| if rises[i] { rising[i] } else { falling[i] });
    let mut spans = S::ratios(types.each_ref().map(|t| t.excitation.tick.span()), time_constants);
    for i in 0..N {
        // f_int - f_eff = (lead - excess x) exp(-x) changes sign at x = lead/excess. Before that
        // x grows with one time constant, after it with the other.
        let tick = types[i].excitation.tick;
        if (lead[i] * time_constants[i]).is_between_0_and(excess[i] * tick) {
            cold_path();
            let before = lead[i].abs().ratio(excess[i].abs());
            let other = if rises[i] { falling[i] } else { rising[i] };
            let after = (tick - before * time_constants[i]).span().ratio(other);
            spans[i] = before.span() + after;
        }
    }

    // A loop: a closure mapped over the array would not be inlined.
    let none = Lags { response: S::share(0.0), delayed: S::share(0.0) };
    let mut lags = [[none; 2]; N];
    for (lags, spans) in lags.iter_mut().zip(spans) {
        *lags = spans.lags();
    }
    let lag = types.each_ref().map(|t| S::of(t.effective) - t.drive);
    let middle: [S; N] = from_fn(|i| {
        let Lags { response, delayed } = lags[i][0];
        let changes = ((excess[i], delayed), (-lag[i], response));
        S::of(S::advanced_by_two(types[i].effective, changes.0, changes.1))
    });
    let end: [S::Wide; N] = from_fn(|i| {
        let Lags { response, delayed } = lags[i][1];
        let changes = ((excess[i], delayed), (-lag[i], response));
        S::advanced_by_two(types[i].effective, changes.0, changes.1)
    });
    from_fn(|i| Excited {
        intermediate: S::advanced(types[i].intermediate, -excess[i], lags[i][1].response),
        effective_at_middle: middle[i],
        // Rounding must not make the state negative.
        effective: if S::of(end[i]).is_negative() { S::ZERO.wide() } else { end[i] },
    })
}
