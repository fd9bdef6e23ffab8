//! All measurements in one HTML file that needs no network.

use crate::chart::{Chart, Line, Panel, Point};
use crate::closed_loop::{self, Kind, Study, StudyError, Task};
use crate::cycles;
use crate::engine::{Arithmetic, Class, RunError};
use crate::figures::{Claim, Figures, FiguresError};
use crate::golden::{self, Golden, GoldenError};
use crate::provenance::Provenance;
use crate::scenario;
use crate::tolerance;
use crate::verify::{self, Row, Traces};
use askama::Template;
use std::path::{Path, PathBuf};

/// Why the report could not be made.
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
        /// The system's error.
        source: std::io::Error,
    },
    /// The budgets could not be read.
    #[error("data/budgets.toml: {0}")]
    Budgets(#[from] toml::de::Error),
    /// The file of cycles could not be parsed.
    #[error("{}: not the output of cargo vm cycles --json: {source}", path.display())]
    Cycles {
        /// The file.
        path: PathBuf,
        /// The parser's error.
        source: serde_json::Error,
    },
    /// The closed loop could not be run.
    #[error(transparent)]
    ClosedLoop(#[from] StudyError),
    /// The template failed.
    #[error(transparent)]
    Page(#[from] askama::Error),
}

/// A card with a number.
struct Fact {
    value: String,
    what: String,
    /// Whether it is within its limit.
    good: bool,
}

/// A row of the summary table.
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
    provenance: Provenance,
    facts: Vec<Fact>,
    accuracy: Vec<Accuracy<'a>>,
    rows: &'a [Row],
    errors: Vec<Plot>,
    figures: Vec<Plot>,
    claims: Vec<Claim>,
    closed_loop: String,
    cycles: Vec<cycles::Row>,
    golden: Golden,
    differences: Vec<String>,
}

/// The figures in the paper's order, with their captions.
const FIGURES: [(&str, &str); 6] = [
    ("arm.svg", "Figure 3: an arm with and without effective length"),
    ("static_force.svg", "Figure 4: steady force"),
    ("static_force_start.svg", "Figure 4: where recruitment starts"),
    ("sinusoid_responses.svg", "Figure 5: responses to sinusoids"),
    ("sinusoids.svg", "Figures 5 and 6: sinusoids of all frequencies"),
    ("computation.svg", "Figure 7: cost of motor units"),
];

/// Makes the page; `cycles` is the output of `vm cycles --json`.
pub fn page(cycles: Option<&Path>) -> Result<String, ReportError> {
    let cycles = cycles.map_or_else(|| Ok(Vec::new()), read_cycles)?;
    let report = verify::verify()?;
    let drawn = Figures::draw(Arithmetic::F32)?;
    let figures = FIGURES
        .into_iter()
        .map(|(name, title)| Plot {
            title: title.to_owned(),
            svg: drawn.file(name).unwrap_or_default().to_owned(),
        })
        .collect();
    let claims = drawn.claims;
    let differences = golden::differences()?;
    let page = Page {
        provenance: Provenance::now(),
        facts: facts(&report.rows, &claims, &differences, &cycles)?,
        accuracy: accuracy(&report),
        rows: &report.rows,
        errors: report.traces.iter().map(plot).collect(),
        figures,
        claims,
        closed_loop: untuned_loop()?,
        cycles,
        golden: golden::committed()?,
        differences,
    };
    Ok(page.render()?)
}

/// One patient's reach under every controller, as they are before tuning, which takes minutes.
fn untuned_loop() -> Result<String, StudyError> {
    let task = Task::ElbowReach;
    let (tasks, controllers) = (vec![task], Kind::ALL.to_vec());
    let study = Study { tasks, controllers, patients: 1, tuning_patients: 1, evaluations: 1 };
    Ok(closed_loop::picture(task, &closed_loop::run(&study)?)?)
}

fn read_cycles(path: &Path) -> Result<Vec<cycles::Row>, ReportError> {
    let file = |source| ReportError::File { path: path.to_owned(), source };
    let text = std::fs::read_to_string(path).map_err(file)?;
    serde_json::from_str(&text)
        .map_err(|source| ReportError::Cycles { path: path.to_owned(), source })
}

/// The scenario with the largest error at 1 kHz.
fn worst<'a>(rows: &'a [Row], arithmetic: &str, ringing: bool) -> Option<&'a Row> {
    let relevant = rows.iter().filter(|row| {
        (row.arithmetic == arithmetic && row.is_at_1_ms())
            && (ringing || !tolerance::rings(&row.scenario))
    });
    relevant.max_by(|a, b| a.max_pct_f0.total_cmp(&b.max_pct_f0))
}

