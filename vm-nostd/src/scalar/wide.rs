//! States of lags, which have more resolution than the number itself.

use super::Representation;
use crate::summed::FromWords;
use core::fmt::Debug;

/// Lags and their states.
pub(crate) trait WideState: Representation {
    /// Share, 0..1, of the distance of a lag to its target.
    type Share: Copy + Debug + FromWords + Send + Sync;

    /// Words of the state of a lag in a saved state.
    const LAG_STATE_WORDS: usize = size_of::<Self::LagState>() / size_of::<Self::Bits>();

    /// State of a lag after adding `difference` times `share`.
    fn advanced(state: Self::LagState, difference: Self, share: Self::Share) -> Self::LagState;
    /// State of a lag after adding two differences times their shares.
    fn advanced_by_two(
        state: Self::LagState,
        first: (Self, Self::Share),
        second: (Self, Self::Share),
    ) -> Self::LagState;
    /// The share nearest to a constant, 0..1. Used when a muscle is built.
    fn share(value: f64) -> Self::Share;
    /// Step response of a lag after `self` time constants: 1 - exp(-`self`).
    fn lag_response(self) -> Self::Share;
    /// Step response of two lags in series after half of x and after x = `self` time constants, at
    /// most 2.5.
    fn lags(self) -> [Lags<Self::Share>; 2];
    /// Words of the state of a lag.
    fn lag_state_words(state: Self::LagState) -> impl Iterator<Item = Self::Bits>;
    /// State of a lag from the next words; `None` if there are too few.
    fn lag_state_from_words(words: &mut impl Iterator<Item = Self::Bits>)
    -> Option<Self::LagState>;
}

/// Step response of two lags in series after x time constants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lags<T> {
    /// Response of the first lag, 1 - exp(-x).
    pub(crate) response: T,
    /// Response of the first lag minus that of the second, x exp(-x).
    pub(crate) delayed: T,
}
