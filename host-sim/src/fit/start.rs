//! Start of a fit: the muscle, and its file as a table that takes the fitted numbers.

use super::keys::FORCE;
use crate::coefficients;
use crate::muscle_file::{self, MuscleFileError, NamedMuscle};
use crate::muscles;
use std::path::Path;
use toml::{Table, Value};

/// A muscle to start from.
#[derive(Clone, Debug)]
pub struct Start {
    /// The muscle.
    pub named: NamedMuscle,
    /// Its file, fibre types in order of rank as in the muscle.
    pub table: Table,
    /// Its file gives F0 instead of mass, so F0 is kept.
    pub keep_force: bool,
}

impl Start {
    /// From a file, or from the name of a muscle.
    pub fn read(path: &Path) -> Result<Self, MuscleFileError> {
        Self::parse(&muscles::text(path)?, path)
    }

    /// From the text of a muscle file; `path` is for the messages.
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

/// The rank of a fibre type that was accepted.
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
    fn types_are_in_order_of_rank_in_the_table_too() {
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
