//! Tolerances of `verify`: one table, with a reason for each entry.
//!
//! A tolerance above twice the measured error fails, and so does one that no row uses.

use crate::engine::Class;
use std::collections::BTreeMap;

const TABLE: &str = include_str!("../data/tolerances.csv");

/// Tolerance of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest absolute error, % of F0.
    pub max: f64,
    /// Root-mean-square error, % of F0, if limited.
    pub rms: Option<f64>,
    /// Cause of the error.
    pub reason: String,
}

/// Key of a row: scenario, mode, arithmetic, and what it is compared with.
pub type Key = [String; 4];

/// The table.
///
/// # Panics
/// If the built-in table is malformed; a test reads it.
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

/// What an accuracy class promises, % of F0 at ticks of 1 ms: largest error where the muscle rings
/// on its tendon, where the stimulation frequency jumps, and elsewhere.
fn promises(class: Class) -> [f64; 3] {
    match class {
        Class::Economy => [5.0, 1.0, 0.5],
        Class::Standard => [1.0, 0.2, 0.1],
        Class::Fine => [0.05, 0.02, 0.07],
    }
}

/// Promised largest and, where promised, root-mean-square error of a row, % of F0. It is
/// independent of the row's tolerance.
pub fn promise(key: &Key, class: Class, f0: f64) -> (f64, Option<f64>) {
    let [scenario, _, arithmetic, _] = key;
    if arithmetic == "reference" {
        return (0.005 / f0 * 100.0, None);
    }
    let share = match scenario.split_once('@') {
        Some((_, "2ms")) => 10.0,
        Some((_, "0.5ms" | "0.1ms")) => 0.5,
        _ => 1.0,
    };
    // The stimulation frequency, and with it Af, jumps by up to the whole of its range.
    let jumps = ["fes_variable_trains", "fes_doublets"];
    let [ringing, jumping, other] = promises(class);
    if rings(scenario) {
        (ringing * share, Some(0.1 * ringing * share))
    } else if jumps.iter().any(|name| scenario.starts_with(name)) {
        (jumping * share, None)
    } else {
        (other * share, None)
    }
}

/// Whether the muscle rings on its tendon in a scenario: a slack tendon snaps taut, or the path
/// jerks.
pub fn rings(scenario: &str) -> bool {
    ["passive_length", "velocity_kinks", "fast_ramps_kinks"]
        .iter()
        .any(|name| scenario.starts_with(name))
}
