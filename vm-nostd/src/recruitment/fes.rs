//! Intramuscular FES: all fibre types are recruited in proportion to their cross section and fire
//! at the stimulation frequency.
//!
//! f_env_i = f_stim/f0.5_i at any U, and Af_i depends on f_env_i directly. The input of the two
//! lags of excitation is U; their output is the recruitment. Rising Tf = Tf1 L² + Tf2 f_env_i,
//! falling Tf = (Tf3 + Tf4)/L if U > 0, else Tf3/L. Sag has its firing level if f_env_i > 0.1.

use super::lumped::{self, LumpedInput, LumpedOutput, LumpedState};
use super::mode::{Moment, Recruited, Recruitment, RecruitmentTick};
use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::params::limits::MAXIMUM_STIMULATION_FREQUENCY;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::summed::summed;
use crate::tick::range::{Range, share};
use crate::tick::time_step::TimeStep;
use core::array::from_fn;

/// Intramuscular FES: the activation is the stimulus intensity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntramuscularFes;

impl Sealed for IntramuscularFes {}

impl<S: Scalar, const N: usize> Recruitment<S, N> for IntramuscularFes {
    const MODE: u32 = 2;

    type Units = ();
    type State = LumpedState<S, N>;
    type Coefficients = Coefficients<S, N>;
}

summed! {
    #[derive(Clone, Copy, Debug)]
    pub struct Coefficients<S: Scalar, const N: usize> {
        units: [Unit<S>; N],
    }
}

summed! {
    #[derive(Clone, Copy, Debug)]
    struct Unit<S: Scalar> {
        fraction: S,
        /// 1/f0.5, s.
        per_half_force_frequency: S::Factor,
    }
}

impl<S: Scalar, const N: usize> Coefficients<S, N> {
    /// Recruited cross section of each type, as a share of the muscle.
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
        // The states of the two lags are shares of recruitment.
        LumpedState::restored(fibers, saved, first_frequency, [share(); N])
    }

    #[inline(always)]
    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
    ) -> [Recruited<S>; N] {
        let input = &moment.input;
        let slowing = if input.activation > S::ZERO { S::ONE } else { S::ZERO };
        // Af depends on the frequency without a lag and jumps with it.
        let first = self.first_frequency(input.stimulation_frequency);
        let jumps = first != S::of(state.shared);
        state.shared = first.wide();
        let frequencies = self.units.each_ref().map(|unit| {
            S::of_quantity(input.stimulation_frequency, &unit.per_half_force_frequency)
        });
        let input_of_type = |i: usize, fiber_state| LumpedInput {
            fiber: &fibers[i],
            state: fiber_state,
            drive: input.activation,
            frequency: frequencies[i],
            slowing,
            yielding: moment.yieldings[i],
        };
        let advanced = lumped::advance_all::<S, true, N>(&mut state.fibers, input_of_type, moment);
        from_fn(|i| {
            let LumpedOutput { effective, change, activation } = advanced[i];
            let fraction = self.units[i].fraction;
            Recruited {
                activation,
                weight: fraction * effective,
                change_after_jump: jumps.then(|| fraction * change),
                compression_weight: fraction,
            }
        })
    }
}
