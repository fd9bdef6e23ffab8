//! Reads and validates a saved state word by word.

use crate::scalar::Scalar;
use crate::tick::range::Range;
use core::fmt;

/// A saved state was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RestoreError {
    /// The number of words is wrong.
    Length {
        /// Expected number of words.
        expected: usize,
    },
    /// The state was saved by another muscle or for another mode, time step or arithmetic; or a bit
    /// of the muscle's coefficients has flipped since.
    OtherMuscle {
        /// Fingerprint of the saved state.
        saved: u64,
        /// Fingerprint of this muscle.
        expected: u32,
    },
    /// A value is out of range.
    Value {
        /// Index of its first word, from 0.
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

/// Rounding tolerance when range-checking a restored value.
pub(crate) const ROUNDING: f64 = 1e-5;

/// Reader of the words of a saved state.
#[doc(hidden)]
#[derive(Debug)]
pub struct Saved<I> {
    words: I,
    /// Number of words read.
    count: usize,
    expected: usize,
}

impl<I: Iterator> Saved<I> {
    /// A reader of `expected` words; checks the first one, the fingerprint.
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

    /// Refuses excess words.
    pub(crate) fn finished(&mut self) -> Result<(), RestoreError> {
        if self.words.next().is_some() { Err(self.length()) } else { Ok(()) }
    }

    fn length(&self) -> RestoreError {
        RestoreError::Length { expected: self.expected }
    }

    /// Refuses a missing value of `words` words, and one that is not valid.
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

    /// A count below `most`.
    pub(crate) fn count(&mut self, most: usize) -> Result<usize, RestoreError>
    where
        I: Iterator<Item: Into<u64>>,
    {
        let value = self.words.next().map(|word| word.into() as usize);
        self.checked(value, 1, |&value| value < most)
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

    pub(crate) fn wide<S: Scalar>(&mut self, range: &Range<S>) -> Result<S::Wide, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        self.wide_if(|value: S| range.contains_within(value, S::from_f64(ROUNDING)))
    }

    pub(crate) fn wide_if<S: Scalar>(
        &mut self,
        is_valid: impl FnOnce(S) -> bool,
    ) -> Result<S::Wide, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = S::wide_from_words(&mut self.words);
        self.checked(value, S::WIDE_WORDS, |value| is_valid(S::of(*value)))
    }
}
