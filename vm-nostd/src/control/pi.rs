//! Proportional, integral and, if wanted, derivative feedback with anti-windup.
//!
//! u = k_p e + k_i ∫ e dt + k_d s/(1 + T_d s) e. The integral is held while the command is
//! saturated in the direction that the error would push it further (conditional integration), and
//! never exceeds its limit.

use crate::error::{ParameterError, within};
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Arithmetic, Scalar};
use crate::summed::summed;
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Gains of the feedback. Fixed point refuses those whose coefficients exceed 60: of torques, k_p
/// above 60, k_i above 0.23 over the time step, k_d above 60 T_d; of angles, all in these
/// ranges fit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PiParams {
    /// k_p, N m per rad (of torque: per N m); 0 to 1,000. More is stiffer, until delay makes it
    /// oscillate.
    pub proportional: f64,
    /// k_i, the same per s; 0 to 10,000. More removes an offset faster and overshoots.
    pub integral: f64,
    /// k_d, the same times s; 0 to 100. It damps a limb that the muscles do not damp, until noise
    /// and delay make it shake.
    pub derivative: f64,
    /// Filter time of the derivative T_d, s; 0.005 to 1. More rejects noise and is later.
    pub derivative_filter: f64,
    /// Greatest torque of the integral, N m; 0 to 1,000.
    pub most: f64,
}

impl PiParams {
    /// Validates the gains; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("pi.proportional", self.proportional, 0.0, 1e3)?;
        within("pi.integral", self.integral, 0.0, 1e4)?;
        within("pi.derivative", self.derivative, 0.0, 100.0)?;
        within("pi.derivative_filter", self.derivative_filter, 5e-3, 1.0)?;
        within("pi.most", self.most, 0.0, 1e3)
    }
}

/// Where a command is saturated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Saturated {
    /// At its greatest.
    pub above: bool,
    /// At its least.
    pub below: bool,
}

impl Saturated {
    /// Bit 0: above; bit 1: below.
    pub(super) fn bits(self) -> u32 {
        u32::from(self.above) + 2 * u32::from(self.below)
    }
}

summed! {
    /// Feedback.
    #[derive(Clone, Copy, Debug)]
    pub struct Pi<S: Scalar> {
        proportional: S,
        /// k_i/256 and 256 time steps: the product of a share and a number.
        integral: S,
        share: S::Share,
        most: S,
        /// k_d/T_d.
        derivative: S,
        filter: Lag<S>,
    }
}

/// State of the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiState<S: Scalar> {
    integral: S::Wide,
    /// The filtered error.
    filtered: S::Wide,
}

impl<S: Scalar> PiState<S> {
    /// Number of [`words`](Self::words).
    pub const WORDS: usize = 2 * S::WIDE_WORDS;

    /// The bits.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        [self.integral, self.filtered].into_iter().flat_map(S::wide_words)
    }

    /// The integral, in units of the output.
    pub fn integral(&self) -> S {
        S::of(self.integral)
    }
}

/// Errors are less than this: angles in rad, torques in 1,024 N m.
const GREATEST_ERROR: f64 = 100.0;
/// Range of the units.
const UNITS: (f64, f64) = (1e-3, 1e6);
/// An integral gain per tick is split: a share of 256 ticks, and the rest.
const TICKS: f64 = 256.0;

impl<S: Scalar> Pi<S> {
    /// Feedback whose output counts in `unit` N m and whose error in `error_unit` (rad or N m);
    /// both 1e-3 to 1e6. The error has field, value and limit. Fixed point refuses gains whose
    /// coefficients exceed 60.
    pub fn build(
        params: &PiParams,
        unit: f64,
        error_unit: f64,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        params.validate()?;
        within("pi: unit of the output, N m", unit, UNITS.0, UNITS.1)?;
        within("pi: unit of the error", error_unit, UNITS.0, UNITS.1)?;
        let scale = error_unit / unit;
        // In fixed point greater coefficients would saturate.
        let coefficient = |field, gain: f64, factor: f64, most: f64| {
            within(field, gain, 0.0, Arithmetic::min(S::LARGEST_COEFFICIENT / factor, most))?;
            Ok(S::from_f64(gain * factor))
        };
        let sum = scale * TICKS * step.seconds();
        let derivative = scale / params.derivative_filter;
        Ok(Self {
            proportional: coefficient("pi.proportional", params.proportional, scale, 1e3)?,
            integral: coefficient("pi.integral", params.integral, sum, 1e4)?,
            share: S::share(1.0 / TICKS),
            most: coefficient("pi.most", params.most, 1.0 / unit, 1e3)?,
            derivative: coefficient("pi.derivative", params.derivative, derivative, 100.0)?,
            filter: Lag::new(params.derivative_filter, step),
        })
    }

    /// No error for long.
    pub fn rested(&self) -> PiState<S> {
        PiState { integral: S::ZERO.wide(), filtered: S::ZERO.wide() }
    }

    /// The feedback of an error, clipped to ±100 units; one that is not finite counts as 0.
    pub fn step(&self, state: &mut PiState<S>, error: S, saturated: Saturated) -> S {
        let most = S::from_f64(GREATEST_ERROR);
        let error = if error.is_finite() { error.max(-most).min(most) } else { S::ZERO };
        let pushes_on =
            (saturated.above && error > S::ZERO) || (saturated.below && error < S::ZERO);
        if !pushes_on {
            let moved = S::advanced(state.integral, self.integral * error, self.share);
            let value = S::of(moved);
            let kept = value.max(-self.most).min(self.most);
            state.integral = if kept == value { moved } else { kept.wide() };
        }
        let ahead = error - S::of(state.filtered);
        state.filtered = self.filter.at_end(state.filtered, error);
        self.proportional * error + S::of(state.integral) + self.derivative * ahead
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        saved: &mut Saved<I>,
    ) -> Result<PiState<S>, RestoreError> {
        let integral = saved.wide(&Range { least: -self.most, most: self.most })?;
        let any = S::from_f64(GREATEST_ERROR);
        Ok(PiState { integral, filtered: saved.wide(&Range { least: -any, most: any })? })
    }
}
