//! Everything of a muscle that changes from tick to tick.

use crate::checksum::{Checksum, Summed};
use crate::domain::Range;
use crate::recruitment::{NaturalContinuous, Recruitment, RecruitmentState};
use crate::scalar::Scalar;
use crate::yielding::Speed;
use core::fmt;

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

/// A saved state was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RestoreError {
    /// There were not as many words as a saved state has.
    Length {
        /// How many it has.
        expected: usize,
    },
    /// They were saved by another muscle, or for another mode, time step or arithmetic; or one
    /// whose coefficients have lost a bit since.
    OtherMuscle {
        /// The fingerprint they begin with.
        saved: u64,
        /// That of the muscle they were given to.
        expected: u32,
    },
    /// A word does not hold a value that the muscle can be in.
    Value {
        /// Which word, counted from 0.
        word: usize,
    },
}

impl fmt::Display for RestoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { expected } => write!(f, "a saved state has {expected} words"),
            Self::OtherMuscle { saved, expected } => write!(
                f,
                "the state was saved by another muscle or for another time step: fingerprint \
                 {saved:08x}, not {expected:08x}"
            ),
            Self::Value { word } => {
                write!(f, "word {word} of the saved state is outside the muscle's range")
            }
        }
    }
}

impl core::error::Error for RestoreError {}

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

/// What a value of a saved state may be outside of its range by.
pub(crate) const ROUNDING: f64 = 1e-5;

/// Words that are being read.
#[doc(hidden)]
#[derive(Debug)]
pub struct Saved<I> {
    words: I,
    /// How many were read.
    count: usize,
    expected: usize,
}

impl<I: Iterator> Saved<I> {
    /// Words of which there should be so many, the first of them a `fingerprint`.
    pub(crate) fn new(words: I, expected: usize, fingerprint: u32) -> Result<Self, RestoreError>
    where
        I: Iterator<Item: Eq + From<u32> + Into<u64> + Copy>,
    {
        let mut saved = Self { words, count: 1, expected };
        let first = saved.words.next().ok_or_else(|| saved.length())?;
        if first != I::Item::from(fingerprint) {
            let expected = fingerprint;
            return Err(RestoreError::OtherMuscle { saved: first.into(), expected });
        }
        Ok(saved)
    }

    /// Refuses words that are left.
    pub(crate) fn finished(&mut self) -> Result<(), RestoreError> {
        if self.words.next().is_some() { Err(self.length()) } else { Ok(()) }
    }

    fn length(&self) -> RestoreError {
        RestoreError::Length { expected: self.expected }
    }

    /// A value of so many words, refused if it is not one the muscle can have.
    fn checked<T>(
        &mut self,
        value: Option<T>,
        words: usize,
        valid: impl FnOnce(&T) -> bool,
    ) -> Result<T, RestoreError> {
        let value = value.ok_or_else(|| self.length())?;
        if !valid(&value) {
            return Err(RestoreError::Value { word: self.count });
        }
        self.count += words;
        Ok(value)
    }

    pub(crate) fn number<S: Scalar>(&mut self, valid: impl Fn(S) -> bool) -> Result<S, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = self.words.next().map(S::from_bits);
        self.checked(value, 1, |value| valid(*value))
    }

    pub(crate) fn path<S: Scalar>(
        &mut self,
        range: &Range<S::PathLength>,
    ) -> Result<S::PathLength, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = self.words.next().map(S::path_from_bits);
        self.checked(value, 1, |value| range.contains(*value))
    }

    pub(crate) fn lag_state<S: Scalar>(
        &mut self,
        range: &Range<S>,
    ) -> Result<S::LagState, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = S::lag_state_from_words(&mut self.words);
        self.checked(value, S::SLOW_WORDS, |value| {
            range.about_contains(S::of(*value), S::from_f64(ROUNDING))
        })
    }
}
