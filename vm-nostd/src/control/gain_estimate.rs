//! On-line estimate of a muscle's gain: the torque it makes over the torque the model expects.
//!
//! The model's inverse is asked for a torque c = τ/ĝ + p: the feed-forward torque over the
//! estimate, and what the feedback adds. If the muscle makes g c, tracking needs g c = τ, and p
//! says how far the estimate is off: dĝ/dt = -(p/c)/T moves it until p is 0. It is a gradient rule,
//! slower than the feedback so that both do not fight.

use crate::error::{ParameterError, within};
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::summed::summed;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Parameters of the estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GainParams {
    /// Time constant T, s; 0.1 to 1,000. Less follows fatigue faster and follows noise too. `f32`
    /// refuses one with which a feedback of 5 % of the torque would not move the greatest gain: at
    /// 1 ms more than 419 s for a greatest gain of 2.
    pub time: f64,
    /// Least gain; 0.1 to 1.
    pub least: f64,
    /// Greatest gain; 1 to 10.
    pub most: f64,
    /// Torque below which nothing can be learnt, N m; 0.01 to 100. The estimate is frozen there.
    pub excitation: f64,
}

impl GainParams {
    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("gain.time", self.time, 0.1, 1e3)?;
        within("gain.least", self.least, 0.1, 1.0)?;
        within("gain.most", self.most, 1.0, 10.0)?;
        within("gain.excitation", self.excitation, 0.01, 100.0)
    }
}

summed! {
    /// An estimate's coefficients.
    #[derive(Clone, Copy, Debug)]
    pub struct GainEstimate<S: Scalar> {
        share: S::Share,
        range: Range<S>,
        excitation: S,
    }
}

/// What an update has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learnt {
    /// It moved the estimate.
    Moved,
    /// Not excited, or saturated: frozen.
    Frozen,
    /// It would have left its range, or a torque was not finite: refused.
    Refused,
}

/// Feedback over torque that has to move the greatest gain.
const RESOLVED: f64 = 0.05;

/// Longest time constant (s) with which a tick's change is not lost to rounding.
fn longest_time<S: Scalar>(most: f64, step: TimeStep) -> f64 {
    let gain = S::from_f64(most).wide();
    let moves = |time: f64| {
        S::advanced(gain, S::from_f64(RESOLVED), S::share(step.seconds() / time)) != gain
    };
    let (mut least, mut longest) = (0.1, 1e3);
    if moves(longest) {
        return longest;
    }
    for _ in 0..40 {
        let middle = 0.5 * (least + longest);
        if moves(middle) { least = middle } else { longest = middle }
    }
    least
}

impl<S: Scalar> GainEstimate<S> {
    /// An estimate for torques that count in `unit` N m (1e-3 to 1e6); the error has field, value
    /// and limit.
    pub fn build(params: &GainParams, unit: f64, step: TimeStep) -> Result<Self, ParameterError> {
        params.validate()?;
        within("gain: unit of torques, N m", unit, 1e-3, 1e6)?;
        within("gain.time", params.time, 0.1, longest_time::<S>(params.most, step))?;
        Ok(Self {
            share: S::share(step.seconds() / params.time),
            range: Range::new((params.least, params.most), S::from_f64),
            excitation: S::from_f64(params.excitation / unit),
        })
    }

    /// Moves the estimate by what the feedback adds to the torque that the inverse was asked for.
    pub fn step(&self, gain: &mut S::Wide, asked: S, feedback: S, saturated: bool) -> Learnt {
        if saturated || asked.abs() < self.excitation {
            return Learnt::Frozen;
        }
        if !(asked.is_finite() && feedback.is_finite()) {
            return Learnt::Refused;
        }
        // At most 1: one bad sample moves it by no more than a tick over T.
        let same = (feedback > S::ZERO) == (asked > S::ZERO);
        let ratio = feedback.abs().ratio(asked.abs()).min(S::ONE);
        let moved = S::advanced(*gain, if same { -ratio } else { ratio }, self.share);
        if self.range.contains(S::of(moved)) {
            *gain = moved;
            Learnt::Moved
        } else {
            Learnt::Refused
        }
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        saved: &mut Saved<I>,
    ) -> Result<S::Wide, RestoreError> {
        saved.wide(&self.range)
    }
}
