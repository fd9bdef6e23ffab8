//! `vm verify`, the main job: every arithmetic against the reference, in six lines or row by row.

use super::{complain, print};
use crate::engine::Class;
use crate::markdown_table::markdown_table;
use crate::verify::{self, Report, Row};
use clap::Args;
use comfy_table::Table;
use std::error::Error;

#[derive(Debug, Default, Args)]
pub struct VerifyArgs {
    /// Print the rows as a JSON array instead of text.
    #[arg(long, conflicts_with = "all")]
    json: bool,
    /// Print every comparison, not only the worst of each mode and arithmetic.
    #[arg(long)]
    all: bool,
    /// Accuracy class.
    #[arg(long, value_enum, default_value_t)]
    class: Class,
}

/// Compares and prints the results; false if a comparison failed.
pub fn run(args: &VerifyArgs) -> Result<bool, Box<dyn Error>> {
    let report = verify::verify_class(args.class)?;
    if args.json {
        print(&serde_json::to_string_pretty(&report.rows)?)?;
    } else {
        if args.all {
            print(&table(&report))?;
        }
        print(&summary(&report))?;
    }
    for entry in &report.unused {
        complain(&format!("no row uses the tolerance {entry}"));
    }
    for row in report.rows.iter().filter(|row| !row.pass) {
        complain(&format!("{} {} {}: {}", row.scenario, row.mode, row.arithmetic, row.problem));
    }
    Ok(report.passed())
}

/// Modes of the summary: both discrete ones are one line.
const MODES: [&str; 3] = ["continuous", "fes", "discrete"];
/// Arithmetics of the summary: those for a target.
const ARITHMETICS: [&str; 2] = ["f32", "fixed"];

/// A heading, and a line per mode and arithmetic: the largest error at ticks of 1 ms with its
/// limit, whether all comparisons of that mode and arithmetic pass, and their run time.
fn summary(report: &Report) -> String {
    let failed = report.rows.iter().filter(|row| !row.pass).count();
    let verdict = if failed == 0 { "all pass".to_owned() } else { format!("{failed} FAIL") };
    let mut lines = vec![format!(
        "{} comparisons in {:.1} s: {verdict} (--all lists them); worst at 1 ms, % of F0:",
        report.rows.len(),
        report.seconds,
    )];
    for mode in MODES {
        for arithmetic in ARITHMETICS {
            let rows: Vec<&Row> = report
                .rows
                .iter()
                .filter(|row| row.mode.starts_with(mode) && row.arithmetic == arithmetic)
                .collect();
            let worst = rows
                .iter()
                .filter(|row| row.is_at_1_ms())
                .max_by(|a, b| a.max_pct_f0.total_cmp(&b.max_pct_f0));
            let Some(worst) = worst else { continue };
            lines.push(format!(
                "{mode:<11} {arithmetic:<6} {:<26} {:>7.4} of {:<6} %  {:<4} {:>6.2} s",
                worst.scenario,
                worst.max_pct_f0,
                worst.tolerance_pct_f0,
                if rows.iter().all(|row| row.pass) { "pass" } else { "FAIL" },
                rows.iter().map(|row| row.seconds).sum::<f64>(),
            ));
        }
    }
    lines.join("\n")
}

/// Every comparison.
fn table(report: &Report) -> Table {
    let header = [
        "scenario",
        "mode",
        "arithmetic",
        "against",
        "max % F0",
        "rms % F0",
        "bias % F0",
        "tolerance",
        "pass",
    ];
    let mut table = markdown_table(&header, 4..8);
    for row in &report.rows {
        table.add_row([
            row.scenario.clone(),
            row.mode.clone(),
            row.arithmetic.clone(),
            row.against.clone(),
            format!("{:.5}", row.max_pct_f0),
            format!("{:.5}", row.rms_pct_f0),
            format!("{:+.5}", row.bias_pct_f0),
            format!("{:.5}", row.tolerance_pct_f0),
            if row.pass { "yes" } else { "NO" }.to_owned(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scenario: &str, mode: &str, arithmetic: &str, max_pct_f0: f64) -> Row {
        Row {
            scenario: scenario.to_owned(),
            mode: mode.to_owned(),
            arithmetic: arithmetic.to_owned(),
            against: "reference".to_owned(),
            max_pct_f0,
            rms_pct_f0: 0.0,
            bias_pct_f0: 0.0,
            arithmetic_pct_f0: None,
            tolerance_pct_f0: 0.5,
            seconds: 0.25,
            pass: true,
            problem: String::new(),
            reason: String::new(),
        }
    }

    #[test]
    fn a_line_names_the_largest_error_at_1_ms_and_fails_with_any_row() {
        let bad = Row { pass: false, ..row("steps@2ms", "fes", "f32", 3.0) };
        let rows = vec![
            row("steps", "fes", "f32", 0.1),
            row("kinks", "fes", "f32", 0.3),
            bad,
            row("steps", "discrete-leff", "fixed", f64::NAN),
            row("kinks", "discrete", "fixed", 0.3),
        ];
        let report = Report { rows, unused: Vec::new(), traces: Vec::new(), seconds: 2.0 };
        let text = summary(&report);
        let words: Vec<Vec<&str>> =
            text.lines().map(|line| line.split_whitespace().collect()).collect();
        assert!(words[0].join(" ").starts_with("5 comparisons in 2.0 s: 1 FAIL (--all"), "{text}");
        assert_eq!(
            words[1],
            "fes f32 kinks 0.3000 of 0.5 % FAIL 0.75 s".split(' ').collect::<Vec<_>>()
        );
        // NaN counts as the largest error.
        assert_eq!(words[2][..4], ["discrete", "fixed", "steps", "NaN"]);
        assert_eq!(table(&report).row_iter().count(), 5);
    }
}
