//! State of the modes that take each fibre type as one unit.

use super::RecruitmentState;
use crate::domain::Range;
use crate::muscle::Fiber;
use crate::scalar::Scalar;
use crate::state::{RestoreError, Saved};

/// Recruitment, and excitation of each type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumpedState<S: Scalar, const N: usize> {
    /// U_eff, 0..1; stays 0 in intramuscular FES.
    pub(crate) effective_activation: S::Slow,
    pub(super) fibers: [FiberState<S>; N],
    /// Af of each type that the last tick foresaw for the middle of the next, 0..1. Not with the
    /// rest of a type's state, where in fixed point it would cost padding.
    pub(super) activations: [S; N],
}

/// What each fibre type has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberState<S: Scalar> {
    /// f_int, f0.5 (intramuscular FES: intermediate recruitment, 0..1).
    pub(super) intermediate_frequency: S::Slow,
    /// f_eff, f0.5 (intramuscular FES: recruitment, 0..1).
    pub(super) effective_frequency: S::Slow,
    /// S.
    pub(super) sag: S::Slow,
}

impl<S: Scalar, const N: usize> LumpedState<S, N> {
    pub(super) fn at_rest(fibers: &[Fiber<S>; N]) -> Self {
        Self {
            effective_activation: S::ZERO.slow(),
            fibers: fibers.each_ref().map(|fiber| FiberState {
                intermediate_frequency: S::ZERO.slow(),
                effective_frequency: S::ZERO.slow(),
                sag: fiber.sag.resting_level.slow(),
            }),
            activations: [S::ZERO; N],
        }
    }

    /// The state whose words come next, with U_eff and f_int and f_eff of each type in their ranges.
    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
        effective_activation: Range<S>,
        frequencies: [Range<S>; N],
    ) -> Result<Self, RestoreError> {
        let mut state = Self::at_rest(fibers);
        state.effective_activation = saved.slow(&effective_activation)?;
        let units = state.fibers.iter_mut().zip(&mut state.activations);
        for (((kept, activation), fiber), range) in units.zip(fibers).zip(&frequencies) {
            *kept = FiberState {
                intermediate_frequency: saved.slow(range)?,
                effective_frequency: saved.slow(range)?,
                sag: saved.slow(&fiber.sag.range())?,
            };
            *activation = saved.number(|value| super::share().contains(value))?;
        }
        Ok(state)
    }
}

impl<S: Scalar, const N: usize> RecruitmentState<S> for LumpedState<S, N> {
    const WORDS: usize = S::SLOW_WORDS + N * (1 + 3 * S::SLOW_WORDS);

    fn words(&self) -> impl Iterator<Item = S::Bits> {
        let units = self.fibers.into_iter().zip(self.activations);
        S::slow_words(self.effective_activation).chain(units.flat_map(|(fiber, activation)| {
            S::slow_words(fiber.intermediate_frequency)
                .chain(S::slow_words(fiber.effective_frequency))
                .chain(S::slow_words(fiber.sag))
                .chain([activation.to_bits()])
        }))
    }
}
