//! Rise and fall of excitation: two first-order lags in series with one time constant,
//! df_int/dt = (drive - f_int)/Tf, df_eff/dt = (f_int - f_eff)/Tf.
//!
//! Rising (f_int >= f_eff): Tf = Tf1 L² + Tf2 f_env; falling: Tf = (Tf3 + Tf4 Af)/L.

use crate::checksum::summed;
use crate::error::{ParameterError, within};
use crate::scalar::{Lags, Scalar};
use crate::tick::time_step::TimeStep;

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

/// The two lags of one fibre type.
#[derive(Clone, Copy, Debug)]
pub struct Excitation<S: Scalar> {
    /// A tick in the unit of the time constants, which is a power of two of ticks.
    tick: S,
    // Time constants in that unit.
    rise: S,
    rise_per_frequency: S,
    fall: S,
    fall_per_activation: S,
}

summed!([S: Scalar] Excitation<S> { tick, rise, rise_per_frequency, fall, fall_per_activation });

/// The two lags after a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excited<S: Scalar> {
    /// f_int at the tick's end.
    pub(crate) intermediate: S::LagState,
    /// f_eff at mid-tick.
    pub(crate) effective_at_middle: S,
    /// f_eff at the tick's end.
    pub(crate) effective: S::LagState,
}

/// Range of fascicle length (L_ce0) and frequency (f0.5) for which the unit of time constants is
/// chosen; beyond it they saturate.
const LONGEST_FASCICLE: f64 = 2.0;
const SHORTEST_FASCICLE: f64 = 0.4;
const HIGHEST_FREQUENCY: f64 = 100.0;
/// Greatest time constant, in its unit.
const ROOM: f64 = 100.0;

impl<S: Scalar> Excitation<S> {
    pub(crate) fn new(params: &ExcitationParams, step: TimeStep) -> Self {
        let longest = params.rise * LONGEST_FASCICLE * LONGEST_FASCICLE
            + params.rise_per_frequency * HIGHEST_FREQUENCY
            + (params.fall + params.fall_per_activation) / SHORTEST_FASCICLE;
        let mut unit = step.seconds();
        while longest > ROOM * unit {
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

    /// One tick from (`intermediate`, `effective`) towards `drive`.
    ///
    /// `frequency` is f_env, `slowing` the factor of Tf4; both, and the fascicle's `length`, are
    /// mid-tick values. `reciprocal` is 1/length, clamped to the validity range of the filaments'
    /// equations. In the variable x = ∫dt/Tf the two lags are linear and solved exactly; if f_int
    /// and f_eff cross within the tick, x is the sum of both parts.
    #[inline(always)]
    pub(crate) fn advance(
        &self,
        (intermediate, effective): (S::LagState, S::LagState),
        drive: S,
        frequency: S,
        slowing: S,
        (length, reciprocal): (S, S),
    ) -> Excited<S> {
        let rising = self.rise * length * length + self.rise_per_frequency * frequency;
        let falling = (self.fall + self.fall_per_activation * slowing) * reciprocal;

        let lead = S::of(intermediate) - S::of(effective);
        let excess = S::of(intermediate) - drive;
        let rises = lead >= S::ZERO;
        let (now, then) = if rises { (rising, falling) } else { (falling, rising) };
        // f_int - f_eff = (lead - excess x) exp(-x) changes sign at x = lead/excess. x grows at one
        // rate until then, and at the other for the rest of the tick.
        let converging = rises == (excess > S::ZERO);
        let crosses = converging && lead.abs() * now < excess.abs() * self.tick;
        let (before, rest) =
            if crosses { (lead.abs().ratio(excess.abs()), then) } else { (S::ZERO, now) };
        let x = before + (self.tick - before * now).ratio(rest);

        let [half, whole] = x.lags();
        let lag = S::of(effective) - drive;
        let effective_after = |lags: Lags<S::Share>| {
            S::advanced_by_two(effective, (excess, lags.delayed), (-lag, lags.response))
        };
        // Rounding must not make the state negative.
        let end = effective_after(whole);
        Excited {
            intermediate: S::advanced(intermediate, -excess, whole.response),
            effective_at_middle: S::of(effective_after(half)),
            effective: if S::of(end) < S::ZERO { S::ZERO.lag_state() } else { end },
        }
    }
}
