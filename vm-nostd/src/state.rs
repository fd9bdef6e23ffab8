//! Everything of a muscle that changes from tick to tick.

use crate::checksum::{Checksum, Summed};
use crate::equations::yielding::Speed;
use crate::recruitment::{NaturalContinuous, Recruitment, RecruitmentState};
use crate::scalar::Scalar;

/// The state of a muscle of `N` fibre types recruited as `R` says, plain data: copy it to save it.
///
/// [`words`](Self::words) gives its bits, for comparison. For storage
/// [`Muscle::save`](crate::Muscle::save) puts before them whose they are, and
/// [`Muscle::restore`](crate::Muscle::restore) takes them back after checking them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S: Scalar, R: Recruitment<S, N>, const N: usize> {
    /// (L_se - LrT) L_se0/L_ce0: how far the tendon is extended beyond slack, in L_ce0.
    pub(crate) tendon_extension: S,
    /// V, L_ce0/s.
    pub(crate) fascicle_velocity: S,
    /// L_mt at the end of the last tick.
    pub(crate) path_length: S::PathLength,
    /// What multiplied FV of each type at the middle of the last tick, 0..1.
    pub(crate) gains: [S; N],
    /// What multiplied F_pe2 there, 0..1.
    pub(crate) compressed: S,
    /// Speed during the last tick: what Y has still to be advanced by.
    pub(crate) speed: Speed<S>,
    /// Y of each type at the start of the last tick, 0..1.
    pub(crate) yieldings: [S::LagState; N],
    pub(crate) recruitment: R::State,
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> State<S, R, N> {
    /// How many words [`words`](Self::words) gives.
    pub const WORDS: usize = 6 + N * (1 + S::SLOW_WORDS) + R::State::WORDS;
    /// How many words the state is saved in: whose it is, and all of it.
    pub const SAVED_WORDS: usize = 1 + Self::WORDS;

    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fn fascicle_velocity(&self) -> S {
        self.fascicle_velocity
    }

    /// Checksum of all of its words.
    pub fn checksum(&self) -> u32 {
        let mut checksum = Checksum::EMPTY;
        self.words().for_each(|word| word.sum(&mut checksum));
        checksum.value()
    }

    /// The bits of the state, [`WORDS`](Self::WORDS) of them, always in the same order: tendon
    /// extension (L_ce0), fascicle velocity (L_ce0/s), path length; what multiplied F_pe2 in the
    /// middle of the last tick, mean and variance of the speed in it; what multiplied FV of each
    /// type in its middle; Y of each type where it started; U_eff, where each type is one unit; and
    /// of each unit f_int, f_eff, S, the Af foreseen for the next tick, and its effective length
    /// where it has one.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let of_muscle = [
            self.tendon_extension.to_bits(),
            self.fascicle_velocity.to_bits(),
            S::path_bits(self.path_length),
            self.compressed.to_bits(),
            self.speed.mean.to_bits(),
            self.speed.variance.to_bits(),
        ];
        of_muscle
            .into_iter()
            .chain(self.gains.into_iter().map(S::to_bits))
            .chain(self.yieldings.into_iter().flat_map(S::lag_state_words))
            .chain(self.recruitment.words())
    }
}

impl<S: Scalar, const N: usize> State<S, NaturalContinuous, N> {
    /// Effective activation U_eff, 0..1.
    pub fn effective_activation(&self) -> S {
        S::of(self.recruitment.shared)
    }
}
