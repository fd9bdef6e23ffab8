//! State of the FES controller.

use super::feed_forward::InverseState;
use super::lead::LeadState;
use super::pi::{PiState, Saturated};
use crate::checksum::Checksum;
use crate::scalar::Scalar;
use crate::summed::Summed;

/// Everything of a controller that changes from tick to tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FesControllerState<S: Scalar> {
    /// Last target and measured angle, rad; measured torque, in its unit.
    pub(super) target: S,
    pub(super) angle: S,
    pub(super) measured: S,
    /// What the feedback expects to be measured.
    pub(super) expected: S::Wide,
    pub(super) feedback: PiState<S>,
    pub(super) gain: S::Wide,
    pub(super) saturated: Saturated,
    pub(super) inverses: [InverseState<S>; 2],
}

impl<S: Scalar> FesControllerState<S> {
    pub(super) const OWN: usize =
        1 + 4 + 2 * S::WIDE_WORDS + PiState::<S>::WORDS + 2 * LeadState::<S>::WORDS;
    /// Words of a saved state without fatigue;
    /// [`FesController::saved_words`](super::FesController::saved_words) has those of a controller.
    pub const LEAST_SAVED_WORDS: usize = Self::OWN;

    /// Estimated gain.
    pub fn gain(&self) -> S {
        S::of(self.gain)
    }

    /// Its bits, for comparison; [`FesController::save`](super::FesController::save) adds the
    /// fingerprints.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let Self { target, angle, measured, expected, feedback, gain, saturated, inverses } = self;
        let own = [*target, *angle, *measured].map(S::to_bits);
        own.into_iter()
            .chain(core::iter::once(S::Bits::from(saturated.bits())))
            .chain([*expected, *gain].into_iter().flat_map(S::wide_words))
            .chain(feedback.words())
            .chain(inverses.iter().flat_map(InverseState::words))
    }

    /// Checksum of all words, see [`FesController::checksum`](super::FesController::checksum).
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.words().for_each(|word| word.sum(&mut checksum));
        checksum.value()
    }
}
