//! State of the modes that take each fibre type as one unit.

use super::mode::RecruitmentState;
use super::unit::Activity;
use crate::fiber::Fiber;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;

/// Recruitment, and excitation of each type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumpedState<S: Scalar, const N: usize> {
    /// What the types share: U_eff, 0..1 (natural continuous); f_env of the first in the last tick,
    /// f0.5 (intramuscular FES).
    pub(crate) shared: S::LagState,
    pub(super) fibers: [FiberState<S>; N],
    /// Af of each type.
    pub(crate) activities: [Activity<S>; N],
}

/// What each fibre type has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberState<S: Scalar> {
    /// f_int, f0.5 (intramuscular FES: intermediate recruitment, 0..1).
    pub(super) intermediate_frequency: S::LagState,
    /// f_eff, f0.5 (intramuscular FES: recruitment, 0..1).
    pub(super) effective_frequency: S::LagState,
    /// S.
    pub(super) sag: S::LagState,
}

impl<S: Scalar, const N: usize> LumpedState<S, N> {
    pub(super) fn at_rest(fibers: &[Fiber<S>; N]) -> Self {
        Self {
            shared: S::ZERO.lag_state(),
            fibers: fibers.each_ref().map(|fiber| FiberState {
                intermediate_frequency: S::ZERO.lag_state(),
                effective_frequency: S::ZERO.lag_state(),
                sag: fiber.sag.resting_level.lag_state(),
            }),
            activities: [Activity::NONE; N],
        }
    }

    /// The state whose words come next, with what the types share and f_int and f_eff of each in
    /// their ranges.
    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
        shared: Range<S>,
        frequencies: [Range<S>; N],
    ) -> Result<Self, RestoreError> {
        let mut state = Self::at_rest(fibers);
        state.shared = saved.lag_state(&shared)?;
        let units = state.fibers.iter_mut().zip(&mut state.activities);
        for (((kept, activity), fiber), range) in units.zip(fibers).zip(&frequencies) {
            *kept = FiberState {
                intermediate_frequency: saved.lag_state(range)?,
                effective_frequency: saved.lag_state(range)?,
                sag: saved.lag_state(&fiber.sag.range())?,
            };
            *activity = Activity::restored(saved)?;
        }
        Ok(state)
    }
}

impl<S: Scalar, const N: usize> RecruitmentState<S> for LumpedState<S, N> {
    const WORDS: usize = S::SLOW_WORDS + N * (Activity::<S>::WORDS + 3 * S::SLOW_WORDS);

    fn words(&self) -> impl Iterator<Item = S::Bits> {
        let units = self.fibers.into_iter().zip(self.activities);
        S::lag_state_words(self.shared).chain(units.flat_map(|(fiber, activity)| {
            S::lag_state_words(fiber.intermediate_frequency)
                .chain(S::lag_state_words(fiber.effective_frequency))
                .chain(S::lag_state_words(fiber.sag))
                .chain(activity.words())
        }))
    }
}
