//! A saved state, read word by word and checked.

use crate::scalar::Scalar;
use crate::tick::range::Range;
use core::fmt;

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
