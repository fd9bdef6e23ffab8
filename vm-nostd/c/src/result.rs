//! Results of functions.

use crate::names;
use core::ffi::c_char;
use model::control::JointError;
use model::{Differs, Limit, ParameterError, RestoreError, WordsError};

/// Result of a function: VM_RESULT_OK (0), or an error that has changed nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VmResult {
    /// Success.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// The memory is too small; VmError has the bytes or words that are needed.
    Size = 2,
    /// Nothing was built here, or by functions of another arithmetic, or it was overwritten.
    NotBuilt = 3,
    /// A parameter is out of range; VmError has details.
    Parameter = 4,
    /// The words are out of range for this muscle.
    State = 5,
    /// The words are of another muscle, controller, mode or time step.
    OtherMuscle = 6,
    /// A pointer is not aligned for its type.
    Alignment = 7,
    /// There is no state yet: call rest, start or restore first.
    NotRested = 8,
    /// VmMuscleParams.version is not VM_VERSION of this library.
    Version = 9,
    /// The words are damaged, or of something else than was asked for; VmError has details.
    Words = 10,
}

/// Bytes of VmError's field, including the final 0.
pub const VM_FIELD_SIZE: usize = 96;

/// A parameter that was refused.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmError {
    /// Name of the field in its struct, ended by 0; a derived quantity follows after a colon.
    pub field: [c_char; VM_FIELD_SIZE],
    /// Index of the fibre type; -1 for all else.
    pub fiber: i32,
    /// Index of the muscle of a joint or controller; -1 for all else.
    pub muscle: i32,
    /// The refused value, in the field's unit.
    pub value: f64,
    /// Least allowed value, in the field's unit.
    pub least: f64,
    /// Greatest allowed value, in the field's unit.
    pub most: f64,
}

impl VmError {
    fn new(texts: [&str; 2], fiber: Option<usize>, value: f64, limits: (f64, f64)) -> Self {
        let mut field = [0; VM_FIELD_SIZE];
        // The last byte stays 0. `char` may be signed.
        let places = field.iter_mut().take(VM_FIELD_SIZE - 1);
        for (place, byte) in places.zip(texts.into_iter().flat_map(str::bytes)) {
            *place = byte as c_char;
        }
        // Types are few.
        let fiber = fiber.map_or(-1, |index| index as i32);
        Self { field, fiber, muscle: -1, value, least: limits.0, most: limits.1 }
    }

    /// Memory of `size`, where `needed` is needed.
    pub(crate) fn size(size: usize, needed: usize) -> Self {
        Self::new(["size", ""], None, size as f64, (needed as f64, f64::INFINITY))
    }

    /// Of a muscle of a joint or controller.
    pub(crate) fn of_muscle(mut self, muscle: Option<usize>) -> Self {
        self.muscle = muscle.map_or(-1, |index| index as i32);
        self
    }
}

impl From<ParameterError> for VmError {
    fn from(error: ParameterError) -> Self {
        let limits = match error.limit {
            Limit::Within { least, most } => (least, most),
            Limit::SumIsOne { within } => (1.0 - within, 1.0 + within),
            Limit::NotBefore { rank } => (rank, 255.0),
            _ => (1.0, f64::INFINITY),
        };
        Self::new(names::in_c(error.field), error.fiber, error.value, limits)
    }
}

impl From<WordsError> for VmError {
    fn from(error: WordsError) -> Self {
        let equal = |field, found, expected| {
            Self::new(["words: ", field], None, found, (expected, expected))
        };
        match error {
            WordsError::Other { what: Differs::TimeStep, found, expected } => {
                let [found, expected] = [found, expected].map(|bits| f32::from_bits(bits).into());
                equal("time_step_s", found, expected)
            }
            // VmMode counts from 0.
            WordsError::Other { what: Differs::Mode, found, expected } => {
                equal("mode", f64::from(found) - 1.0, f64::from(expected) - 1.0)
            }
            WordsError::Other { what, found, expected } => {
                let field = match what {
                    Differs::Version => "version",
                    Differs::Arithmetic => "arithmetic",
                    Differs::Types => "fiber_count",
                    Differs::Class => "accuracy_class",
                    _ => "layout",
                };
                equal(field, found.into(), expected.into())
            }
            WordsError::Length { found, expected } => equal("count", found as f64, expected as f64),
            WordsError::Checksum { found, expected } => {
                equal("checksum", found.into(), expected.into())
            }
            WordsError::Value { word } => equal("index of a value out of range", word as f64, 0.0),
            _ => equal("", 0.0, 0.0),
        }
    }
}

impl From<RestoreError> for VmResult {
    fn from(error: RestoreError) -> Self {
        match error {
            RestoreError::OtherMuscle { .. } => Self::OtherMuscle,
            RestoreError::Length { .. } => Self::Size,
            _ => Self::State,
        }
    }
}

/// Why nothing was built.
pub enum Refusal {
    /// Without details.
    Result(VmResult),
    /// With details, and the muscle of a joint or controller.
    Parameter(JointError),
    /// Memory of `size`, where `needed` is needed.
    Size { size: usize, needed: usize },
    /// Words that are not of what was asked for.
    Words(WordsError),
}

impl From<WordsError> for Refusal {
    fn from(error: WordsError) -> Self {
        Self::Words(error)
    }
}

impl From<VmResult> for Refusal {
    fn from(result: VmResult) -> Self {
        Self::Result(result)
    }
}

impl From<ParameterError> for Refusal {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(JointError { muscle: None, error })
    }
}

impl From<JointError> for Refusal {
    fn from(error: JointError) -> Self {
        Self::Parameter(error)
    }
}

impl Refusal {
    /// The refusal of a muscle of a joint or controller.
    pub fn of_muscle(self, muscle: usize) -> Self {
        match self {
            Self::Parameter(refused) => {
                Self::Parameter(JointError { muscle: Some(muscle), ..refused })
            }
            other => other,
        }
    }
}
