//! Proportional and integral feedback with anti-windup.
//!
//! u = k_p e + k_i ∫ e dt. The integral is held while the command is saturated in the direction that
//! the error would push it further (conditional integration), and never exceeds its limit.

use crate::checksum::summed;
use crate::error::{ParameterError, within};
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Gains of the feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PiParams {
    /// k_p, N m per rad (of torque: per N m); 0 to 1,000. More is stiffer, until delay makes it
    /// oscillate.
    pub proportional: f64,
    /// k_i, the same per s; 0 to 10,000. More removes an offset faster and overshoots.
    pub integral: f64,
    /// Greatest torque of the integral, N m; 0 to 1,000.
    pub most: f64,
}

impl PiParams {
    /// Validates the gains; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("pi.proportional", self.proportional, 0.0, 1e3)?;
        within("pi.integral", self.integral, 0.0, 1e4)?;
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

/// Feedback.
#[derive(Clone, Copy, Debug)]
pub struct Pi<S: Scalar> {
    proportional: S,
    /// k_i/256 and 256 time steps: the product of a share and a number.
    integral: S,
    share: S::Share,
    most: S,
}

summed!([S: Scalar] Pi<S> { proportional, integral, share, most });

/// An integral gain per tick is split: a share of 256 ticks, and the rest.
const TICKS: f64 = 256.0;

impl<S: Scalar> Pi<S> {
    /// Feedback whose output counts in `unit` N m and whose error in `error_unit`.
    pub fn build(
        params: &PiParams,
        unit: f64,
        error_unit: f64,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        params.validate()?;
        let scale = error_unit / unit;
        Ok(Self {
            proportional: S::from_f64(params.proportional * scale),
            integral: S::from_f64(params.integral * scale * TICKS * step.seconds()),
            share: S::share(1.0 / TICKS),
            most: S::from_f64(params.most / unit),
        })
    }

    /// k_p e + I, and the integral afterwards.
    pub fn step(&self, integral: &mut S::LagState, error: S, saturated: Saturated) -> S {
        let pushes_on =
            (saturated.above && error > S::ZERO) || (saturated.below && error < S::ZERO);
        if !pushes_on {
            let moved = S::advanced(*integral, self.integral * error, self.share);
            let value = S::of(moved);
            let kept = value.max(-self.most).min(self.most);
            *integral = if kept == value { moved } else { kept.lag_state() };
        }
        self.proportional * error + S::of(*integral)
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        saved: &mut Saved<I>,
    ) -> Result<S::LagState, RestoreError> {
        saved.lag_state(&Range { least: -self.most, most: self.most })
    }
}
