//! Everything of a muscle that changes from tick to tick.

use crate::domain::Domain;
use crate::scalar::Scalar;
use crate::tendon::Tendon;
use core::fmt;
use core::marker::PhantomData;

/// The state of a muscle of `N` fibre types recruited as `R` says, plain data: copy it to save it.
///
/// [`words`](Self::words) gives its bits, for storage and comparison, and
/// [`Muscle::restore`](crate::Muscle::restore) takes them back after checking them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<S, R, const N: usize> {
    /// (L_se - LrT)/kT: how far the tendon is extended beyond slack, in widths of its toe.
    pub(crate) tendon_extension: S,
    /// V, L_ce0/s.
    pub(crate) fascicle_velocity: S,
    /// L_mt at the end of the last tick, m.
    pub(crate) path_length: S,
    /// U_eff, 0..1; stays 0 in intramuscular FES.
    pub(crate) effective_activation: S,
    pub(crate) fibers: [FiberState<S>; N],
    pub(crate) recruitment: PhantomData<R>,
}

/// The part of the state that each fibre type has of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiberState<S> {
    /// f_int, f0.5 (intramuscular FES: intermediate recruitment, 0..1).
    pub(crate) intermediate_frequency: S,
    /// f_eff, f0.5 (intramuscular FES: recruitment, 0..1).
    pub(crate) effective_frequency: S,
    /// Y, 0..1.
    pub(crate) yielding: S,
    /// Where Y tends to at the present velocity, 0..1.
    pub(crate) yielding_target: S,
    /// S.
    pub(crate) sag: S,
    /// Af that the last tick foresaw for the middle of the next, 0..1.
    pub(crate) activation: S,
}

impl<S: Scalar> FiberState<S> {
    pub(crate) fn at_rest(sag: S) -> Self {
        Self {
            intermediate_frequency: S::ZERO,
            effective_frequency: S::ZERO,
            yielding: S::ONE,
            yielding_target: S::ONE,
            sag,
            activation: S::ZERO,
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

const OF_MUSCLE: usize = 4;
const PER_FIBER: usize = 6;

impl<S: Scalar, R, const N: usize> State<S, R, N> {
    /// How many words the state is saved in.
    pub const WORDS: usize = OF_MUSCLE + PER_FIBER * N;

    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fn fascicle_velocity(&self) -> S {
        self.fascicle_velocity
    }

    /// Effective activation U_eff, 0..1, of natural continuous recruitment.
    pub fn effective_activation(&self) -> S {
        self.effective_activation
    }

    /// The bits of the state, [`WORDS`](Self::WORDS) of them, always in the same order: tendon
    /// extension (kT), fascicle velocity (L_ce0/s), path length (m), effective activation; then of
    /// each type f_int, f_eff, Y, the target of Y, S, and the Af foreseen for the next tick.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let of_muscle = [
            self.tendon_extension,
            self.fascicle_velocity,
            self.path_length,
            self.effective_activation,
        ];
        of_muscle
            .into_iter()
            .chain(self.fibers.into_iter().flat_map(|f| f.values()))
            .map(S::to_bits)
    }

    /// The state whose bits are `words`, if every value is one that a tick can leave behind.
    pub(crate) fn from_words(
        words: impl IntoIterator<Item = S::Bits>,
        domain: &Domain<S>,
        tendon: &Tendon<S>,
    ) -> Result<Self, RestoreError> {
        let mut words = words.into_iter();
        let mut count = 0;
        let mut next = |within: &dyn Fn(S) -> bool| {
            let length = RestoreError::Length { expected: Self::WORDS };
            let value = S::from_bits(words.next().ok_or(length)?);
            if !within(value) {
                return Err(RestoreError::Value { word: count });
            }
            count += 1;
            Ok(value)
        };
        let share = |value: S| value >= S::ZERO && value <= S::ONE;
        let level = |value: S| value >= S::ZERO && value <= S::from_f64(1e3);
        let mut state = Self {
            tendon_extension: next(&|value| value.is_finite())?,
            fascicle_velocity: next(&|value| domain.fascicle_velocity.contains(value))?,
            path_length: next(&|value| domain.path_length.contains(value))?,
            effective_activation: next(&share)?,
            fibers: [FiberState::at_rest(S::ONE); N],
            recruitment: PhantomData,
        };
        let length = tendon.fascicle_length(state.path_length, state.tendon_extension);
        let (nearest, _) = domain.fascicle_length.clip(length);
        // A length that was stopped at a limit comes back with the rounding of its extension.
        if (length - nearest).abs() > S::from_f64(1e-4) {
            return Err(RestoreError::Value { word: 0 });
        }
        for fiber in &mut state.fibers {
            *fiber = FiberState {
                intermediate_frequency: next(&level)?,
                effective_frequency: next(&level)?,
                yielding: next(&share)?,
                yielding_target: next(&share)?,
                sag: next(&level)?,
                activation: next(&share)?,
            };
        }
        if words.next().is_some() {
            return Err(RestoreError::Length { expected: Self::WORDS });
        }
        Ok(state)
    }
}

impl<S: Scalar> FiberState<S> {
    fn values(self) -> [S; PER_FIBER] {
        [
            self.intermediate_frequency,
            self.effective_frequency,
            self.yielding,
            self.yielding_target,
            self.sag,
            self.activation,
        ]
    }
}
