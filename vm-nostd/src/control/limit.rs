//! Limits of a command: range and rate.

use crate::error::{ParameterError, within};
use crate::scalar::{Arithmetic, Scalar};
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

/// Range and rate of a command, in its unit and per second.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CommandLimits {
    /// Least command; -30,000 to 30,000.
    pub least: f64,
    /// Greatest command; the least to 30,000.
    pub most: f64,
    /// Greatest change per second; 1.2e-4 per time step (0.12 at 1 ms) to 1e7. Less is smoother and
    /// slower.
    pub rate: f64,
}

summed! {
    /// The limits, in units of the torque.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Limiter<S: Scalar> {
        least: S,
        most: S,
        /// Greatest change per tick.
        change: S,
    }
}

/// What a limiter had to change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limited {
    pub(super) range: bool,
    pub(super) rate: bool,
}

impl<S: Scalar> Limiter<S> {
    /// A limiter of numbers that count in `unit`; `names` are those of the three fields.
    pub(super) fn new(
        limits: &CommandLimits,
        names: [&'static str; 3],
        unit: f64,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        let largest = 30_000.0;
        within(names[0], limits.least, -largest, largest)?;
        within(names[1], limits.most, limits.least, largest)?;
        // In fixed point a smaller step would be rounded to none.
        let least_rate = 2.0 * unit * 6e-8 / step.seconds();
        within(names[2], limits.rate, least_rate, 1e7)?;
        Ok(Self {
            least: S::from_f64(limits.least / unit),
            most: S::from_f64(limits.most / unit),
            change: S::from_f64(Arithmetic::min(limits.rate * step.seconds() / unit, 60.0)),
        })
    }

    pub(super) fn clip(&self, value: S) -> S {
        value.max(self.least).min(self.most)
    }

    /// `wanted` as near as the limits allow it one tick after `last`.
    pub(super) fn limit(&self, last: S, wanted: S) -> (S, Limited) {
        let clipped = self.clip(wanted);
        let near = clipped.max(last - self.change).min(last + self.change);
        (near, Limited { range: clipped != wanted, rate: near != clipped })
    }
}
