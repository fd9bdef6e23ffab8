//! Natural continuous recruitment: one lumped unit per fibre type.
//!
//! Uth_1 = 0.001, Uth_i = U_r × cross section of types 1 to i - 1;
//! dU_eff/dt = (U - U_eff)/T_U, T_U = 0.03 s rising, 0.15 s falling;
//! W_i = (U_eff - Uth_i)/Σ (U_eff - Uth_k), over all recruited types.
//!
//! In the paper's equation the sum ends at i. The paper's results and the authors' program sum over
//! all recruited types, so that the weights add up to 1.

use super::firing::Firing;
use super::lumped::{self, LumpedInput, LumpedOutput, LumpedState};
use super::mode::{Moment, Recruited, Recruitment, RecruitmentTick};
use crate::equations::sag::FIRING;
use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::summed::summed;
use crate::tick::lag::Lag;
use crate::tick::range::{Range, share};
use crate::tick::time_step::TimeStep;
use core::array::from_fn;

/// Natural continuous recruitment. The stimulation frequency is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NaturalContinuous;

impl Sealed for NaturalContinuous {}

impl<S: Scalar, const N: usize> Recruitment<S, N> for NaturalContinuous {
    const MODE: u32 = 1;

    type Units = ();
    type State = LumpedState<S, N>;
    type Coefficients = Coefficients<S, N>;
}

/// Threshold of the first type, and time constants of effective activation (s).
const FIRST_THRESHOLD: f64 = 0.001;
const RISE_TIME: f64 = 0.03;
const FALL_TIME: f64 = 0.15;

summed! {
    #[derive(Clone, Copy, Debug)]
    pub struct Coefficients<S: Scalar, const N: usize> {
        rise: Lag<S>,
        fall: Lag<S>,
        units: [Firing<S>; N],
    }
}

impl<S: Scalar, const N: usize> Coefficients<S, N> {
    /// Steady-state weight U_eff W_i and firing frequency (f0.5) of each type at an activation.
    pub(crate) fn steady(&self, activation: S) -> [(S, S); N] {
        let above = |unit: &Firing<S>| (activation - unit.threshold).max(S::ZERO);
        let sum = self.units.iter().fold(S::ZERO, |sum, unit| sum + above(unit));
        let per_sum = if sum > S::ZERO { sum } else { S::ONE }.reciprocal_factor();
        self.units
            .each_ref()
            .map(|unit| (activation * above(unit).scaled(&per_sum), unit.frequency(activation)))
    }

    /// Steady-state S of a type that fires at a frequency (f0.5).
    pub(crate) fn steady_sag(&self, fiber: &Fiber<S>, frequency: S) -> S {
        fiber.sag.steady(frequency >= S::constant(&FIRING))
    }
}

impl<S: Scalar, const N: usize> RecruitmentTick<S, N> for Coefficients<S, N> {
    const PASSIVE_ONLY_PULLS: bool = false;

    type Units = ();
    type State = LumpedState<S, N>;

    fn new(
        params: &MuscleParams<N>,
        (): &Self::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        let mut before = 0.0;
        let units = params.fibers.map(|fiber| {
            let t = &fiber.fiber_type;
            let threshold = if before == 0.0 {
                FIRST_THRESHOLD
            } else {
                params.recruitment_saturation * before
            };
            before += fiber.fraction;
            Firing::new(t, threshold)
        });
        Ok(Self { rise: Lag::new(RISE_TIME, step), fall: Lag::new(FALL_TIME, step), units })
    }

    fn at_rest(&self, fibers: &[Fiber<S>; N]) -> Self::State {
        LumpedState::at_rest(fibers)
    }

    fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError> {
        let frequencies =
            self.units.map(|unit| Range { least: S::ZERO, most: unit.frequency(S::ONE) });
        LumpedState::restored(fibers, saved, share(), frequencies)
    }

    #[inline(always)]
    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
    ) -> [Recruited<S>; N] {
        let activation = moment.input.activation;
        let start = state.shared;
        // U is constant during a tick and U_eff does not overshoot it: one branch per tick.
        let lag = if activation >= S::of(start) { &self.rise } else { &self.fall };
        let middle = lag.at_middle(start, activation);
        state.shared = lag.at_end(start, activation);

        let excesses = self.units.each_ref().map(|unit| (middle - unit.threshold).of_sign(false));
        let sum = excesses.into_iter().fold(S::ZERO, |sum, excess| sum + excess);
        // If no type is recruited, all excesses are 0: any divisor will do.
        let per_sum = if sum > S::ZERO { sum } else { S::ONE }.reciprocal_factor();
        // U_eff W_i.
        let mut weights = excesses;
        for weight in &mut weights {
            *weight = middle * weight.scaled(&per_sum);
        }

        let drives = self.units.each_ref().map(|unit| unit.frequency(activation));
        let input = |i: usize, fiber_state| LumpedInput {
            fiber: &fibers[i],
            state: fiber_state,
            drive: drives[i],
            frequency: drives[i],
            slowing: state.activities[i].predicted,
            yielding: moment.yieldings[i],
        };
        let advanced = lumped::advance_all::<S, false, N>(&mut state.fibers, input, moment);
        from_fn(|i| {
            let LumpedOutput { activation, .. } = advanced[i];
            state.activities[i] = state.activities[i].next(activation);
            let weight = weights[i];
            Recruited { activation, weight, change_after_jump: None, compression_weight: weight }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::PAPER_MUSCLE;

    fn coefficients() -> Coefficients<f32, 2> {
        Coefficients::new(&PAPER_MUSCLE, &(), TimeStep::MILLISECOND).expect("a valid muscle")
    }

    #[test]
    fn nothing_is_recruited_without_activation() {
        for activation in [0.0, 0.0009] {
            assert_eq!(coefficients().steady(activation), [(0.0, 0.0); 2]);
        }
    }

    /// As in a tick: from 0.1 f0.5 on.
    #[test]
    fn a_fast_type_sags_from_a_frequency_of_a_tenth_on() {
        let [_, fast] = PAPER_MUSCLE.fibers;
        let domain = PAPER_MUSCLE.fascicle_domain();
        let fiber = Fiber::new(&fast, domain, TimeStep::MILLISECOND);
        let sag = |frequency| coefficients().steady_sag(&fiber, frequency);
        assert_eq!([sag(0.099_999), sag(0.1)], [1.76, 0.96]);
    }
}
