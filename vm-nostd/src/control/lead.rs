//! Inverse of the excitation dynamics: a filtered lead.
//!
//! Excitation is two lags of a time constant T in series (T differs for rising and falling). Two
//! leads (1 + T s)/(1 + T_f s) in series cancel them and leave two lags of the filter time T_f.

use crate::error::{ParameterError, within};
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Arithmetic, Scalar};
use crate::summed::summed;
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Time constants of a lead.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeadParams {
    /// Time constant T of rising excitation that is cancelled, s; 0.001 to 1.
    pub rise_time: f64,
    /// Time constant T of falling excitation that is cancelled, s; 0.001 to 1.
    pub fall_time: f64,
    /// Filter time T_f that is left, s; a tenth of the longer of both to 1. Shorter follows faster
    /// and asks for stimulation beyond 0..1, which is clipped.
    pub filter_time: f64,
}

impl LeadParams {
    /// The lead for a muscle at optimal length under FES at a frequency (pps): means of its types
    /// by cross section of T_f1 + T_f2 f_env and of T_f3 + T_f4.
    pub fn of_muscle<const N: usize>(
        muscle: &MuscleParams<N>,
        stimulation_frequency: f64,
        filter_time: f64,
    ) -> Self {
        let (mut rise_time, mut fall_time) = (0.0, 0.0);
        for fiber in &muscle.fibers {
            let t = &fiber.fiber_type;
            let firing = stimulation_frequency / t.half_force_frequency;
            let e = &t.excitation;
            rise_time += fiber.fraction * (e.rise + e.rise_per_frequency * firing);
            fall_time += fiber.fraction * (e.fall + e.fall_per_activation);
        }
        Self { rise_time, fall_time, filter_time }
    }

    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("lead.rise_time", self.rise_time, 1e-3, 1.0)?;
        within("lead.fall_time", self.fall_time, 1e-3, 1.0)?;
        let longer = Arithmetic::max(self.rise_time, self.fall_time);
        within("lead.filter_time", self.filter_time, 0.1 * longer, 1.0)
    }
}

summed! {
    /// A filtered lead.
    #[derive(Clone, Copy, Debug)]
    pub struct Lead<S: Scalar> {
        filter: Lag<S>,
        /// T/T_f of rising and falling.
        rise: S,
        fall: S,
        most: S,
    }
}

/// State of a lead: the filtered input of both stages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadState<S: Scalar>([S::Wide; 2]);

/// Range of what the stages hold.
const MOST: f64 = 12.0;

impl<S: Scalar> LeadState<S> {
    /// Number of [`words`](Self::words).
    pub const WORDS: usize = 2 * S::WIDE_WORDS;

    /// The bits.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        self.0.into_iter().flat_map(S::wide_words)
    }
}

impl<S: Scalar> Lead<S> {
    /// Builds a lead for a time step; the error has field, value and limit.
    pub fn build(params: &LeadParams, step: TimeStep) -> Result<Self, ParameterError> {
        params.validate()?;
        Ok(Self {
            filter: Lag::new(params.filter_time, step),
            rise: S::from_f64(params.rise_time / params.filter_time),
            fall: S::from_f64(params.fall_time / params.filter_time),
            most: S::from_f64(MOST),
        })
    }

    /// State of an input that was 0 for long.
    pub fn rested(&self) -> LeadState<S> {
        LeadState([S::ZERO.wide(); 2])
    }

    /// Takes the wanted activation, 0..1; returns the stimulation that makes the muscle follow it,
    /// which may be outside of 0..1.
    pub fn step(&self, state: &mut LeadState<S>, wanted: S) -> S {
        let [first, second] = &mut state.0;
        let between = self.stage(first, wanted.max(S::ZERO).min(S::ONE));
        self.stage(second, between.max(-self.most).min(self.most))
    }

    /// x + (T/T_f - 1)(x - l) with the filtered input l: (1 + T s)/(1 + T_f s). What is held for a
    /// tick is taken at its middle.
    fn stage(&self, filtered: &mut S::Wide, input: S) -> S {
        let ahead = input - self.filter.at_middle(*filtered, input);
        *filtered = self.filter.at_end(*filtered, input);
        let ratio = if ahead >= S::ZERO { self.rise } else { self.fall };
        input + (ratio - S::ONE) * ahead
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        saved: &mut Saved<I>,
    ) -> Result<LeadState<S>, RestoreError> {
        let range = Range { least: -self.most, most: self.most };
        Ok(LeadState([saved.wide(&range)?, saved.wide(&range)?]))
    }
}
