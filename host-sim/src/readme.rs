//! The measured table in the README: made here, and compared with what is written there.

use crate::scenario::paper_muscle;
use crate::trace::{TraceError, write_atomically};
use crate::verify::{Report, Row};
use std::path::{Path, PathBuf};

/// Lines between which the README's table stands.
const BEGIN: &str = "<!-- measured: cargo vm readme --write -->";
const END: &str = "<!-- end of measured -->";

/// Why the README could not be compared or written.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// It could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// It has no place for the table.
    #[error("the README has no lines \"{BEGIN}\" and \"{END}\"")]
    NoPlace,
}

/// The table: f32 against the reference, and the reference against the vectors.
pub fn measured(report: &Report) -> String {
    let mut text = String::from(
        "| scenario | mode | max, 1 ms | rms, 1 ms | max, 0.5 ms | max, 2 ms | reference, N |\n\
         |---|---|---:|---:|---:|---:|---:|\n",
    );
    let row_of = |scenario: &str, mode: &str, arithmetic: &str| {
        report
            .rows
            .iter()
            .find(|r| r.scenario == scenario && r.mode == mode && r.arithmetic == arithmetic)
    };
    let newtons = paper_muscle().f0() / 100.0;
    let at_1_ms = |row: &&Row| row.arithmetic == "f32" && !row.scenario.contains('@');
    for row in report.rows.iter().filter(at_1_ms) {
        let max_at = |step: &str| {
            row_of(&format!("{}@{step}", row.scenario), &row.mode, "f32")
                .map_or("-".to_owned(), |other| format!("{:.4}", other.max_pct_f0))
        };
        let vector = row_of(&row.scenario, &row.mode, "reference");
        text.push_str(&format!(
            "| {} | {} | {:.4} | {:.4} | {} | {} | {} |\n",
            row.scenario,
            row.mode,
            row.max_pct_f0,
            row.rms_pct_f0,
            max_at("0.5ms"),
            max_at("2ms"),
            vector.map_or("-".to_owned(), |v| format!("{:.4}", v.max_pct_f0 * newtons)),
        ));
    }
    text
}

/// Whether the README's table is the one that is measured.
pub fn is_current(report: &Report) -> Result<bool, ReadmeError> {
    let text = read()?;
    Ok(with_table(&text, &measured(report))? == text)
}

/// Writes the measured table into the README.
pub fn write(report: &Report) -> Result<(), ReadmeError> {
    let text = with_table(&read()?, &measured(report))?;
    write_atomically(&path(), text.as_bytes())?;
    Ok(())
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")
}

fn read() -> Result<String, ReadmeError> {
    let path = path();
    std::fs::read_to_string(&path).map_err(|source| ReadmeError::Read { path, source })
}

fn with_table(text: &str, table: &str) -> Result<String, ReadmeError> {
    let (before, rest) = text.split_once(BEGIN).ok_or(ReadmeError::NoPlace)?;
    let (_, after) = rest.split_once(END).ok_or(ReadmeError::NoPlace)?;
    Ok(format!("{before}{BEGIN}\n\n{table}\n{END}{after}"))
}
