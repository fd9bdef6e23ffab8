//! Yield of slow fibres: dY/dt = (1 - cY (1 - exp(-|V|/VY)) - Y)/TY.

use crate::checksum::summed;
use crate::domain::Range;
use crate::error::{ParameterError, within};
use crate::lag::Lag;
use crate::scalar::Scalar;
use crate::time_step::TimeStep;

/// Coefficients of yield.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct YieldParams {
    /// Depth c_Y; 0 to 0.95.
    #[doc(alias = "cY")]
    pub depth: f64,
    /// Velocity scale V_Y, L_ce0/s; 0.01 to 100.
    #[doc(alias = "VY")]
    pub velocity: f64,
    /// Time constant T_Y, s; 0.05 to 10: faster, yield would couple to the velocity within a
    /// tick.
    #[doc(alias = "TY")]
    pub time_constant: f64,
}

impl YieldParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("yielding.depth", self.depth, 0.0, 0.95)?;
        within("yielding.velocity", self.velocity, 0.01, 100.0)?;
        within("yielding.time_constant", self.time_constant, 0.05, 10.0)
    }
}

/// Yield of one fibre type; Y stays 1 for a type without it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Yielding<S: Scalar> {
    depth: S,
    /// 1/VY.
    per_velocity: S::Factor,
    lag: Lag<S>,
}

summed!([S: Scalar] Yielding<S> { depth, per_velocity, lag });

impl<S: Scalar> Yielding<S> {
    pub(crate) fn new(params: Option<&YieldParams>, step: TimeStep) -> Self {
        let (depth, velocity, time_constant) =
            params.map_or((0.0, 1.0, 1.0), |p| (p.depth, p.velocity, p.time_constant));
        Self {
            depth: S::from_f64(depth),
            per_velocity: S::factor(1.0 / velocity),
            lag: Lag::new(time_constant, step),
        }
    }

    /// Where Y always is.
    pub(crate) fn range(&self) -> Range<S> {
        Range { least: S::ONE - self.depth, most: S::ONE }
    }

    /// Y a tick later than it was, the fascicle velocity (L_ce0/s) being given for the middle of that
    /// time.
    #[inline(always)]
    pub(crate) fn advance(&self, yielding: S::Slow, velocity: S) -> S::Slow {
        if self.depth == S::ZERO {
            return yielding;
        }
        let lost = S::ONE - (-velocity.abs().scaled(&self.per_velocity)).exp();
        self.lag.at_end(yielding, S::ONE - self.depth * lost)
    }
}
