//! Fatigue and recovery: fitness is a factor on force, 1 in a rested muscle.
//!
//! d fit/dt = (fit_min - fit) a λ/T_fat + (1 - fit)(1 - a λ)/T_rec,
//! λ = 1 - β + β (f/100 pps)², and 1 from 100 pps on,
//! with the activation a and the stimulation frequency f.
//!
//! Source: Riener, Quintern & Schmidt, J. Biomech. 29 (1996) 1157-1167; without dependence on
//! frequency, Riener & Veltink, IEEE Trans. Biomed. Eng. 45 (1998) 105-113. It is not part of
//! Virtual Muscle and does not change the bits of a muscle without it.

use crate::checksum::Checksum;
use crate::error::{ParameterError, within};
use crate::io::Output;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::scalar::float::one_minus_exp;
use crate::summed::{Summed, summed};
use crate::tick::admission::admit_one;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Frequency from which λ is 1, pps.
const SATURATING_FREQUENCY: f64 = 100.0;

/// Parameters of fatigue and recovery.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FatigueParams {
    /// Time constant T_fat towards the least fitness at full activation and 100 pps, s; 1 to 1,000.
    #[doc(alias = "T_fat")]
    pub fatigue_time: f64,
    /// Time constant T_rec of recovery at rest, s; 1 to 1,000.
    #[doc(alias = "T_rec")]
    pub recovery_time: f64,
    /// Least fitness fit_min; 0 to 1.
    #[doc(alias = "fit_min")]
    pub least_fitness: f64,
    /// Dependence on frequency β; 0 (none) to 1.
    #[doc(alias = "beta")]
    pub frequency_dependence: f64,
}

impl FatigueParams {
    /// Paralysed human quadriceps (Riener, Quintern & Schmidt 1996). Fatigue differs between
    /// muscles, patients and weeks of training more than any other parameter here: identify it.
    pub const QUADRICEPS: Self = Self {
        fatigue_time: 18.0,
        recovery_time: 30.0,
        least_fitness: 0.0,
        frequency_dependence: 0.6,
    };

    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("fatigue_time", self.fatigue_time, 1.0, 1000.0)?;
        within("recovery_time", self.recovery_time, 1.0, 1000.0)?;
        within("least_fitness", self.least_fitness, 0.0, 1.0)?;
        within("frequency_dependence", self.frequency_dependence, 0.0, 1.0)
    }
}

/// State of fatigue: plain data that can be copied and saved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FatigueState<S: Scalar> {
    /// Fitness in whole steps.
    steps: S,
    /// The remainder. A separate number, because near 1 the change of a tick may be below the ULP
    /// of `f32`.
    rest: S::Wide,
}

impl<S: Scalar> FatigueState<S> {
    /// Number of [`words`](Self::words).
    pub const WORDS: usize = 1 + S::WIDE_WORDS;
    /// Number of saved words: fingerprint and state.
    pub const SAVED_WORDS: usize = 1 + Self::WORDS;

    /// The bits, for comparison. [`Fatigue::save`] adds the fingerprint for storage.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        core::iter::once(self.steps.to_bits()).chain(S::wide_words(self.rest))
    }

    /// Fitness fit, 0..1.
    pub fn fitness(&self) -> S {
        (self.steps + S::of(self.rest)).max(S::ZERO).min(S::ONE)
    }
}

/// Step of fitness; 1 is a multiple of it.
const STEP: f64 = 1.0 / 16384.0;

summed! {
    /// Coefficients of fatigue and recovery for a time step.
    ///
    /// ```
    /// use vm_nostd::{Fatigue, FatigueParams, TimeStep};
    /// let fatigue = Fatigue::<f32>::build(&FatigueParams::QUADRICEPS, TimeStep::MILLISECOND)?;
    /// let mut state = fatigue.rested();
    /// // 30 s at 20 pps, then 30 s of rest.
    /// for _ in 0..30_000 {
    ///     fatigue.advance(&mut state, 1.0, 20.0);
    /// }
    /// let tired = state.fitness();
    /// for _ in 0..30_000 {
    ///     fatigue.advance(&mut state, 0.0, 20.0);
    /// }
    /// assert!((tired - 0.602).abs() < 0.001 && (state.fitness() - 0.854).abs() < 0.001);
    /// # Ok::<(), vm_nostd::ParameterError>(())
    /// ```
    #[derive(Clone, Copy, Debug)]
    pub struct Fatigue<S: Scalar> {
        activation: Range<S>,
        frequency: Range<S::Quantity>,
        /// 1/100, per pps.
        per_saturating_frequency: S::Factor,
        least_fitness: S,
        frequency_dependence: S,
        /// Share per tick of the distance to the least fitness, and of that to 1.
        tire: S::Share,
        recover: S::Share,
        step: S,
        /// A share of 1.
        all: S::Share,
    }
}

