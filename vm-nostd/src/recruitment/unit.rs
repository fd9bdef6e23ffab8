//! What the modes share in a tick of a unit: a fibre type or a motor unit.

use crate::fiber::Fiber;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::share;

/// Advances S of a unit by one tick, of which it is `firing` for a share, and gives S at the tick's
/// middle.
#[inline(always)]
pub(crate) fn sagged<S: Scalar>(fiber: &Fiber<S>, sag: &mut S::LagState, firing: S) -> S {
    let before = S::of(*sag);
    *sag = fiber.sag.advance(*sag, firing);
    (before + S::of(*sag)).half()
}

/// Af of a unit from tick to tick: what its fall time has to be told before Af is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Activity<S> {
    /// Af at the middle of the last tick, 0..1.
    last: S,
    /// Af predicted for the middle of the next, 0..1: as far on as it came last.
    pub(crate) predicted: S,
}

impl<S: Scalar> Activity<S> {
    pub(super) const WORDS: usize = 2;
    pub(super) const NONE: Self = Self { last: S::ZERO, predicted: S::ZERO };

    /// What follows Af at the middle of a tick.
    pub(super) fn next(&self, activation: S) -> Self {
        let share = share();
        let (predicted, _) = share.clip(activation + (activation - self.last));
        Self { last: activation, predicted }
    }

    pub(super) fn words(self) -> impl Iterator<Item = S::Bits> {
        [self.last.to_bits(), self.predicted.to_bits()].into_iter()
    }

    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        saved: &mut Saved<I>,
    ) -> Result<Self, RestoreError> {
        let mut of_share = || saved.number(|value| share().contains(value));
        Ok(Self { last: of_share()?, predicted: of_share()? })
    }
}
