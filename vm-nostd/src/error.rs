//! Errors of refused parameters.

use core::fmt;

/// A refused parameter with its value and limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterError {
    /// The parameter's field. If a derived quantity is refused, its name follows after a colon, and
    /// `value` and `limit` are those of the derived quantity.
    pub field: &'static str,
    /// Index of the fibre type; `None` for the muscle's own parameters.
    pub fiber: Option<usize>,
    /// The refused value, in the field's unit.
    pub value: f64,
    /// The violated limit.
    pub limit: Limit,
}

/// Limit of a parameter, in its field's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Limit {
    /// A number between two bounds, both allowed.
    Within {
        /// Smallest value allowed.
        least: f64,
        /// Largest value allowed.
        most: f64,
    },
    /// The fractions of all types must add to 1, within the given distance.
    SumIsOne {
        /// Largest distance from 1 allowed.
        within: f64,
    },
    /// Types must be listed in order of rank: at least the rank before.
    NotBefore {
        /// The rank of the type before.
        rank: f64,
    },
    /// A whole number of at least 1.
    AtLeastOneType,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Within { least, most } => write!(f, "must be between {least} and {most}"),
            Self::SumIsOne { within } => {
                write!(f, "the fractions of all types must add to 1 (within {within})")
            }
            Self::NotBefore { rank } => {
                write!(f, "types must be in order of rank: the previous one has {rank}")
            }
            Self::AtLeastOneType => f.write_str("a muscle has at least one fibre type"),
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(fiber) = self.fiber {
            write!(f, "fibers[{fiber}].")?;
        }
        write!(f, "{} = {}: {}", self.field, self.value, self.limit)
    }
}

impl core::error::Error for ParameterError {}

/// Accepts a value within the bounds; refuses all others, including NaN.
pub(crate) const fn within(
    field: &'static str,
    value: f64,
    least: f64,
    most: f64,
) -> Result<(), ParameterError> {
    if value >= least && value <= most {
        Ok(())
    } else {
        Err(ParameterError { field, fiber: None, value, limit: Limit::Within { least, most } })
    }
}
