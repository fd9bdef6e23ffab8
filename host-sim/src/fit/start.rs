//! Starting muscle of a fit, and its file as a table to put the fitted numbers into.

use super::keys::FORCE;
use crate::coefficients;
use crate::muscle_file::{self, MuscleFileError, NamedMuscle};
use crate::muscles;
use std::path::Path;
use toml::{Table, Value};

/// A starting muscle.
#[derive(Clone, Debug)]
pub struct Start {
    /// The muscle.
    pub named: NamedMuscle,
    /// Its file, fibre types in order of rank as in the muscle.
    pub table: Table,
    /// Whether its file gives F0 instead of mass: F0 is then kept.
    pub keep_force: bool,
}

impl Start {
    /// Reads a file or a named muscle.
    pub fn read(path: &Path) -> Result<Self, MuscleFileError> {
        Self::parse(&muscles::text(path)?, path)
    }

    /// Parses a muscle file; `path` is for error messages.
    pub fn parse(text: &str, path: &Path) -> Result<Self, MuscleFileError> {
        let named = muscle_file::parse(text, path)?;
        let mut table: Table = toml::from_str(text).map_err(|error| MuscleFileError::Parse {
            path: path.to_owned(),
            message: error.to_string(),
        })?;
        if let Some(fibers) = table.get_mut("fiber").and_then(Value::as_array_mut) {
            fibers.sort_by(|one, other| rank(one).total_cmp(&rank(other)));
        }
        let keep_force = table.contains_key(FORCE);
        Ok(Self { named, table, keep_force })
    }
}

/// The rank of a valid fibre type.
fn rank(fiber: &Value) -> f64 {
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|rank| rank as f64));
    let preset = || {
        let row = coefficients::fiber_row(fiber.get("preset")?.as_str()?)?;
        row.get("rank").copied()
    };
    fiber.get("rank").and_then(number).or_else(preset).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_the_table_are_sorted_by_rank() {
        let text = "name = \"m\"\nmass_g = 97.5\nfascicle_length_cm = 11\ntendon_length_cm = 2\n\
                    max_path_length_cm = 18.4\n\
                    [[fiber]]\npreset = \"paper-table-1/fast\"\nfraction = 0.4\n\
                    [[fiber]]\npreset = \"paper-table-1/slow\"\nfraction = 0.6\n";
        let start = Start::parse(text, Path::new("m.toml")).expect("a muscle");
        let fraction = |index: usize| start.table["fiber"][index]["fraction"].as_float();
        assert_eq!(fraction(0), Some(0.6));
        assert_eq!(start.named.muscle.fibers[0].fraction, 0.6);
        assert!(!start.keep_force);
    }
}