/// Largest error in an arithmetic, against the promise for such scenarios.
fn error_fact(row: &Row, what: &str, f0: f64) -> Fact {
    let key = [&row.scenario, &row.mode, &row.arithmetic, &row.against].map(Clone::clone);
    let (promised, _) = tolerance::promise(&key, Class::Standard, f0);
    Fact {
        value: format!("{:.3} %", row.max_pct_f0),
        what: format!(
            "of F0 (limit {promised} %): largest error in {} at 1 kHz, {what}: {}, {}",
            row.arithmetic, row.scenario, row.mode
        ),
        good: row.max_pct_f0 <= promised,
    }
}

fn facts(
    rows: &[Row],
    claims: &[Claim],
    differences: &[String],
    cycles: &[cycles::Row],
) -> Result<Vec<Fact>, ReportError> {
    let passed = rows.iter().filter(|row| row.pass).count();
    let agreed = claims.iter().filter(|claim| claim.agrees).count();
    let mut facts = vec![Fact {
        value: format!("{passed} of {}", rows.len()),
        what: "comparisons within their tolerances".to_owned(),
        good: passed == rows.len(),
    }];
    let f0 = scenario::paper_muscle().f0();
    for arithmetic in ["f32", "fixed"] {
        for (ringing, what) in [(true, "all scenarios"), (false, "where the tendon does not ring")]
        {
            facts.extend(worst(rows, arithmetic, ringing).map(|row| error_fact(row, what, f0)));
        }
    }
    facts.push(Fact {
        value: if differences.is_empty() { "same" } else { "changed" }.to_owned(),
        what: "golden bits".to_owned(),
        good: differences.is_empty(),
    });
    facts.push(Fact {
        value: format!("{agreed} of {}", claims.len()),
        what: "claims of the paper reproduced".to_owned(),
        good: agreed == claims.len(),
    });
    for case in ["continuous-f32", "continuous-fixed"] {
        let Some((bytes, most)) = cycles::state_bytes(case)? else { continue };
        facts.push(Fact {
            value: format!("{bytes} B"),
            what: format!("of state of a muscle of two types, {case} (budget {most} B)"),
            good: bytes <= most,
        });
    }
    for row in cycles.iter().filter(|row| row.case == "continuous-f32") {
        let budget = row.budget.map_or(String::new(), |budget| format!(" (budget {budget})"));
        facts.push(Fact {
            value: row.cycles_pess_max.to_string(),
            what: format!("cycles in the most expensive tick in f32 on a Cortex-M4F{budget}"),
            good: row.pass,
        });
    }
    Ok(facts)
}

/// A line per scenario at 1 ms.
fn accuracy<'a>(report: &'a verify::Report) -> Vec<Accuracy<'a>> {
    let line = |traces: &'a Traces| {
        let of = |arithmetic: &str| report.row(&traces.scenario, &traces.mode, arithmetic);
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
    report.traces.iter().map(line).collect()
}

/// Inputs, force and errors of a scenario over time.
fn plot(traces: &Traces) -> Plot {
    let line = |name: &str, values: &mut dyn Iterator<Item = f64>| {
        let over_time =
            |(row, value): (usize, f64)| -> Point { (row as f64 * traces.time_step, value) };
        Line::new(name, values.enumerate().map(over_time))
    };
    // Truncation error drawn first, rounding on top of it.
    let errors = traces.computed.iter().rev().map(|(name, forces)| {
        let pairs = forces.iter().zip(&traces.reference);
        let mut errors = pairs.map(|(force, reference)| 100.0 * (force - reference) / traces.f0);
        line(name, &mut errors)
    });
    let mut inputs = [
        ("U (1)", line("", &mut traces.inputs.iter().map(|input| input.activation))),
        ("L_mt (cm)", line("", &mut traces.inputs.iter().map(|input| 100.0 * input.path_length))),
    ]
    .map(|(y, line)| Panel::input(y, vec![line]))
    .to_vec();
    if traces.mode == "fes" {
        let mut frequencies = traces.inputs.iter().map(|input| input.stimulation_frequency);
        inputs.push(Panel::input("stimulation (pps)", vec![line("", &mut frequencies)]));
    }
    let force = line("", &mut traces.reference.iter().copied());
    inputs.push(Panel::new("force (N)", vec![force]));
    inputs.push(Panel::new("error (% of F0)", errors.collect()));
    let title = format!("{}, {}", traces.scenario, traces.mode);
    let svg = Chart { title: &title, x: "time (s)", panels: inputs }.draw();
    Plot { title, svg }
}
