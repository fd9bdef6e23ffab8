//! Sag and predicted activation of a unit (a fibre type or a motor unit), common to all modes.

use crate::fiber::Fiber;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::share;

/// Advances S of a unit by one tick, in which it fires for the share `firing` (0..1). Returns the
/// mid-tick S.
#[inline(always)]
pub(crate) fn advance_sag<S: Scalar>(fiber: &Fiber<S>, sag: &mut S::Wide, firing: S) -> S {
    let before = S::of(*sag);
    *sag = fiber.sag.advance(*sag, firing);
    (before + S::of(*sag)).half()
}

/// Last and predicted Af of a unit. The fall time depends on Af before Af of the tick is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Activity<S> {
    /// Af at the last mid-tick, 0..1.
    last: S,
    /// Af at the next mid-tick, 0..1, by linear extrapolation.
    pub(crate) predicted: S,
}

impl<S: Scalar> Activity<S> {
    pub(super) const WORDS: usize = 2;
    pub(super) const NONE: Self = Self { last: S::ZERO, predicted: S::ZERO };

    /// Updates with the Af of a mid-tick.
    pub(super) fn next(&self, activation: S) -> Self {
        let (predicted, _) = share().clip(activation + (activation - self.last));
        Self { last: activation, predicted }
    }

    pub(super) fn words(self) -> impl Iterator<Item = S::Bits> {
        [self.last.to_bits(), self.predicted.to_bits()].into_iter()
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        saved: &mut Saved<I>,
    ) -> Result<Self, RestoreError> {
        let mut activation = || saved.number(|value| share().contains(value));
        Ok(Self { last: activation()?, predicted: activation()? })
    }
}
