//! Yield of slow fibres: dY/dt = (1 - cY (1 - exp(-|V|/VY)) - Y)/TY.

use crate::error::{ParameterError, within};
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::summed::summed;
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
    /// Time constant T_Y, s; 0.05 to 10. If it were shorter, yield would couple to the velocity
    /// within a tick.
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

/// Unit of the variance of speed, (L_ce0/s)², so that squares of all speeds in the state range are
/// representable in fixed point.
pub(crate) const SPREAD: f64 = 64.0;

/// Fascicle speed |V| during a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Speed<S> {
    /// Mean, L_ce0/s.
    pub(crate) mean: S,
    /// Variance, [`SPREAD`] (L_ce0/s)²; not negative.
    pub(crate) variance: S,
}

impl<S: Scalar> Speed<S> {
    pub(crate) const NONE: Self = Self { mean: S::ZERO, variance: S::ZERO };

    pub(crate) fn restored<I: Iterator<Item = S::Bits>>(
        saved: &mut Saved<I>,
    ) -> Result<Self, RestoreError> {
        // Nothing else bounds them: where the velocity is clamped, the mean of a substep is not.
        let mut number = || saved.number(|value: S| value >= S::ZERO && value.is_finite());
        Ok(Self { mean: number()?, variance: number()? })
    }
}

summed! {
    /// Yield of one fibre type; Y is 1 for a type without yield.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Yielding<S: Scalar> {
        depth: S,
        /// 1/VY.
        per_velocity: S::Factor,
        /// Half the unit of the variance of speed, over VY².
        per_spread: S::Factor,
        lag: Lag<S>,
    }
}

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

    /// Range of Y.
    pub(crate) fn range(&self) -> Range<S> {
        Range { least: S::ONE - self.depth, most: S::ONE }
    }

    /// Y at the end of a tick, from the fascicle speed during that tick.
    ///
    /// To second order, the mean of exp(-|V|/VY) over the tick is
    /// exp(-mean/VY) (1 + variance/(2 VY²)). The tick-boundary velocity would give a biased mean:
    /// with inputs that step every tick, it ripples at the tick rate.
    #[inline(always)]
    pub(crate) fn advance(&self, yielding: S::Wide, speed: &Speed<S>) -> S::Wide {
        if self.depth == S::ZERO {
            return yielding;
        }
        let at_mean = (-speed.mean.scaled(&self.per_velocity)).exp();
        let spread = speed.variance.scaled(&self.per_spread);
        let mean_exponential = (at_mean + at_mean * spread).min(S::ONE);
        self.lag.at_end(yielding, S::ONE - self.depth * (S::ONE - mean_exponential))
    }
}
