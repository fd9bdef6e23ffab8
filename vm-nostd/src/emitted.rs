//! A built muscle as words: a host writes them, firmware keeps them in flash and checks them. Such
//! firmware needs none of the code that builds a muscle.

use crate::checksum::Checksum;
use crate::error::ParameterError;
use crate::muscle::Muscle;
use crate::params::MuscleParams;
use crate::params::class::Class;
use crate::recruitment::{Recruitment, RecruitmentTick};
use crate::scalar::Scalar;
use crate::summed::{FromWords, Sink, Summed, Words, summed};
use crate::tick::time_step::TimeStep;
use core::fmt;

/// Words of a muscle were refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WordsError {
    /// They are something else than what was asked for.
    Other {
        /// What differs.
        what: Differs,
        /// Number in the words.
        found: u32,
        /// Number of the muscle that was asked for.
        expected: u32,
    },
    /// The number of words is wrong.
    Length {
        /// Number of words.
        found: usize,
        /// Number of words of such a muscle, [`Muscle::WORDS`].
        expected: usize,
    },
    /// They are damaged.
    Checksum {
        /// Checksum at their end.
        found: u32,
        /// Checksum of the other words.
        expected: u32,
    },
    /// A value is not finite or out of range.
    Value {
        /// Index of the last word that was read, from 0.
        word: usize,
    },
}

/// What differs between words and the muscle that was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Differs {
    /// Version of this crate: 1,048,576 major + 1,024 minor + patch.
    Version,
    /// Arithmetic: 1 is `f32`, 2 is `f64`, 3 is [`Fixed`](crate::Fixed).
    Arithmetic,
    /// Mode: 1 is continuous, 2 is FES, 3 is discrete, 4 is discrete with effective lengths.
    Mode,
    /// Number of fibre types.
    Types,
    /// Accuracy class: 0 is standard, 1 is economy, 2 is fine.
    Class,
    /// Time step: the bits of its seconds in `f32`.
    TimeStep,
    /// Layout of the coefficients, as a checksum: the room for motor units differs, or the crate
    /// was changed without a new version.
    Layout,
}

impl fmt::Display for WordsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Other { what: Differs::TimeStep, found, expected } => {
                let [found, expected] = [found, expected].map(f32::from_bits);
                write!(f, "words: time step = {found} s: must be {expected} s")
            }
            Self::Other { what: Differs::Version, found, expected } => {
                let [found, expected] =
                    [found, expected].map(|v| [v >> 20, v >> 10 & 1023, v & 1023]);
                let ([a, b, c], [d, e, g]) = (found, expected);
                write!(f, "words: version = {a}.{b}.{c}: must be {d}.{e}.{g}")
            }
            Self::Other { what, found, expected } => {
                let name = match what {
                    Differs::Arithmetic => "arithmetic",
                    Differs::Mode => "mode",
                    Differs::Types => "number of fibre types",
                    Differs::Class => "accuracy class",
                    _ => "layout",
                };
                write!(f, "words: {name} = {found}: must be {expected}")
            }
            Self::Length { found, expected } => {
                write!(f, "words: length = {found}: must be {expected}")
            }
            Self::Checksum { found, expected } => {
                write!(f, "words: checksum = {found:#x}: must be {expected:#x}")
            }
            Self::Value { word } => {
                write!(f, "words: the value that ends in word {word} is not finite or out of range")
            }
        }
    }
}

impl core::error::Error for WordsError {}

summed! {
    /// What the words are of; these come first.
    #[derive(Clone, Copy)]
    struct Header {
        version: u32,
        arithmetic: u32,
        mode: u32,
        types: u32,
        class: u32,
        /// Bits of the seconds in `f32`, in which steps that differ by rounding in `f64` are equal.
        time_step: u32,
        layout: u32,
    }
}

impl Header {
    #[inline]
    fn new<S: Scalar, R: Recruitment<S, N>, const N: usize>(class: Class, step: TimeStep) -> Self {
        Self {
            version: VERSION,
            arithmetic: S::ARITHMETIC,
            mode: R::MODE,
            types: N as u32,
            class: match class {
                Class::Standard => 0,
                Class::Economy => 1,
                Class::Fine => 2,
            },
            time_step: (step.seconds() as f32).to_bits(),
            layout: const { <Muscle<S, R, N> as FromWords>::LAYOUT.value() },
        }
    }

