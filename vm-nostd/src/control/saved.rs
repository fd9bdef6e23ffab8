//! Saved states that are made of several parts.

use crate::checksum::Checksum;
use crate::saved::RestoreError;
use crate::scalar::Scalar;
use crate::summed::Summed;

/// Fingerprint of what a state belongs to: a number for its kind, its arithmetic and coefficients.
pub(super) fn fingerprint<S: Scalar, T: Summed>(kind: u32, of: &T) -> u32 {
    let mut fingerprint = Checksum::EMPTY;
    [S::ARITHMETIC, kind].into_iter().for_each(|word| fingerprint.add(word));
    of.sum(&mut fingerprint);
    fingerprint.value()
}

/// The words of a state, taken part by part.
pub(super) struct Parts<I> {
    words: I,
    taken: usize,
    expected: usize,
}

impl<I: Iterator> Parts<I> {
    pub(super) fn new(words: I, expected: usize) -> Self {
        Self { words, taken: 0, expected }
    }

    /// Restores the next part from `length` words; errors count words from the state's start.
    pub(super) fn part<T>(
        &mut self,
        length: usize,
        restore: impl FnOnce(core::iter::Take<&mut I>) -> Result<T, RestoreError>,
    ) -> Result<T, RestoreError> {
        let (taken, expected) = (self.taken, self.expected);
        self.taken += length;
        restore(self.words.by_ref().take(length)).map_err(|error| match error {
            RestoreError::Length { .. } => RestoreError::Length { expected },
            RestoreError::Value { word } => RestoreError::Value { word: word + taken },
            other => other,
        })
    }

    /// Refuses words that are left.
    pub(super) fn finished(mut self) -> Result<(), RestoreError> {
        let expected = self.expected;
        if self.words.next().is_some() { Err(RestoreError::Length { expected }) } else { Ok(()) }
    }
}
