//! Results of functions.

use core::ffi::c_char;
use model::{Limit, ParameterError, RestoreError};

/// Result of a function: VM_RESULT_OK (0), or an error that has changed nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VmResult {
    /// Success.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// Wrong size of the muscle: header and library are of different versions.
    Size = 2,
    /// The muscle was not built, or was overwritten.
    NotBuilt = 3,
    /// A parameter is out of range; VmError has details.
    Parameter = 4,
    /// The words are out of range for this muscle.
    State = 5,
    /// The words are of another muscle, mode or time step.
    OtherMuscle = 6,
}

/// Bytes of VmError's field, including the final 0.
pub const VM_FIELD_SIZE: usize = 96;

/// A parameter that was refused.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmError {
    /// Name as in VmMuscleParams, ended by 0; a derived quantity follows after a colon.
    pub field: [c_char; VM_FIELD_SIZE],
    /// Index of the fibre type; -1 for the muscle's own parameters.
    pub fiber: i32,
    /// The refused value, in the field's unit.
    pub value: f64,
    /// Least allowed value, in the field's unit.
    pub least: f64,
    /// Greatest allowed value, in the field's unit.
    pub most: f64,
}

impl From<ParameterError> for VmError {
    fn from(error: ParameterError) -> Self {
        let (least, most) = match error.limit {
            Limit::Within { least, most } => (least, most),
            Limit::SumIsOne { within } => (1.0 - within, 1.0 + within),
            Limit::NotBefore { rank } => (rank, 255.0),
            _ => (1.0, f64::INFINITY),
        };
        let mut field = [0; VM_FIELD_SIZE];
        // The last byte stays 0. `char` may be signed.
        let room = VM_FIELD_SIZE - 1;
        for (place, byte) in field.iter_mut().take(room).zip(error.field.bytes()) {
            *place = byte as c_char;
        }
        // Types are few.
        let fiber = error.fiber.map_or(-1, |index| index as i32);
        Self { field, fiber, value: error.value, least, most }
    }
}

impl From<RestoreError> for VmResult {
    fn from(error: RestoreError) -> Self {
        match error {
            RestoreError::OtherMuscle { .. } => Self::OtherMuscle,
            _ => Self::State,
        }
    }
}