    /// Refuses the words of something else.
    fn matches(&self, expected: &Self) -> Result<(), WordsError> {
        let same = |what, found, expected| {
            if found == expected {
                Ok(())
            } else {
                Err(WordsError::Other { what, found, expected })
            }
        };
        same(Differs::Version, self.version, expected.version)?;
        same(Differs::Arithmetic, self.arithmetic, expected.arithmetic)?;
        same(Differs::Mode, self.mode, expected.mode)?;
        same(Differs::Types, self.types, expected.types)?;
        same(Differs::Class, self.class, expected.class)?;
        same(Differs::TimeStep, self.time_step, expected.time_step)?;
        same(Differs::Layout, self.layout, expected.layout)
    }
}

/// Version of this crate.
const VERSION: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 20
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 10
    | number(env!("CARGO_PKG_VERSION_PATCH"));

/// A decimal number.
const fn number(text: &str) -> u32 {
    let (mut rest, mut number) = (text.as_bytes(), 0);
    while let [digit, after @ ..] = rest {
        number = 10 * number + (*digit - b'0') as u32;
        rest = after;
    }
    number
}

/// Passes words on, with their checksum.
struct Emitter<E> {
    each: E,
    checksum: Checksum,
}

impl<E: FnMut(u32)> Sink for Emitter<E> {
    fn add(&mut self, word: u32) {
        self.checksum.add(word);
        (self.each)(word);
    }
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> Muscle<S, R, N> {
    /// Number of words of [`emit`](Self::emit).
    pub const WORDS: usize = Header::WORDS + <Self as FromWords>::WORDS + 1;

    /// Builds a muscle and passes its [`WORDS`](Self::WORDS) words on, one by one, for
    /// [`from_words`](Self::from_words). The same errors as
    /// [`build_with_units`](Self::build_with_units).
    pub fn emit(
        params: &MuscleParams<N>,
        units: &R::Units,
        step: TimeStep,
        each: impl FnMut(u32),
    ) -> Result<(), ParameterError> {
        let muscle = Self::build_with_units(params, units, step)?;
        let mut emitter = Emitter { each, checksum: Checksum::EMPTY };
        Header::new::<S, R, N>(params.class, step).sum(&mut emitter);
        muscle.sum(&mut emitter);
        let Emitter { mut each, checksum } = emitter;
        each(checksum.value());
        Ok(())
    }

    /// The muscle whose words were [emitted](Self::emit), with the bits of a built one, for a class
    /// and a time step that must be those of the words. The words must be of the same version of
    /// this crate. An error says what differs; damaged words are accepted with a probability of
    /// about 2^-32.
    ///
    /// ```
    /// use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
    /// use vm_nostd::{Class, FesMuscle, FiberParams, MuscleParams, TimeStep};
    ///
    /// # let params = MuscleParams {
    /// #     mass: 97.5e-3, fascicle_length: 0.11, tendon_length: 0.02, max_path_length: 0.184,
    /// #     recruitment_saturation: 0.8, class: Class::Standard, elements: ELEMENTS,
    /// #     fibers: [
    /// #         FiberParams { fraction: 0.6, fiber_type: SLOW },
    /// #         FiberParams { fraction: 0.4, fiber_type: FAST },
    /// #     ],
    /// # };
    /// type Mine = FesMuscle<f32, 2>;
    /// // On a host; `vm emit` writes the words as source text.
    /// let mut words = Vec::new();
    /// Mine::emit(&params, &(), TimeStep::MILLISECOND, |word| words.push(word))?;
    /// // In firmware.
    /// let muscle = Mine::from_words(&words, Class::Standard, TimeStep::MILLISECOND).unwrap();
    /// assert_eq!(muscle.checksum(), Mine::build(&params, TimeStep::MILLISECOND)?.checksum());
    /// # Ok::<(), vm_nostd::ParameterError>(())
    /// ```
    // Inlined, so that the time step of a constant is converted when firmware is compiled.
    #[inline]
    pub fn from_words(words: &[u32], class: Class, step: TimeStep) -> Result<Self, WordsError> {
        Self::matching(words, &Header::new::<S, R, N>(class, step))
    }

    /// The muscle of words with this header.
    fn matching(words: &[u32], expected: &Header) -> Result<Self, WordsError> {
        let length = WordsError::Length { found: words.len(), expected: Self::WORDS };
        let Some((&found, summed)) = words.split_last() else { return Err(length) };
        let mut rest = Words::new(summed);
        let header = Header::read(&mut rest).ok_or(length)?;
        header.matches(expected)?;
        if words.len() != Self::WORDS {
            return Err(length);
        }
        let mut checksum = Checksum::EMPTY;
        summed.iter().for_each(|&word| checksum.add(word));
        let expected = checksum.value();
        if found != expected {
            return Err(WordsError::Checksum { found, expected });
        }
        <Self as FromWords>::read(&mut rest)
            .filter(|muscle| muscle.recruitment.fits())
            .ok_or_else(|| WordsError::Value { word: summed.len() - rest.left() - 1 })
    }
}
