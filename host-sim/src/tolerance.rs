//! How far each row of `verify` may be off: one table, with a reason for each entry.
//!
//! An entry that is looser than twice what is measured fails, and so does one that no row uses:
//! the table says what is so, not what would be enough.

use std::collections::BTreeMap;

const TABLE: &str = include_str!("../data/tolerances.csv");

/// What a row may be off by.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest absolute error, % of F0.
    pub max: f64,
    /// Root-mean-square error, % of F0, where that is limited too.
    pub rms: Option<f64>,
    /// Why the error is what it is.
    pub reason: String,
}

/// Names a row: scenario, mode, arithmetic, and what it is compared against.
pub type Key = [String; 4];

/// The table.
///
/// # Panics
/// If the built-in table is not as it should be; a test reads it.
pub fn table() -> BTreeMap<Key, Tolerance> {
    let mut reader = csv::Reader::from_reader(TABLE.as_bytes());
    reader
        .records()
        .map(|record| {
            let record = record.expect("an even row in the table of tolerances");
            let key = [0, 1, 2, 3].map(|column| record[column].to_owned());
            let max = record[4].parse().expect("a number in the table of tolerances");
            let rms = (!record[5].is_empty())
                .then(|| record[5].parse().expect("a number in the table of tolerances"));
            (key, Tolerance { max, rms, reason: record[6].to_owned() })
        })
        .collect()
}

/// What the project promises of a row, whatever its own tolerance: largest and, where promised,
/// root-mean-square error in % of F0.
pub fn promise(key: &Key, f0: f64) -> (f64, Option<f64>) {
    let [scenario, _, arithmetic, _] = key;
    if arithmetic == "reference" {
        return (0.005 / f0 * 100.0, None);
    }
    let share = match scenario.split_once('@') {
        Some((_, "2ms")) => 10.0,
        Some((_, "0.5ms" | "0.1ms")) => 0.5,
        _ => 1.0,
    };
    // Where a tendon rings, as one that snaps taut or is pulled at with a jerk.
    let rings = ["passive_length", "velocity_kinks"].iter().any(|name| scenario.starts_with(name));
    if rings { (1.5 * share, Some(0.1 * share)) } else { (0.1 * share, None) }
}
