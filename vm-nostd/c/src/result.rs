//! What functions answer.

use core::ffi::c_char;
use model::{Limit, ParameterError, RestoreError};

/// What a function answers; VM_RESULT_OK is 0, and everything else has changed nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VmResult {
    /// It was done.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// The muscle has another size than in this library: header and library are of different versions.
    Size = 2,
    /// The muscle was not built, or something has written over it.
    NotBuilt = 3,
    /// A parameter is out of its range; which one is in VmError.
    Parameter = 4,
    /// These words are no state of this muscle.
    State = 5,
    /// These words were saved by another muscle, or for another mode or time step.
    OtherMuscle = 6,
}

/// Bytes of VmError's field, its final 0 included.
pub const VM_FIELD_SIZE: usize = 96;

/// A parameter that was refused.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmError {
    /// Its name, as in VmMuscleParams, ended by 0; what follows a colon is what was derived from it and refused.
    pub field: [c_char; VM_FIELD_SIZE],
    /// Index of the fibre type that it belongs to; -1 where it is the muscle's own.
    pub fiber: i32,
    /// The refused value, in the field's unit.
    pub value: f64,
    /// The least that is taken, in the field's unit.
    pub least: f64,
    /// The most that is taken, in the field's unit.
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
        // The last one stays 0. Characters of C may have a sign.
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
