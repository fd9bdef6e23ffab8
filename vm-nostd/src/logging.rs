//! `defmt::Format` for logging in firmware, in SI units in every arithmetic.
//!
//! Numbers are converted to `f64`: on a core without a floating-point unit that takes some
//! hundred cycles per number, so log outside the tick.

use crate::error::{Limit, ParameterError};
use crate::io::{Input, Output};
use crate::scalar::Scalar;
use crate::status::Status;
use defmt::{Format, Formatter, write};

/// Names of the flags, or `none`.
impl Format for Status {
    fn format(&self, f: Formatter<'_>) {
        if self.is_empty() {
            write!(f, "none");
        }
        for (index, (name, _)) in self.iter_names().enumerate() {
            if index > 0 {
                write!(f, " | ");
            }
            write!(f, "{=str}", name);
        }
    }
}

/// As `Display`.
impl Format for Limit {
    fn format(&self, f: Formatter<'_>) {
        match self {
            Self::Within { least, most } => {
                write!(f, "must be between {=f64} and {=f64}", least, most);
            }
            Self::SumIsOne { within } => {
                write!(f, "the fractions of all types must add to 1 (within {=f64})", within);
            }
            Self::NotBefore { rank } => {
                write!(f, "types must be in order of rank: the previous one has {=f64}", rank)
            }
            Self::AtLeastOneType => write!(f, "a muscle has at least one fibre type"),
        }
    }
}

/// As `Display`: field, value and limit.
impl Format for ParameterError {
    fn format(&self, f: Formatter<'_>) {
        if let Some(fiber) = self.fiber {
            write!(f, "fibers[{=usize}].", fiber);
        }
        write!(f, "{=str} = {=f64}: {}", self.field, self.value, self.limit);
    }
}

impl<S: Scalar> Format for Input<S> {
    fn format(&self, f: Formatter<'_>) {
        write!(
            f,
            "activation {=f64}, path {=f64} m, stimulation {=f64} pps",
            self.activation.to_f64(),
            S::path_metres(self.path_length),
            S::quantity_value(self.stimulation_frequency)
        );
    }
}

impl<S: Scalar> Format for Output<S> {
    fn format(&self, f: Formatter<'_>) {
        write!(
            f,
            "force {=f64} N ({=f64} F0), fascicles {=f64} L_ce0, {=f64} L_ce0/s, status {}",
            S::newtons(self.force),
            self.relative_force.to_f64(),
            self.fascicle_length.to_f64(),
            self.fascicle_velocity.to_f64(),
            self.status
        );
    }
}
