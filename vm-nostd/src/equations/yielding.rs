//! Yield of slow fibres: dY/dt = (1 - cY (1 - exp(-|V|/VY)) - Y)/TY.

use crate::checksum::summed;
use crate::error::{ParameterError, within};
use crate::params::limits::MAXIMUM_SPEED;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

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

/// The unit of a variance of speeds, (L_ce0/s)²: no square of a speed that fascicles can have is
/// out of the range of fixed point.
pub(crate) const SPREAD: f64 = 64.0;

/// Fascicle speed |V| during a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Speed<S> {
    /// Its mean, L_ce0/s.
    pub(crate) mean: S,
    /// Its variance, [`SPREAD`] (L_ce0/s)²; never negative.
    pub(crate) variance: S,
}

impl<S: Scalar> Speed<S> {
    pub(crate) const NONE: Self = Self { mean: S::ZERO, variance: S::ZERO };

    pub(crate) fn restored<I: Iterator<Item = S::Bits>>(
        saved: &mut Saved<I>,
    ) -> Result<Self, RestoreError> {
        // The mean of a substep may be beyond the greatest speed, which is that of its middle, by a
        // few percent; a variance is less than the square of that.
        let range = Range::new((0.0, 2.0 * MAXIMUM_SPEED), S::from_f64);
        let mut number = || saved.number(|value| range.contains(value));
        Ok(Self { mean: number()?, variance: number()? })
    }
}

/// Yield of one fibre type; Y stays 1 for a type without it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Yielding<S: Scalar> {
    depth: S,
    /// 1/VY.
    per_velocity: S::Factor,
    /// Half the unit of a variance of speeds over VY².
    per_spread: S::Factor,
    lag: Lag<S>,
}

summed!([S: Scalar] Yielding<S> { depth, per_velocity, per_spread, lag });

impl<S: Scalar> Yielding<S> {
    pub(crate) fn new(params: Option<&YieldParams>, step: TimeStep) -> Self {
        let (depth, velocity, time_constant) =
            params.map_or((0.0, 1.0, 1.0), |p| (p.depth, p.velocity, p.time_constant));
        Self {
            depth: S::from_f64(depth),
            per_velocity: S::factor(1.0 / velocity),
            per_spread: S::factor(0.5 * SPREAD / (velocity * velocity)),
            lag: Lag::new(time_constant, step),
        }
    }

    /// Where Y always is.
    pub(crate) fn range(&self) -> Range<S> {
        Range { least: S::ONE - self.depth, most: S::ONE }
    }

    /// Y at a tick's end, by the fascicle speed during that tick.
    ///
    /// The mean of exp(-|V|/VY) over the tick is exp(-mean/VY) (1 + variance/(2 VY²)) to second
    /// order. A velocity taken at the tick's boundary would be biased: inputs that step every tick
    /// make it ripple in step with them.
    #[inline(always)]
    pub(crate) fn advance(&self, yielding: S::LagState, speed: &Speed<S>) -> S::LagState {
        if self.depth == S::ZERO {
            return yielding;
        }
        let at_mean = (-speed.mean.scaled(&self.per_velocity)).exp();
        let spread = speed.variance.scaled(&self.per_spread);
        let kept = (at_mean + at_mean * spread).min(S::ONE);
        self.lag.at_end(yielding, S::ONE - self.depth * (S::ONE - kept))
    }
}
