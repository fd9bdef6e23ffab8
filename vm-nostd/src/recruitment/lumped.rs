//! State and tick of the modes with one lumped unit per fibre type.

use super::mode::{Moment, RecruitmentState};
use super::unit::{Activity, advance_sag};
use crate::equations::activation_frequency;
use crate::equations::excitation::{self, ExcitationInput};
use crate::equations::sag::{FIRING, share_above};
use crate::fiber::Fiber;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;
use core::array::from_fn;

/// Recruitment, and the excitation of each type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LumpedState<S: Scalar, const N: usize> {
    /// Common to all types: U_eff, 0..1 (natural continuous); f_env of the first type in the last
    /// tick, f0.5 (intramuscular FES).
    pub(crate) shared: S::Wide,
    pub(super) fibers: [FiberState<S>; N],
    /// Last and predicted Af of each type.
    pub(crate) activities: [Activity<S>; N],
}

/// State of one fibre type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberState<S: Scalar> {
    /// f_int, f0.5 (intramuscular FES: intermediate recruitment, 0..1).
    pub(super) intermediate_frequency: S::Wide,
    /// f_eff, f0.5 (intramuscular FES: recruitment, 0..1).
    pub(super) effective_frequency: S::Wide,
    /// S.
    pub(super) sag: S::Wide,
}

impl<S: Scalar, const N: usize> LumpedState<S, N> {
    pub(super) fn at_rest(fibers: &[Fiber<S>; N]) -> Self {
        Self {
            shared: S::ZERO.wide(),
            fibers: fibers.each_ref().map(|fiber| FiberState {
                intermediate_frequency: S::ZERO.wide(),
                effective_frequency: S::ZERO.wide(),
                sag: fiber.sag.resting_level.wide(),
            }),
            activities: [Activity::NONE; N],
        }
    }

    /// Restores the state from the next words. `shared` and `frequencies` (f_int and f_eff of each
    /// type) are the valid ranges.
    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
        shared: Range<S>,
        frequencies: [Range<S>; N],
    ) -> Result<Self, RestoreError> {
        let mut state = Self::at_rest(fibers);
        state.shared = saved.wide(&shared)?;
        let units = state.fibers.iter_mut().zip(&mut state.activities);
        for (((fiber_state, activity), fiber), range) in units.zip(fibers).zip(&frequencies) {
            *fiber_state = FiberState {
                intermediate_frequency: saved.wide(range)?,
                effective_frequency: saved.wide(range)?,
                sag: saved.wide(&fiber.sag.range())?,
            };
            *activity = Activity::restored(saved)?;
        }
        Ok(state)
    }
}

impl<S: Scalar, const N: usize> RecruitmentState<S> for LumpedState<S, N> {
    const WORDS: usize = S::WIDE_WORDS + N * (Activity::<S>::WORDS + 3 * S::WIDE_WORDS);

    fn words(&self) -> impl Iterator<Item = S::Bits> {
        let units = self.fibers.into_iter().zip(self.activities);
        S::wide_words(self.shared).chain(units.flat_map(|(fiber, activity)| {
            S::wide_words(fiber.intermediate_frequency)
                .chain(S::wide_words(fiber.effective_frequency))
                .chain(S::wide_words(fiber.sag))
                .chain(activity.words())
        }))
    }
}

/// One fibre type during a tick. Values are at mid-tick.
#[derive(Debug)]
pub(super) struct LumpedInput<'a, S: Scalar> {
    pub(super) fiber: &'a Fiber<S>,
    pub(super) state: &'a mut FiberState<S>,
    /// Target of f_int, f0.5.
    pub(super) drive: S,
    /// f_env, f0.5.
    pub(super) frequency: S,
    /// Factor of Tf4, 0..1.
    pub(super) slowing: S,
    /// Y.
    pub(super) yielding: S,
}

/// Result of a tick for one fibre type.
#[derive(Clone, Copy, Debug)]
pub(super) struct LumpedOutput<S> {
    /// Mid-tick f_eff.
    pub(super) effective: S,
    /// Change of f_eff during the tick.
    pub(super) change: S,
    /// Mid-tick Af.
    pub(super) activation: S,
}

/// Advances all types by one tick; `input` gives the input of a type from its index and state. If
/// [`Scalar::SIDE_BY_SIDE`], each operation is done for all types before the next one; otherwise
/// the types are advanced one after the other.
#[inline(always)]
pub(super) fn advance_all<'a, S: Scalar, const STIMULATED: bool, const N: usize>(
    states: &'a mut [FiberState<S>; N],
    input: impl Fn(usize, &'a mut FiberState<S>) -> LumpedInput<'a, S>,
    moment: &Moment<S, N>,
) -> [LumpedOutput<S>; N] {
    if S::SIDE_BY_SIDE {
        let mut index = 0..N;
        let types = states.each_mut().map(|state| input(index.next().unwrap_or(0), state));
        return advance::<S, STIMULATED, N, N>(types, moment);
    }
    let mut all = [LumpedOutput { effective: S::ZERO, change: S::ZERO, activation: S::ZERO }; N];
    for (index, (one, state)) in all.iter_mut().zip(states).enumerate() {
        [*one] = advance::<S, STIMULATED, N, 1>([input(index, state)], moment);
    }
    all
}

/// Advances some types by one tick, side by side. Af and sag depend on f_env if `STIMULATED`,
/// otherwise on f_eff.
#[inline(always)]
fn advance<S: Scalar, const STIMULATED: bool, const N: usize, const SOME: usize>(
    types: [LumpedInput<'_, S>; SOME],
    moment: &Moment<S, N>,
) -> [LumpedOutput<S>; SOME] {
    let inputs = types.each_ref().map(|t| ExcitationInput {
        excitation: &t.fiber.excitation,
        intermediate: t.state.intermediate_frequency,
        effective: t.state.effective_frequency,
        drive: t.drive,
        frequency: t.frequency,
        slowing: t.slowing,
    });
    let excited = excitation::advance(inputs, moment.fascicle_length, moment.reciprocal);
    let relations = types.each_ref().map(|t| &t.fiber.activation);
    let mut changes = [S::ZERO; SOME];
    let mut frequencies = [S::ZERO; SOME];
    for (i, t) in types.into_iter().enumerate() {
        let (before, after) = (S::of(t.state.effective_frequency), S::of(excited[i].effective));
        changes[i] = after - before;
        t.state.intermediate_frequency = excited[i].intermediate;
        t.state.effective_frequency = excited[i].effective;
        let fired = if !STIMULATED {
            share_above(before, after, S::constant(&FIRING))
        } else if t.frequency > S::constant(&FIRING) {
            S::ONE
        } else {
            S::ZERO
        };
        let sag = advance_sag(t.fiber, &mut t.state.sag, fired);
        let acting = if STIMULATED { t.frequency } else { excited[i].effective_at_middle };
        frequencies[i] = acting * (t.yielding * sag);
    }
    let curves = activation_frequency::curves(relations, moment.reciprocal);
    from_fn(|i| LumpedOutput {
        effective: excited[i].effective_at_middle,
        change: changes[i],
        activation: curves[i].at(frequencies[i]),
    })
}
