//! Many muscles and many inputs: every arithmetic against the reference, on all cores, into a table
//! that can be gone on with after an interruption.

mod case;
mod keys;
mod space;

pub use case::{Case, Measured};
pub use keys::{KEYS, Key};
pub use space::{Space, SpaceError, Variation};

use crate::engine::{self, Arithmetic, Class};
use crate::golden;
use crate::ledger::{Ledger, LedgerError};
use std::path::Path;

/// What is swept, and in what it is computed.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The muscles and inputs.
    pub space: Space,
    /// What each is computed in, besides the reference.
    pub arithmetics: Vec<Arithmetic>,
    /// Accuracy class.
    pub class: Class,
    /// The arguments of `vm sweep` that name all this.
    pub arguments: String,
}

/// One of the worst cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Its number.
    pub case: usize,
    /// What it was computed in.
    pub arithmetic: Arithmetic,
    /// Largest error, % of F0.
    pub max_pct_f0: f64,
    /// Flags that were set on the way.
    pub status: String,
}

/// Columns of an arithmetic.
const MEASURED: [&str; 4] = ["max_pct_f0", "rms_pct_f0", "bias_pct_f0", "status"];

impl Sweep {
    /// The first two lines of the table: what made it, and its columns.
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

    /// What a case's row begins with.
    fn begin(number: usize, case: &Case) -> Vec<String> {
        let mut row = vec![number.to_string(), engine::mode_name(case.mode).to_owned()];
        row.extend(case.values.iter().map(f64::to_string));
        row
    }

    /// Computes what is not in the table yet. When all is, the table is put in order, so that it
    /// has the same bytes however often it was interrupted.
    pub fn run(&self, output: &Path) -> Result<Ledger, LedgerError> {
        let begin = |number| Self::begin(number, &self.space.case(number));
        let mut ledger = Ledger::open(output, &self.head(), self.space.count(), &begin)?;
        ledger.complete(|case| self.row(case))?;
        Ok(ledger)
    }

    /// A case as a row of the table.
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
        // A row is a line, or it could be torn without its being seen.
        row.push(problems.join("; ").replace(['\n', '\r'], " "));
        row
    }

    /// The worst cases of a table, worst first: `most` of every arithmetic, of those that had
    /// nothing to flag, and as many of the others.
    pub fn worst(&self, ledger: &Ledger, most: usize) -> Vec<Worst> {
        let first = 2 + KEYS.len();
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
            // Not-a-number is worst of all.
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
