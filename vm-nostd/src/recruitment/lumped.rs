//! State and tick of the modes that take each fibre type as one unit.

use super::mode::{Moment, RecruitmentState};
use super::unit::{Activity, sagged};
use crate::equations::activation_frequency;
use crate::equations::excitation::{self, Driven};
use crate::equations::sag::share_above;
use crate::fiber::Fiber;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;
use core::array::from_fn;

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

/// A fibre type in a tick.
#[derive(Debug)]
pub(super) struct Lumped<'a, S: Scalar> {
    pub(super) fiber: &'a Fiber<S>,
    pub(super) kept: &'a mut FiberState<S>,
    /// What f_int tends to; f_env; the factor of Tf4; and Y, at the tick's middle.
    pub(super) drive: S,
    pub(super) frequency: S,
    pub(super) slowing: S,
    pub(super) yielding: S,
}

/// What a tick makes of a fibre type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Advanced<S> {
    /// f_eff at the tick's middle, and how it changes in the tick.
    pub(super) effective: S,
    pub(super) change: S,
    /// Af at the middle.
    pub(super) activation: S,
}

/// One tick of all types, as `described` by index and state: side by side where registers last for
/// that, or one after the other.
#[inline(always)]
pub(super) fn advance_all<'a, S: Scalar, const STIMULATED: bool, const N: usize>(
    states: &'a mut [FiberState<S>; N],
    described: impl Fn(usize, &'a mut FiberState<S>) -> Lumped<'a, S>,
    moment: &Moment<S, N>,
    firing: S,
) -> [Advanced<S>; N] {
    if S::SIDE_BY_SIDE {
        let mut index = 0..N;
        let types = states.each_mut().map(|kept| described(index.next().unwrap_or(0), kept));
        return advance::<S, STIMULATED, N, N>(types, moment, firing);
    }
    let mut all = [Advanced { effective: S::ZERO, change: S::ZERO, activation: S::ZERO }; N];
    for (index, (one, kept)) in all.iter_mut().zip(states).enumerate() {
        [*one] = advance::<S, STIMULATED, N, 1>([described(index, kept)], moment, firing);
    }
    all
}

/// One tick of some types, side by side; they fire from a frequency `firing` on. `STIMULATED`,
/// f_env sets Af and sag, else f_eff.
#[inline(always)]
fn advance<S: Scalar, const STIMULATED: bool, const N: usize, const SOME: usize>(
    types: [Lumped<'_, S>; SOME],
    moment: &Moment<S, N>,
    firing: S,
) -> [Advanced<S>; SOME] {
    let driven = types.each_ref().map(|t| Driven {
        excitation: &t.fiber.excitation,
        intermediate: t.kept.intermediate_frequency,
        effective: t.kept.effective_frequency,
        drive: t.drive,
        frequency: t.frequency,
        slowing: t.slowing,
    });
    let excited = excitation::advance(driven, moment.fascicle_length, moment.reciprocal);
    let relations = types.each_ref().map(|t| &t.fiber.activation);
    let mut changes = [S::ZERO; SOME];
    let mut frequencies = [S::ZERO; SOME];
    for (i, t) in types.into_iter().enumerate() {
        let (before, after) = (S::of(t.kept.effective_frequency), S::of(excited[i].effective));
        changes[i] = after - before;
        t.kept.intermediate_frequency = excited[i].intermediate;
        t.kept.effective_frequency = excited[i].effective;
        let fired = if !STIMULATED {
            share_above(before, after, firing)
        } else if t.frequency > firing {
            S::ONE
        } else {
            S::ZERO
        };
        let sag = sagged(t.fiber, &mut t.kept.sag, fired);
        let acting = if STIMULATED { t.frequency } else { excited[i].effective_at_middle };
        frequencies[i] = acting * (t.yielding * sag);
    }
    let curves = activation_frequency::curves(relations, moment.reciprocal);
    from_fn(|i| Advanced {
        effective: excited[i].effective_at_middle,
        change: changes[i],
        activation: curves[i].at(frequencies[i]),
    })
}
