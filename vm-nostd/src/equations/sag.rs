//! Sag of fast fibres: dS/dt = (aS - S)/TS, aS = aS1 below f = 0.1 f0.5, else aS2.

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::scalar::cold::cold_path;
use crate::scalar::constant::Constant;
use crate::summed::summed;
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Coefficients of sag.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SagParams {
    /// Level at rest a_S1; 0.01 to 10.
    #[doc(alias = "aS1")]
    pub resting_level: f64,
    /// Level while firing a_S2; 0.01 to 10.
    #[doc(alias = "aS2")]
    pub firing_level: f64,
    /// Time constant T_S, s; 0.01 to 10.
    #[doc(alias = "TS")]
    pub time_constant: f64,
}

impl SagParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("sag.resting_level", self.resting_level, 0.01, 10.0)?;
        within("sag.firing_level", self.firing_level, 0.01, 10.0)?;
        within("sag.time_constant", self.time_constant, 0.01, 10.0)
    }
}

/// Frequency above which a type counts as firing, f0.5.
pub(crate) const FIRING: Constant = Constant::new(0.1);

summed! {
    /// Sag of one fibre type; S is 1 for a type without sag.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Sag<S: Scalar> {
        pub(crate) resting_level: S,
        firing_level: S,
        lag: Lag<S>,
    }
}

impl<S: Scalar> Sag<S> {
    pub(crate) fn new(params: Option<&SagParams>, step: TimeStep) -> Self {
        // Without sag both levels and S are 1.
        let (resting, firing, time_constant) =
            params.map_or((1.0, 1.0, 1.0), |p| (p.resting_level, p.firing_level, p.time_constant));
        Self {
            resting_level: S::from_f64(resting),
            firing_level: S::from_f64(firing),
            lag: Lag::new(time_constant, step),
        }
    }

    /// Range of S.
    pub(crate) fn range(&self) -> Range<S> {
        let (a, b) = (self.resting_level, self.firing_level);
        Range { least: a.min(b), most: a.max(b) }
    }

    /// Steady-state S of a type that fires or is at rest.
    pub(crate) fn steady(&self, firing: bool) -> S {
        if firing { self.firing_level } else { self.resting_level }
    }

    /// S at the end of the tick if the type fired for a `share` (0..1) of the tick.
    pub(crate) fn advance(&self, sag: S::Wide, share: S) -> S::Wide {
        let target = self.resting_level + (self.firing_level - self.resting_level) * share;
        self.lag.at_end(sag, target)
    }
}

/// Share of a tick (0..1) in which a frequency from `start` to `end` is at or above `level`.
pub(crate) fn share_above<S: Scalar>(start: S, end: S, level: S) -> S {
    let (fired, fires) = (start >= level, end >= level);
    if fired == fires {
        return if fires { S::ONE } else { S::ZERO };
    }
    cold_path();
    if fired { (start - level).ratio(start - end) } else { (end - level).ratio(end - start) }
}
