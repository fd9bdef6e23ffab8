//! The time step a muscle is built for.

use crate::error::{ParameterError, within};

/// Time between two ticks, 0.1 ms to 2 ms. Coefficients are computed for it when a muscle is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStep(f64);

impl TimeStep {
    /// 1 ms, a tick rate of 1 kHz.
    pub const MILLISECOND: Self = Self(1e-3);
    /// Shortest step, s.
    pub const SHORTEST: f64 = 1e-4;
    /// Longest step, s.
    pub const LONGEST: f64 = 2e-3;

    /// A step of `seconds`; an error outside [`SHORTEST`](Self::SHORTEST) to
    /// [`LONGEST`](Self::LONGEST).
    pub const fn from_seconds(seconds: f64) -> Result<Self, ParameterError> {
        match within("time_step", seconds, Self::SHORTEST, Self::LONGEST) {
            Ok(()) => Ok(Self(seconds)),
            Err(error) => Err(error),
        }
    }

    /// One of equal parts of the step.
    pub(crate) fn part(self, parts: u8) -> Self {
        Self(self.0 / f64::from(parts))
    }

    /// The step in s.
    pub const fn seconds(self) -> f64 {
        self.0
    }
}