/// Distinguishes saved fatigue from saved muscles: no mode has this number.
const FATIGUE: u32 = 0;

impl<S: Scalar> Fatigue<S> {
    /// Builds fatigue for a time step; the error has field, value and limit.
    pub fn build(params: &FatigueParams, step: TimeStep) -> Result<Self, ParameterError> {
        params.validate()?;
        let share = |time: f64| S::share(one_minus_exp(step.seconds() / time));
        Ok(Self {
            activation: Range { least: S::ZERO, most: S::ONE },
            frequency: Range::new((0.0, SATURATING_FREQUENCY), S::quantity),
            per_saturating_frequency: S::per_quantity(1.0 / SATURATING_FREQUENCY),
            least_fitness: S::from_f64(params.least_fitness),
            frequency_dependence: S::from_f64(params.frequency_dependence),
            tire: share(params.fatigue_time),
            recover: share(params.recovery_time),
            step: S::from_f64(STEP),
            all: S::share(1.0),
        })
    }

    /// State of a rested muscle.
    pub fn rested(&self) -> FatigueState<S> {
        FatigueState { steps: S::ONE, rest: S::ZERO.wide() }
    }

    /// Fingerprint of coefficients, time step and arithmetic.
    fn fingerprint(&self) -> u32 {
        let mut fingerprint = Checksum::EMPTY;
        [S::ARITHMETIC, FATIGUE].into_iter().for_each(|word| fingerprint.add(word));
        self.sum(&mut fingerprint);
        fingerprint.value()
    }

    /// The [`FatigueState::SAVED_WORDS`] words of a saved state: a fingerprint of parameters, time
    /// step and arithmetic, then [`FatigueState::words`].
    pub fn save(&self, state: &FatigueState<S>) -> impl Iterator<Item = S::Bits> {
        core::iter::once(S::Bits::from(self.fingerprint())).chain(state.words())
    }

    /// Restores a state saved by [`Fatigue::save`]; an error if it was saved with other parameters
    /// or another time step, or is out of range.
    pub fn restore(
        &self,
        words: impl IntoIterator<Item = S::Bits>,
    ) -> Result<FatigueState<S>, RestoreError> {
        let length = FatigueState::<S>::SAVED_WORDS;
        let mut saved = Saved::new(words.into_iter(), length, self.fingerprint())?;
        let share = |value| self.activation.contains(value);
        let steps = saved.number(share)?;
        // A tick may change fitness by more than a step, so the remainder may exceed it.
        let rest = saved.wide(&Range { least: -S::ONE, most: S::ONE })?;
        saved.finished()?;
        Ok(FatigueState { steps, rest })
    }

    /// Advances by one tick at an activation (clipped to 0..1; NaN counts as 0) and a stimulation
    /// frequency in pps (clipped to 0..100; pass 100 for natural recruitment). Returns the new
    /// fitness.
    pub fn advance(
        &self,
        state: &mut FatigueState<S>,
        activation: S,
        stimulation_frequency: S::Quantity,
    ) -> S {
        let (activation, _) = admit_one(&self.activation, activation, S::ZERO, S::is_finite);
        let range = &self.frequency;
        let (frequency, _) =
            admit_one(range, stimulation_frequency, range.least, S::quantity_is_finite);
        let relative = S::of_quantity(frequency, &self.per_saturating_frequency);
        // 1 - β + β f².
        let strain = S::ONE - self.frequency_dependence * (S::ONE - relative * relative);
        let load = activation * strain;

        let fitness = state.fitness();
        let moved = S::advanced_by_two(
            state.rest,
            ((self.least_fitness - fitness) * load, self.tire),
            ((S::ONE - fitness) * (S::ONE - load), self.recover),
        );
        // Whole steps are moved from the remainder.
        let rest = S::of(moved);
        let whole = if rest >= self.step {
            self.step
        } else if rest <= -self.step {
            -self.step
        } else {
            S::ZERO
        };
        state.steps = state.steps + whole;
        state.rest = S::advanced(moved, -whole, self.all);
        state.fitness()
    }
}

impl<S: Scalar> Output<S> {
    /// The output with force multiplied by a fitness (0..1).
    #[must_use]
    pub fn fatigued(self, fitness: S) -> Self {
        let relative_force = fitness * self.relative_force;
        Self { force: fitness.of_share(self.force), relative_force, ..self }
    }
}
