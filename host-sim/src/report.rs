//! All that is measured, in one HTML file that needs no network.

use crate::chart::{Chart, Panel, Point};
use crate::cycles;
use crate::engine::{Arithmetic, RunError};
use crate::figures::{self, Claim, FiguresError};
use crate::golden::{self, Golden, GoldenError};
use crate::output_file::temporary_folder;
use crate::verify::{self, Row, Traces};
use askama::Template;
use std::path::{Path, PathBuf};
use vm_nostd::{Fixed, NaturalContinuous, Scalar, State};

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A scenario could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The figures could not be made.
    #[error(transparent)]
    Figures(#[from] FiguresError),
    /// The golden bits could not be compared.
    #[error(transparent)]
    Golden(#[from] GoldenError),
    /// A file could not be read or made.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// No temporary folder could be made.
    #[error("the figures' folder: {0}")]
    Folder(std::io::Error),
    /// What was measured of cycles cannot be read.
    #[error("{}: not what cargo vm cycles --json prints: {source}", path.display())]
    Cycles {
        /// The file.
        path: PathBuf,
        /// Where, and why.
        source: serde_json::Error,
    },
    /// A plot could not be drawn.
    #[error("a plot could not be drawn: {0}")]
    Draw(String),
    /// The page could not be put together.
    #[error(transparent)]
    Page(#[from] askama::Error),
}

/// A number to begin with.
struct Fact {
    value: String,
    what: &'static str,
    good: bool,
}

/// A row of the table to look at first.
struct Accuracy<'a> {
    scenario: &'a str,
    mode: &'a str,
    cells: [String; 5],
}

/// A picture.
struct Plot {
    title: String,
    svg: String,
}

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    version: &'static str,
    facts: Vec<Fact>,
    accuracy: Vec<Accuracy<'a>>,
    rows: &'a [Row],
    errors: Vec<Plot>,
    figures: Vec<Plot>,
    claims: Vec<Claim>,
    cycles: Vec<cycles::Row>,
    golden: Golden,
    differences: Vec<String>,
}

/// The figures, in the order of the paper, and what they show.
const FIGURES: [(&str, &str); 6] = [
    ("arm.svg", "Figure 3: an arm with and without effective length"),
    ("static_force.svg", "Figure 4: steady force"),
    ("static_force_start.svg", "Figure 4: where recruitment starts"),
    ("sinusoid_responses.svg", "Figure 5: responses to sinusoids"),
    ("sinusoids.svg", "Figures 5 and 6: sinusoids of all frequencies"),
    ("computation_time.svg", "Figure 7: computation time"),
];

/// Measures all there is, and puts it in one page; `cycles` is what `vm cycles --json` printed.
pub fn page(cycles: Option<&Path>) -> Result<String, ReportError> {
    let cycles = cycles.map_or_else(|| Ok(Vec::new()), read_cycles)?;
    let report = verify::verify()?;
    let folder = temporary_folder().map_err(ReportError::Folder)?;
    let claims = figures::make(folder.path(), Arithmetic::F32)?;
    let figures = FIGURES
        .into_iter()
        .map(|(name, title)| {
            let path = folder.path().join(name);
            let svg = std::fs::read_to_string(&path)
                .map_err(|source| ReportError::File { path, source })?;
            Ok(Plot { title: title.to_owned(), svg })
        })
        .collect::<Result<_, ReportError>>()?;
    let differences = golden::differences()?;
    let page = Page {
        version: env!("CARGO_PKG_VERSION"),
        facts: facts(&report.rows, &claims, &differences, &cycles),
        accuracy: accuracy(&report.rows, &report.traces),
        rows: &report.rows,
        errors: report.traces.iter().map(plot).collect::<Result<_, _>>()?,
        figures,
        claims,
        cycles,
        golden: golden::committed()?,
        differences,
    };
    Ok(page.render()?)
}

