//! Everything of a muscle that changes from tick to tick.

use crate::domain::{Domain, Range};
use crate::scalar::Scalar;
use crate::tendon::Tendon;
use core::fmt;
use core::marker::PhantomData;

/// The state of a muscle of `N` fibre types recruited as `R` says, plain data: copy it to save it.
///
/// [`words`](Self::words) gives its bits, for storage and comparison, and
/// [`Muscle::restore`](crate::Muscle::restore) takes them back after checking them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S: Scalar, R, const N: usize> {
    /// (L_se - LrT) L_se0/L_ce0: how far the tendon is extended beyond slack, in L_ce0.
    pub(crate) tendon_extension: S,
    /// V, L_ce0/s.
    pub(crate) fascicle_velocity: S,
    /// L_mt at the end of the last tick.
    pub(crate) path_length: S::PathLength,
    /// U_eff, 0..1; stays 0 in intramuscular FES.
    pub(crate) effective_activation: S::Slow,
    pub(crate) fibers: [FiberState<S>; N],
    /// Af of each type that the last tick foresaw for the middle of the next, 0..1. Not with the
    /// rest of a type's state, where in fixed point it would cost padding.
    pub(crate) activations: [S; N],
    pub(crate) recruitment: PhantomData<R>,
}

/// The part of the state that each fibre type has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberState<S: Scalar> {
    /// f_int, f0.5 (intramuscular FES: intermediate recruitment, 0..1).
    pub(crate) intermediate_frequency: S::Slow,
    /// f_eff, f0.5 (intramuscular FES: recruitment, 0..1).
    pub(crate) effective_frequency: S::Slow,
    /// Y, 0..1.
    pub(crate) yielding: S::Slow,
    /// S.
    pub(crate) sag: S::Slow,
}

impl<S: Scalar> FiberState<S> {
    pub(crate) fn at_rest(sag: S) -> Self {
        Self {
            intermediate_frequency: S::ZERO.slow(),
            effective_frequency: S::ZERO.slow(),
            yielding: S::ONE.slow(),
            sag: sag.slow(),
        }
    }
}

/// A saved state was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RestoreError {
    /// There were not as many words as the state has.
    Length {
        /// How many it has.
        expected: usize,
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
            Self::Value { word } => {
                write!(f, "word {word} of the saved state is outside the muscle's range")
            }
        }
    }
}

impl core::error::Error for RestoreError {}

impl<S: Scalar, R, const N: usize> State<S, R, N> {
    /// How many words the state is saved in.
    pub const WORDS: usize = 3 + S::SLOW_WORDS + N * (1 + 4 * S::SLOW_WORDS);

    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fn fascicle_velocity(&self) -> S {
        self.fascicle_velocity
    }

    /// Effective activation U_eff, 0..1, of natural continuous recruitment.
    pub fn effective_activation(&self) -> S {
        S::of(self.effective_activation)
    }

    /// The bits of the state, [`WORDS`](Self::WORDS) of them, always in the same order: tendon
    /// extension (L_ce0), fascicle velocity (L_ce0/s), path length, effective activation; then of
    /// each type f_int, f_eff, Y, S, and the Af foreseen for the next tick.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let of_muscle = [
            self.tendon_extension.to_bits(),
            self.fascicle_velocity.to_bits(),
            S::path_bits(self.path_length),
        ];
        of_muscle.into_iter().chain(S::slow_words(self.effective_activation)).chain(
            self.fibers
                .into_iter()
                .zip(self.activations)
                .flat_map(|(fiber, activation)| fiber.words().chain([activation.to_bits()])),
        )
    }

    /// The state whose bits are `words`, if every value is one that a tick can leave behind.
    pub(crate) fn from_words(
        words: impl IntoIterator<Item = S::Bits>,
        domain: &Domain<S>,
        tendon: &Tendon<S>,
        ranges: &Ranges<S, N>,
    ) -> Result<Self, RestoreError> {
        let mut saved = Saved { words: words.into_iter(), count: 0, expected: Self::WORDS };
        let share = Range { least: S::ZERO, most: S::ONE };
        let mut state = Self {
            tendon_extension: saved.number(S::is_finite)?,
            fascicle_velocity: saved.number(|value| domain.fascicle_velocity.contains(value))?,
            path_length: saved.path::<S>(&domain.path_length)?,
            effective_activation: saved.slow(&ranges.effective_activation)?,
            fibers: [FiberState::at_rest(S::ONE); N],
            activations: [S::ZERO; N],
            recruitment: PhantomData,
        };
        let length = tendon.fascicle_length(state.path_length, state.tendon_extension);
        let (nearest, _) = domain.fascicle_length.clip(length);
        // A length that was stopped at a limit comes back with the rounding of its extension.
        if (length - nearest).abs() > S::from_f64(1e-4) {
            return Err(RestoreError::Value { word: 0 });
        }
        let fibers = state.fibers.iter_mut().zip(&mut state.activations);
        for ((fiber, activation), range) in fibers.zip(&ranges.fibers) {
            *fiber = FiberState {
                intermediate_frequency: saved.slow(&range.frequency)?,
                effective_frequency: saved.slow(&range.frequency)?,
                yielding: saved.slow(&range.yielding)?,
                sag: saved.slow(&range.sag)?,
            };
            *activation = saved.number(|value| share.contains(value))?;
        }
        if saved.words.next().is_some() {
            return Err(saved.length());
        }
        Ok(state)
    }
}

/// What a value of a saved state may be outside of its range by.
const ROUNDING: f64 = 1e-5;

/// Where the values of a muscle's state always are.
pub(crate) struct Ranges<S, const N: usize> {
    pub(crate) effective_activation: Range<S>,
    pub(crate) fibers: [FiberRanges<S>; N],
}

/// Where the values of a fibre type's state always are.
#[derive(Clone, Copy)]
pub(crate) struct FiberRanges<S> {
    /// f_int and f_eff.
    pub(crate) frequency: Range<S>,
    pub(crate) yielding: Range<S>,
    pub(crate) sag: Range<S>,
}

/// Words that are being read.
struct Saved<I> {
    words: I,
    /// How many were read.
    count: usize,
    expected: usize,
}

impl<I> Saved<I> {
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

    fn number<S: Scalar>(&mut self, valid: impl Fn(S) -> bool) -> Result<S, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = self.words.next().map(S::from_bits);
        self.checked(value, 1, |value| valid(*value))
    }

    fn path<S: Scalar>(
        &mut self,
        range: &Range<S::PathLength>,
    ) -> Result<S::PathLength, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = self.words.next().map(S::path_from_bits);
        self.checked(value, 1, |value| range.contains(*value))
    }

    fn slow<S: Scalar>(&mut self, range: &Range<S>) -> Result<S::Slow, RestoreError>
    where
        I: Iterator<Item = S::Bits>,
    {
        let value = S::slow_from_words(&mut self.words);
        self.checked(value, S::SLOW_WORDS, |value| {
            range.about_contains(S::of(*value), S::from_f64(ROUNDING))
        })
    }
}

impl<S: Scalar> FiberState<S> {
    fn words(self) -> impl Iterator<Item = S::Bits> {
        S::slow_words(self.intermediate_frequency)
            .chain(S::slow_words(self.effective_frequency))
            .chain(S::slow_words(self.yielding))
            .chain(S::slow_words(self.sag))
    }
}
