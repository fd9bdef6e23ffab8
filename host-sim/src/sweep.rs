//! Sweeps over muscles and inputs: every arithmetic against the reference, on all cores, into a
//! table that can be resumed after an interruption.

mod case;
mod keys;
mod space;
mod summary;

pub use case::{Case, Measured};
pub use keys::{KEYS, Key};
pub use space::{Space, SpaceError, Variation};
pub use summary::{Promise, Summary};

use crate::engine::{self, Arithmetic, Class};
use crate::golden;
use crate::ledger::{Ledger, LedgerError};
use std::path::Path;

/// A sweep: its cases, arithmetics and accuracy class.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The muscles and inputs.
    pub space: Space,
    /// Arithmetics compared with the reference.
    pub arithmetics: Vec<Arithmetic>,
    /// Accuracy class.
    pub class: Class,
    /// Arguments of `vm sweep` that reproduce the sweep.
    pub arguments: String,
}

/// One of the cases with the largest errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Number of the case.
    pub case: usize,
    /// Arithmetic.
    pub arithmetic: Arithmetic,
    /// Largest error, % of F0.
    pub max_pct_f0: f64,
    /// Flags raised during the run.
    pub status: String,
}

/// Columns per arithmetic.
const MEASURED: [&str; 4] = ["max_pct_f0", "rms_pct_f0", "bias_pct_f0", "status"];

impl Sweep {
    /// First two lines of the table: the command with the model's version, and the columns.
    fn head(&self) -> [String; 2] {
        let mut columns: Vec<String> = ["case", "mode"].map(str::to_owned).to_vec();
        columns.extend(KEYS.iter().map(|key| key.name.to_owned()));
        for arithmetic in &self.arithmetics {
            let name = arithmetic.name();
            columns.extend(MEASURED.map(|column| format!("{name}_{column}")));
        }
        columns.push("problem".to_owned());
        [format!("# vm sweep {} # {}", self.arguments, golden::model()), columns.join(",")]
    }

    /// First cells of a case's row: number, mode and values of the keys.
    fn begin(number: usize, case: &Case) -> Vec<String> {
        let mut row = vec![number.to_string(), engine::mode_name(case.mode).to_owned()];
        row.extend(case.values.iter().map(f64::to_string));
        row
    }

    /// Index of the first measured column.
    fn first_measured() -> usize {
        2 + KEYS.len()
    }

    /// Computes the missing rows and sorts the table; see [`Ledger::complete`].
    pub fn run(&self, output: &Path) -> Result<Ledger, LedgerError> {
        let begin = |number| Self::begin(number, &self.space.case(number));
        let mut ledger = Ledger::open(output, &self.head(), self.space.count(), &begin)?;
        ledger.complete(|case| self.row(case))?;
        Ok(ledger)
    }

    /// Computes the row of a case.
    fn row(&self, number: usize) -> Vec<String> {
        let case = self.space.case(number);
        let mut row = Self::begin(number, &case);
        let measured = case
            .errors(&self.arithmetics, self.class)
            .unwrap_or_else(|refusal| vec![Err(refusal); self.arithmetics.len()]);
        let mut problems = Vec::new();
        for measured in measured {
            match measured {
                Ok((error, status)) => {
                    row.extend([error.max, error.rms, error.bias].map(|e| format!("{e:.6}")));
                    row.push(engine::status_names(status));
                }
                Err(refusal) => {
                    row.extend([const { String::new() }; MEASURED.len()]);
                    problems.push(refusal);
                }
            }
        }
        problems.dedup();
        // One line per row, so that a truncated row is recognised.
        row.push(problems.join("; ").replace(['\n', '\r'], " "));
        row
    }

    /// The cases with the largest errors, worst first: for every arithmetic up to `most` without
    /// flags and up to `most` with flags.
    pub fn worst(&self, ledger: &Ledger, most: usize) -> Vec<Worst> {
        let first = Self::first_measured();
        let mut listed = Vec::new();
        for (index, &arithmetic) in self.arithmetics.iter().enumerate() {
            let at = first + index * MEASURED.len();
            let mut all: Vec<Worst> = ledger
                .rows()
                .filter_map(|(case, row)| {
                    let max_pct_f0 = row.get(at)?.parse().ok()?;
                    let status = row.get(at + MEASURED.len() - 1)?.to_owned();
                    Some(Worst { case, arithmetic, max_pct_f0, status })
                })
                .collect();
            // NaN sorts as the largest error.
            all.sort_by(|a, b| b.max_pct_f0.total_cmp(&a.max_pct_f0).then(a.case.cmp(&b.case)));
            for ok in [true, false] {
                listed.extend(
                    all.iter().filter(|worst| (worst.status == "ok") == ok).take(most).cloned(),
                );
            }
        }
        listed
    }
}