fn read_cycles(path: &Path) -> Result<Vec<cycles::Row>, ReportError> {
    let file = |source| ReportError::File { path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(file)?;
    serde_json::from_str(&text)
        .map_err(|source| ReportError::Cycles { path: path.to_owned(), source })
}

fn facts(
    rows: &[Row],
    claims: &[Claim],
    differences: &[String],
    cycles: &[cycles::Row],
) -> Vec<Fact> {
    let passed = rows.iter().filter(|row| row.pass).count();
    let agreed = claims.iter().filter(|claim| claim.agrees).count();
    // At 1 ms, and where no slack tendon snaps.
    let largest = |arithmetic: &str| {
        let of_interest = rows.iter().filter(|row| {
            (row.arithmetic == arithmetic && !row.scenario.contains('@'))
                && !["passive_length_3hz", "velocity_kinks"].contains(&row.scenario.as_str())
        });
        of_interest.map(|row| row.max_pct_f0).fold(0.0, f64::max)
    };
    let mut facts = vec![
        Fact {
            value: format!("{passed} of {}", rows.len()),
            what: "comparisons within their tolerances",
            good: passed == rows.len(),
        },
        Fact {
            value: format!("{:.3} %", largest("f32")),
            what: "of F0: largest error in f32 at 1 kHz, where no slack tendon snaps",
            good: largest("f32") <= 0.1,
        },
        Fact {
            value: format!("{:.3} %", largest("fixed")),
            what: "of F0: the same in fixed point",
            good: largest("fixed") <= 0.1,
        },
        Fact {
            value: if differences.is_empty() { "same" } else { "changed" }.to_owned(),
            what: "bits as committed",
            good: differences.is_empty(),
        },
        Fact {
            value: format!("{agreed} of {}", claims.len()),
            what: "claims of the paper found again",
            good: true,
        },
    ];
    facts.push(Fact {
        value: format!("{} and {} B", state_bytes::<f32>(), state_bytes::<Fixed>()),
        what: "of state of a muscle of two types, in f32 and in fixed point",
        good: true,
    });
    let named = |name| cycles.iter().find(|row: &&cycles::Row| row.case == name);
    if let Some(row) = named("continuous-f32") {
        facts.push(Fact {
            value: row.cycles_pess_max.to_string(),
            what: "cycles at most for a tick in f32 on a Cortex-M4F",
            good: row.pass,
        });
    }
    facts
}

/// Bytes of the state of a muscle of two types under natural continuous recruitment.
fn state_bytes<S: Scalar<Bits = u32>>() -> usize {
    size_of::<S::Bits>() * State::<S, NaturalContinuous, 2>::WORDS
}

/// A line per scenario at 1 ms.
fn accuracy<'a>(rows: &'a [Row], traces: &'a [Traces]) -> Vec<Accuracy<'a>> {
    let line = |traces: &'a Traces| {
        let of = |arithmetic: &str| {
            rows.iter().find(|row| {
                (row.scenario == traces.scenario && row.mode == traces.mode)
                    && row.arithmetic == arithmetic
            })
        };
        let cell = |arithmetic: &str, value: fn(&Row) -> f64| {
            of(arithmetic).map_or("-".to_owned(), |row| format!("{:.4}", value(row)))
        };
        let newtons = of("reference")
            .map_or("-".to_owned(), |row| format!("{:.4}", row.max_pct_f0 * traces.f0 / 100.0));
        Accuracy {
            scenario: &traces.scenario,
            mode: &traces.mode,
            cells: [
                cell("f32", |row| row.max_pct_f0),
                cell("f32", |row| row.rms_pct_f0),
                cell("fixed", |row| row.max_pct_f0),
                cell("fixed", |row| row.rms_pct_f0),
                newtons,
            ],
        }
    };
    traces.iter().map(line).collect()
}

/// Force and errors of a scenario over time.
fn plot(traces: &Traces) -> Result<Plot, ReportError> {
    let over_time = |values: &mut dyn Iterator<Item = f64>| -> Vec<Point> {
        values.enumerate().map(|(row, value)| (row as f64 * traces.time_step, value)).collect()
    };
    // The scheme's own error below, what rounding makes of it on top.
    let errors = traces.computed.iter().rev().map(|(name, forces)| {
        let pairs = forces.iter().zip(&traces.reference);
        let mut errors = pairs.map(|(force, reference)| 100.0 * (force - reference) / traces.f0);
        ((*name).to_owned(), over_time(&mut errors))
    });
    let force = over_time(&mut traces.reference.iter().copied());
    let title = format!("{}, {}", traces.scenario, traces.mode);
    let chart = Chart {
        title: &title,
        x: "time (s)",
        panels: vec![
            Panel { y: "force (N)", lines: vec![("reference".to_owned(), force)] },
            Panel { y: "error (% of F0)", lines: errors.collect() },
        ],
    };
    let svg = chart.draw().map_err(ReportError::Draw)?;
    Ok(Plot { title, svg })
}
