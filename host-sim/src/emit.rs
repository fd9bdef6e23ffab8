//! A muscle as words in source text, for firmware that does not build it.

use crate::engine::{Arithmetic, C_UNITS, Class, MOST_UNITS, RunError, count_units, mode_name};
use crate::model_muscle::{self, with_type_count};
use crate::reference::{Mode, Muscle};
use std::fmt::{self, Display, Write};
use vm_nostd as vm;

/// Language of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Language {
    /// Rust, to be included (`include!`): `rustfmt` would wrap its lines.
    Rust,
    /// C, for `vm_f32_from_words` and its like.
    C,
}

/// What is emitted.
#[derive(Clone, Copy, Debug)]
pub struct Emission<'a> {
    /// Name of the muscle.
    pub name: &'a str,
    /// The muscle.
    pub muscle: &'a Muscle,
    /// Recruitment mode.
    pub mode: Mode,
    /// Arithmetic of `vm-nostd`.
    pub arithmetic: Arithmetic,
    /// Accuracy class.
    pub class: Class,
    /// Time step, s.
    pub time_step: f64,
}

/// Motor units that discrete muscles have room for.
const ROOM: [usize; 2] = [C_UNITS, MOST_UNITS];
/// Words in a line: as many as rustfmt puts into 100 columns.
const PER_LINE: usize = 8;

