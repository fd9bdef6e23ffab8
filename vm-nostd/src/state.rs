//! State of a muscle.

use crate::checksum::Checksum;
use crate::equations::yielding::Speed;
use crate::recruitment::{NaturalContinuous, Recruitment, RecruitmentState};
use crate::scalar::Scalar;
use crate::summed::Summed;

/// State of a muscle of `N` fibre types with recruitment `R`: plain data that can be copied.
///
/// [`words`](Self::words) returns the bits, for comparison. For storage
/// [`Muscle::save`](crate::Muscle::save) adds a fingerprint of the muscle, and
/// [`Muscle::restore`](crate::Muscle::restore) validates fingerprint and values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S: Scalar, R: Recruitment<S, N>, const N: usize> {
    /// Tendon extension beyond slack, (L_se - LrT) L_se0/L_ce0, in L_ce0.
    pub(crate) tendon_extension: S::Wide,
    /// V, L_ce0/s.
    pub(crate) fascicle_velocity: S,
    /// L_mt at the last tick boundary.
    pub(crate) path_length: S::PathLength,
    /// Factor of FV of each type at the last mid-tick, 0..1.
    pub(crate) gains: [S; N],
    /// Factor of F_pe2 at the last mid-tick, 0..1.
    pub(crate) compressed: S,
    /// Speed during the last tick, with which Y is advanced in the next one.
    pub(crate) speed: Speed<S>,
    /// Y of each type at the start of the last tick, 0..1.
    pub(crate) yieldings: [S::Wide; N],
    pub(crate) recruitment: R::State,
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> State<S, R, N> {
    /// Number of [`words`](Self::words).
    pub const WORDS: usize = 5 + N + (1 + N) * S::WIDE_WORDS + R::State::WORDS;
    /// Number of saved words: fingerprint and state.
    pub const SAVED_WORDS: usize = 1 + Self::WORDS;

    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fn fascicle_velocity(&self) -> S {
        self.fascicle_velocity
    }

    /// Checksum of all words.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.words().for_each(|word| word.sum(&mut checksum));
        checksum.value()
    }

    /// The [`WORDS`](Self::WORDS) words of the state in fixed order: tendon extension (L_ce0),
    /// fascicle velocity (L_ce0/s), path length; factor of F_pe2 at the last mid-tick, mean and
    /// variance of the speed in the last tick; factor of FV of each type at the last mid-tick; Y of
    /// each type at the start of the last tick; U_eff in modes with one unit per type; and for each
    /// unit f_int, f_eff, S, the Af predicted for the next tick, and its effective length in the
    /// mode that has one.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let mechanics = [
            self.fascicle_velocity.to_bits(),
            S::path_bits(self.path_length),
            self.compressed.to_bits(),
            self.speed.mean.to_bits(),
            self.speed.variance.to_bits(),
        ];
        S::wide_words(self.tendon_extension)
            .chain(mechanics)
            .chain(self.gains.into_iter().map(S::to_bits))
            .chain(self.yieldings.into_iter().flat_map(S::wide_words))
            .chain(self.recruitment.words())
    }
}

impl<S: Scalar, const N: usize> State<S, NaturalContinuous, N> {
    /// Effective activation U_eff, 0..1.
    pub fn effective_activation(&self) -> S {
        S::of(self.recruitment.shared)
    }
}
