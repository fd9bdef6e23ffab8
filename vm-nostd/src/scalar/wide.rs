//! States that add up small changes: they have more resolution than the number itself.

use super::{Factors, Representation};
use crate::summed::FromWords;
use core::fmt::Debug;

/// Lags, extensions and their states.
pub(crate) trait WideState: Representation + Factors {
    /// Share, 0..1, of the distance of a lag to its target.
    type Share: Copy + Debug + FromWords + Send + Sync;

    /// Words of a state that is saved.
    const WIDE_WORDS: usize = size_of::<Self::Wide>() / size_of::<Self::Bits>();

    /// State of a lag after adding `difference` times `share`.
    fn advanced(state: Self::Wide, difference: Self, share: Self::Share) -> Self::Wide;
    /// State of a lag after adding two differences times their shares.
    fn advanced_by_two(
        state: Self::Wide,
        first: (Self, Self::Share),
        second: (Self, Self::Share),
    ) -> Self::Wide;
    /// Extension after adding `stretch`, and taking away `travel` for a `tick`; saturates.
    fn stretched(
        extension: Self::Wide,
        stretch: Self,
        travel: Self,
        tick: Self::Part,
    ) -> Self::Wide;
    /// The share nearest to a constant, 0..1. Used when a muscle is built.
    fn share(value: f64) -> Self::Share;
    /// Step response of a lag after `self` time constants: 1 - exp(-`self`).
    fn lag_response(self) -> Self::Share;
    /// A number of time constants, below 4, as an argument of [`lags`](Self::lags): in fixed point
    /// it is larger, for the number itself would have few bits for slow lags.
    #[must_use]
    fn span(self) -> Self;
    /// Step response of two lags in series after half of x and after x time constants, at most 2.5,
    /// for the span of x.
    fn lags(self) -> [Lags<Self::Share>; 2];
    /// Words of a state.
    fn wide_words(state: Self::Wide) -> impl Iterator<Item = Self::Bits>;
    /// State from the next words; `None` if there are too few.
    fn wide_from_words(words: &mut impl Iterator<Item = Self::Bits>) -> Option<Self::Wide>;
}

/// Step response of two lags in series after x time constants.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lags<T> {
    /// Response of the first lag, 1 - exp(-x).
    pub(crate) response: T,
    /// Response of the first lag minus that of the second, x exp(-x).
    pub(crate) delayed: T,
}