impl Emission<'_> {
    /// The words, for `Muscle::from_words`. The reference has none.
    pub fn words(&self) -> Result<Vec<u32>, RunError> {
        match self.arithmetic {
            Arithmetic::Reference => Err(RunError::NoBits),
            Arithmetic::F32 => self.of_scalar::<f32>(),
            Arithmetic::Fixed => self.of_scalar::<vm::Fixed>(),
            Arithmetic::F64 => self.of_scalar::<f64>(),
        }
    }

    fn of_scalar<S: vm::Scalar>(&self) -> Result<Vec<u32>, RunError> {
        with_type_count!(
            self.muscle,
            N => match self.mode {
                Mode::Continuous => self.of_mode::<S, vm::NaturalContinuous, N>(&()),
                Mode::Fes => self.of_mode::<S, vm::IntramuscularFes, N>(&()),
                Mode::Discrete => self.discrete::<S, vm::FascicleLength, N>(),
                Mode::DiscreteEffectiveLength => self.discrete::<S, vm::EffectiveLength, N>(),
            },
            else Err(RunError::TypeCount(self.muscle.fibers.len()))
        )
    }

    fn discrete<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize>(
        &self,
    ) -> Result<Vec<u32>, RunError> {
        match self.room()? {
            C_UNITS => self.of_units::<S, A, N, { ROOM[0] }>(),
            _ => self.of_units::<S, A, N, { ROOM[1] }>(),
        }
    }

    fn of_units<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize, const UNITS: usize>(
        &self,
    ) -> Result<Vec<u32>, RunError> {
        let units = model_muscle::motor_units::<N, UNITS>(self.muscle)?;
        self.of_mode::<S, vm::NaturalDiscrete<A, UNITS>, N>(&units)
    }

    fn of_mode<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize>(
        &self,
        units: &R::Units,
    ) -> Result<Vec<u32>, RunError> {
        let step = vm::TimeStep::from_seconds(self.time_step)?;
        let class = self.class.of_model();
        let params = vm::MuscleParams { class, ..model_muscle::params(self.muscle) };
        let mut words = Vec::with_capacity(vm::Muscle::<S, R, N>::WORDS);
        vm::Muscle::<S, R, N>::emit(&params, units, step, |word| words.push(word))?;
        Ok(words)
    }

    /// Motor units that the muscle has room for.
    fn room(&self) -> Result<usize, RunError> {
        let count = count_units(self.muscle)?;
        ROOM.into_iter().find(|&room| count <= room).ok_or(RunError::UnitCount(count))
    }

    /// The words as source text, with a function that reads them.
    pub fn text(&self, language: Language) -> Result<String, RunError> {
        let words = self.words()?;
        Ok(match language {
            Language::Rust => self.rust(&words)?,
            Language::C => self.c(&words)?,
        })
    }

    /// What it is, for a comment.
    fn title(&self) -> String {
        // No line break and no end of a comment.
        let kept = |c: char| if c.is_alphanumeric() || " -_.,()'".contains(c) { c } else { '_' };
        let name: String = self.name.chars().map(kept).collect();
        let (mode, arithmetic) = (mode_name(self.mode), self.arithmetic.name());
        let (class, tick) = (self.class.name(), (self.time_step * 1e9).round() / 1e6);
        let version = env!("CARGO_PKG_VERSION");
        format!(
            "{name}: mode {mode}, arithmetic {arithmetic}, class {class}, tick {tick} ms, vm-nostd \
             {version}."
        )
    }

    /// Name in the text: muscle, mode and arithmetic.
    fn identifier(&self) -> String {
        let full = format!("{} {} {}", self.name, mode_name(self.mode), self.arithmetic.name());
        let kept = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
        let name: String = full.chars().map(kept).collect();
        if name.starts_with(|c: char| c.is_ascii_digit()) { format!("m_{name}") } else { name }
    }

    fn rust(&self, words: &[u32]) -> Result<String, RunError> {
        let (name, types) = (self.identifier(), self.muscle.fibers.len());
        let constant = name.to_ascii_uppercase();
        let scalar = match self.arithmetic {
            Arithmetic::F64 => "f64",
            Arithmetic::Fixed => "vm_nostd::Fixed",
            _ => "f32",
        };
        let muscle = match self.mode {
            Mode::Continuous => format!("ContinuousMuscle<{scalar}, {types}>"),
            Mode::Fes => format!("FesMuscle<{scalar}, {types}>"),
            Mode::Discrete => format!("DiscreteMuscle<{scalar}, {types}, {}>", self.room()?),
            Mode::DiscreteEffectiveLength => {
                format!("EffectiveLengthMuscle<{scalar}, {types}, {}>", self.room()?)
            }
        };
        Ok(format!(
            "// {title}
// Written by `vm emit`, for include!(). Another version of vm-nostd refuses these words.

/// Words of the muscle, for [`{name}`].
pub static {constant}: [u32; {count}] = [
{rows}];

/// Its time step.
pub const {constant}_STEP: vm_nostd::TimeStep = match vm_nostd::TimeStep::from_seconds({step:?}) {{
    Ok(step) => step,
    Err(_) => panic!(\"a time step out of range\"),
}};

/// The muscle. An error if the words are damaged or of another version.
pub fn {name}() -> Result<vm_nostd::{muscle}, vm_nostd::WordsError> {{
    vm_nostd::Muscle::from_words(&{constant}, vm_nostd::Class::{class:?}, {constant}_STEP)
}}
",
            title = self.title(),
            count = words.len(),
            rows = Rows(words),
            step = self.time_step,
            class = self.class,
        ))
    }

    fn c(&self, words: &[u32]) -> Result<String, RunError> {
        if matches!(self.mode, Mode::Discrete | Mode::DiscreteEffectiveLength) {
            let count = count_units(self.muscle)?;
            if count > C_UNITS {
                return Err(RunError::UnitsInC(count));
            }
        }
        let name = self.identifier();
        let (kind, prefix) = match self.arithmetic {
            Arithmetic::F64 => ("F64", "f64"),
            Arithmetic::Fixed => ("Fixed", "fixed"),
            _ => ("F32", "f32"),
        };
        let mode = match self.mode {
            Mode::Continuous => "CONTINUOUS",
            Mode::Fes => "FES",
            Mode::Discrete => "DISCRETE",
            Mode::DiscreteEffectiveLength => "EFFECTIVE_LENGTH",
        };
        Ok(format!(
            "/* {title}
   Written by `vm emit`. Another version of vm-nostd refuses these words. */

#pragma once

#include \"vm_nostd.h\"

/* Words of the muscle, for {name}. */
static const uint32_t {name}_words[{count}] = {{
{rows}}};

/* Puts the muscle into memory of `size` bytes. Rest or restore comes next. */
static inline VmResult {name}(VmMuscle{kind} *muscle, size_t size, VmError *error) {{
    return vm_{prefix}_from_words(muscle, size, {name}_words, {count}, {types}, VM_MODE_{mode},
        VM_CLASS_{class}, {step:?}, error);
}}
",
            title = self.title(),
            count = words.len(),
            types = self.muscle.fibers.len(),
            rows = Rows(words),
            class = self.class.name().to_ascii_uppercase(),
            step = self.time_step,
        ))
    }
}

/// Words as lines of numbers.
struct Rows<'a>(&'a [u32]);

impl Display for Rows<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.0.chunks(PER_LINE) {
            f.write_str("   ")?;
            line.iter().try_for_each(|word| write!(f, " {word:#010x},"))?;
            f.write_char('\n')?;
        }
        Ok(())
    }
}
