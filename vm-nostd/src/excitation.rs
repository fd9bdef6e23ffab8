//! Rise and fall of excitation: two lags in a row with one time constant,
//! df_int/dt = (drive - f_int)/Tf, df_eff/dt = (f_int - f_eff)/Tf.
//!
//! Rising (f_int >= f_eff): Tf = Tf1 L² + Tf2 f_env; falling: Tf = (Tf3 + Tf4 Af)/L.

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::time_step::TimeStep;

/// Time constants of excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
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
pub struct Excitation<S> {
    // Time constants in ticks.
    rise: S,
    rise_per_frequency: S,
    fall: S,
    fall_per_activation: S,
    half: S,
    two: S,
}

/// What one tick does to the two lags.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Excited<S> {
    /// f_int at the tick's end.
    pub(crate) intermediate: S,
    /// f_eff at the tick's middle.
    pub(crate) effective_at_middle: S,
    /// f_eff at the tick's end.
    pub(crate) effective: S,
}

impl<S: Scalar> Excitation<S> {
    pub(crate) fn new(params: &ExcitationParams, step: TimeStep) -> Self {
        let ticks = |seconds: f64| S::from_f64(seconds / step.seconds());
        Self {
            rise: ticks(params.rise),
            rise_per_frequency: ticks(params.rise_per_frequency),
            fall: ticks(params.fall),
            fall_per_activation: ticks(params.fall_per_activation),
            half: S::from_f64(0.5),
            two: S::from_f64(2.0),
        }
    }

    /// One tick from (`intermediate`, `effective`) towards `drive`.
    ///
    /// `frequency` is f_env, `slowing` what multiplies Tf4, both taken, like `fascicle_length`,
    /// at the tick's middle. In the variable x = ∫dt/Tf the two lags are linear and solved
    /// exactly; where f_int and f_eff cross within the tick, x is put together from both sides.
    pub(crate) fn advance(
        &self,
        (intermediate, effective): (S, S),
        drive: S,
        frequency: S,
        slowing: S,
        fascicle_length: S,
    ) -> Excited<S> {
        let rise_time =
            self.rise * fascicle_length * fascicle_length + self.rise_per_frequency * frequency;
        let rising = S::ONE / rise_time;
        let falling = fascicle_length / (self.fall + self.fall_per_activation * slowing);

        let lead = intermediate - effective;
        let excess = intermediate - drive;
        let (before, after) = if lead >= S::ZERO { (rising, falling) } else { (falling, rising) };
        // f_int - f_eff = (lead - excess x) exp(-x): it changes sign at x = lead/excess.
        let converging = (lead >= S::ZERO) == (excess > S::ZERO);
        let crosses = converging && lead.abs() < excess.abs() * before;
        let x = if crosses { after + lead / excess * (S::ONE - after / before) } else { before };

        // In changes, not in values: a slow lag's are far below the values' last bits.
        let x_middle = x * self.half;
        let done_middle = -(-x_middle).exp_m1();
        let done = done_middle * (self.two - done_middle);
        let lag = effective - drive;
        let effective_at =
            |x: S, done: S| (effective + (excess * x * (S::ONE - done) - lag * done)).max(S::ZERO);
        Excited {
            intermediate: (intermediate - excess * done).max(S::ZERO),
            effective_at_middle: effective_at(x_middle, done_middle),
            effective: effective_at(x, done),
        }
    }
}
