//! Intramuscular FES: every fibre type is recruited in proportion to its cross section, at one
//! stimulation frequency.
//!
//! f_env_i = f_stim/f0.5_i, always on, and Af_i uses it directly; the two lags of excitation are
//! driven by U instead and carry the recruitment. Rising Tf = Tf1 L² + Tf2 f_env_i, falling
//! Tf = (Tf3 + Tf4 [U > 0])/L. Sag switches on f_env_i > 0.1.

use super::lumped::LumpedState;
use super::mode::{Moment, Recruited, Recruitment, RecruitmentTick};
use super::unit::activated;
use crate::checksum::summed;
use crate::equations::sag::SagParams;
use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::params::limits::MAXIMUM_STIMULATION_FREQUENCY;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::tick::range::{Range, share};
use crate::tick::time_step::TimeStep;

/// Intramuscular FES: activation is the strength of the stimulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntramuscularFes;

impl Sealed for IntramuscularFes {}

impl<S: Scalar, const N: usize> Recruitment<S, N> for IntramuscularFes {
    const MODE: u32 = 2;

    type Units = ();
    type State = LumpedState<S, N>;
    type Coefficients = Coefficients<S, N>;
}

#[derive(Clone, Copy, Debug)]
pub struct Coefficients<S: Scalar, const N: usize> {
    firing: S,
    units: [Unit<S>; N],
}

summed!([S: Scalar, const N: usize] Coefficients<S, N> { firing, units });

#[derive(Clone, Copy, Debug)]
struct Unit<S: Scalar> {
    fraction: S,
    /// 1/f0.5, s.
    per_half_force_frequency: S::Factor,
}

summed!([S: Scalar] Unit<S> { fraction, per_half_force_frequency });

impl<S: Scalar, const N: usize> Coefficients<S, N> {
    /// Recruited share of the muscle of each type.
    pub(crate) fn weights(&self, state: &LumpedState<S, N>) -> [S; N] {
        core::array::from_fn(|i| {
            self.units[i].fraction * S::of(state.fibers[i].effective_frequency)
        })
    }

    /// f_env of the first type, f0.5.
    fn first_frequency(&self, stimulation_frequency: S::Quantity) -> S {
        self.units.first().map_or(S::ZERO, |unit| {
            S::of_quantity(stimulation_frequency, &unit.per_half_force_frequency)
        })
    }
}

impl<S: Scalar, const N: usize> RecruitmentTick<S, N> for Coefficients<S, N> {
    const PASSIVE_ONLY_PULLS: bool = true;

    type Units = ();
    type State = LumpedState<S, N>;

    fn new(
        params: &MuscleParams<N>,
        (): &Self::Units,
        _step: TimeStep,
    ) -> Result<Self, ParameterError> {
        Ok(Self {
            firing: S::from_f64(SagParams::FIRING),
            units: params.fibers.map(|fiber| Unit {
                fraction: S::from_f64(fiber.fraction),
                per_half_force_frequency: S::per_quantity(
                    1.0 / fiber.fiber_type.half_force_frequency,
                ),
            }),
        })
    }

    fn at_rest(&self, fibers: &[Fiber<S>; N]) -> Self::State {
        LumpedState::at_rest(fibers)
    }

    fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError> {
        let highest = self.first_frequency(S::quantity(MAXIMUM_STIMULATION_FREQUENCY));
        let first_frequency = Range { least: S::ZERO, most: highest };
        // The two lags carry the recruitment.
        LumpedState::restored(fibers, saved, first_frequency, [share(); N])
    }

    #[inline(always)]
    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
        mut recruited: impl FnMut(&Fiber<S>, Recruited<S>),
    ) {
        let input = &moment.input;
        let slowing = if input.activation > S::ZERO { S::ONE } else { S::ZERO };
        // Af takes the frequency as it is: where that steps, so does Af.
        let first = self.first_frequency(input.stimulation_frequency);
        let jumps = first != S::of(state.shared);
        state.shared = first.lag_state();
        let kept = state.fibers.iter_mut();
        for (((unit, kept), fiber), yieldings) in
            self.units.iter().zip(kept).zip(fibers).zip(&moment.yieldings)
        {
            let frequency =
                S::of_quantity(input.stimulation_frequency, &unit.per_half_force_frequency);
            let before = kept.effective_frequency;
            let excited = fiber.excitation.advance(
                (kept.intermediate_frequency, before),
                input.activation,
                frequency,
                slowing,
                (moment.fascicle_length, moment.reciprocal),
            );
            kept.intermediate_frequency = excited.intermediate;
            kept.effective_frequency = excited.effective;
            let activation = activated(
                fiber,
                &fiber.activation.at(moment.reciprocal),
                &mut kept.sag,
                *yieldings,
                frequency,
                if frequency > self.firing { S::ONE } else { S::ZERO },
            );
            let weight = unit.fraction * excited.effective_at_middle;
            let recruitment = Recruited {
                activation,
                weight,
                change_after_jump: jumps
                    .then(|| unit.fraction * (S::of(excited.effective) - S::of(before))),
                compression_weight: unit.fraction,
            };
            recruited(fiber, recruitment);
        }
    }
}
