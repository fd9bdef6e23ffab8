//! Accuracy: every scenario in every arithmetic against the reference, and the reference against
//! the authors' traces.

use crate::engine::{self, Arithmetic, Class, RunError};
use crate::metrics::{ForceError, forces};
use crate::progress;
use crate::reference::Input;
use crate::scenario::{self, Scenario};
use crate::tolerance::{self, Tolerance};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Traces of the authors' program are compared after this time, s: it starts from an estimate of
/// the resting length.
const VECTOR_SETTLED: f64 = 0.1;
/// Largest ratio of a tolerance to the measured error.
const LOOSEST: f64 = 2.0;

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Scenario, with its time step if that is not 1 ms.
    pub scenario: String,
    /// Recruitment mode.
    pub mode: String,
    /// Arithmetic.
    pub arithmetic: String,
    /// Compared with: `reference` or `vector`.
    pub against: String,
    /// Largest absolute error of the tendon force, % of F0.
    pub max_pct_f0: f64,
    /// Root-mean-square error, % of F0.
    pub rms_pct_f0: f64,
    /// Mean error, % of F0.
    pub bias_pct_f0: f64,
    /// Largest difference from the same scheme in `f64`, % of F0: the effect of rounding and
    /// kernels.
    #[serde(skip)]
    pub arithmetic_pct_f0: Option<f64>,
    /// Tolerance of the largest error, % of F0.
    pub tolerance_pct_f0: f64,
    /// Run time, s.
    #[serde(skip)]
    pub seconds: f64,
    /// Whether the row passes.
    pub pass: bool,
    /// Why it does not pass.
    #[serde(skip)]
    pub problem: String,
    /// Cause of the error.
    #[serde(skip)]
    pub reason: String,
}

/// Result of `verify`.
#[derive(Clone, Debug)]
pub struct Report {
    /// One row per comparison.
    pub rows: Vec<Row>,
    /// Stale tolerances: no row uses them.
    pub unused: Vec<String>,
    /// Compared forces of the scenarios at 1 ms.
    pub traces: Vec<Traces>,
    /// Total run time, s.
    pub seconds: f64,
}

/// Forces of a scenario, N, one value per row of its inputs.
#[derive(Clone, Debug)]
pub struct Traces {
    /// Its name.
    pub scenario: String,
    /// Recruitment mode.
    pub mode: String,
    /// Time between rows, s.
    pub time_step: f64,
    /// F0, N.
    pub f0: f64,
    /// The inputs.
    pub inputs: Vec<Input>,
    /// Force of the reference.
    pub reference: Vec<f64>,
    /// Force of every arithmetic, with its name.
    pub computed: Vec<(&'static str, Vec<f64>)>,
}

impl Row {
    /// Whether the scenario runs at 1 ms.
    pub fn is_at_1_ms(&self) -> bool {
        !self.scenario.contains('@')
    }
}

impl Report {
    /// The row of a scenario, mode and arithmetic.
    pub fn row(&self, scenario: &str, mode: &str, arithmetic: &str) -> Option<&Row> {
        self.rows.iter().find(|row| {
            row.scenario == scenario && row.mode == mode && row.arithmetic == arithmetic
        })
    }

    /// Whether every row passed and every entry was used.
    pub fn passed(&self) -> bool {
        !self.rows.is_empty() && self.unused.is_empty() && self.rows.iter().all(|row| row.pass)
    }
}

/// Runs every comparison.
pub fn verify() -> Result<Report, RunError> {
    verify_class(Class::Standard)
}

/// Runs every comparison in an accuracy class. Only the standard class has a tolerance per row; the
/// others are checked against the promised limits only.
pub fn verify_class(class: Class) -> Result<Report, RunError> {
    let scenarios = scenario::all();
    let table = (class == Class::Standard).then(tolerance::table);
    let started = Instant::now();
    let progress = progress::bar("comparing scenarios", scenarios.len());
    let compared: Vec<(Vec<Row>, Traces)> = scenarios
        .par_iter()
        .map(|scenario| {
            let compared = compare(scenario, class, table.as_ref());
            progress.inc(1);
            compared
        })
        .collect::<Result<_, _>>()?;
    progress.finish_and_clear();
    let (rows, mut traces): (Vec<_>, Vec<_>) = compared.into_iter().unzip();
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    traces.retain(|traces| !traces.scenario.contains('@'));
    let unused = table
        .iter()
        .flat_map(BTreeMap::keys)
        .filter(|key| !rows.iter().any(|row| key_of(row) == **key))
        .map(|key| key.join(","))
        .collect();
    Ok(Report { rows, unused, traces, seconds: started.elapsed().as_secs_f64() })
}

fn key_of(row: &Row) -> tolerance::Key {
    [&row.scenario, &row.mode, &row.arithmetic, &row.against].map(Clone::clone)
}

/// All rows of one scenario, and its forces.
fn compare(
    scenario: &Scenario,
    class: Class,
    table: Option<&BTreeMap<tolerance::Key, Tolerance>>,
) -> Result<(Vec<Row>, Traces), RunError> {
    let run = |arithmetic| {
        let started = Instant::now();
        let Scenario { muscle, mode, trace, .. } = scenario;
        let rows = engine::run_in_class(muscle, *mode, arithmetic, class, trace)?;
        let seconds = started.elapsed().as_secs_f64();
        let flags = rows.iter().fold(vm_nostd::Status::empty(), |all, row| all | row.1);
        Ok::<_, RunError>((forces(rows.iter().map(|row| &row.0)), flags, seconds))
    };
    let f0 = scenario.muscle.f0();
    let (reference, _, seconds) = run(Arithmetic::Reference)?;
    let judge = |arithmetic: Arithmetic, against: &str, error, flags| {
        let key = [
            scenario.name.clone(),
            engine::mode_name(scenario.mode).to_owned(),
            arithmetic.name().to_owned(),
            against.to_owned(),
        ];
        judge(key, error, flags, (class, table), f0)
    };
    let mut rows = Vec::new();
    if let Some(vector) = &scenario.vector {
        let settled =
            (0..vector.len()).find(|&row| scenario.trace.time(row) > VECTOR_SETTLED).unwrap_or(0);
        let error = ForceError::between(&reference[settled..], &vector[settled..], f0);
        let row = judge(Arithmetic::Reference, "vector", error, Default::default());
        rows.push(Row { seconds, ..row });
    }
    let (scheme, scheme_flags, scheme_seconds) = run(Arithmetic::F64)?;
    let mut computed_forces = Vec::new();
    for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
        let (computed, flags, seconds) = run(arithmetic)?;
        let error = ForceError::between(&computed, &reference, f0);
        let row = judge(arithmetic, "reference", error, (flags, scenario.flags));
        let arithmetic_pct_f0 = Some(ForceError::between(&computed, &scheme, f0).max);
        rows.push(Row { arithmetic_pct_f0, seconds, ..row });
        computed_forces.push((arithmetic.name(), computed));
    }
    let error = ForceError::between(&scheme, &reference, f0);
    let row = judge(Arithmetic::F64, "reference", error, (scheme_flags, scenario.flags));
    rows.push(Row { seconds: scheme_seconds, ..row });
    computed_forces.push((Arithmetic::F64.name(), scheme));
    let traces = Traces {
        scenario: scenario.name.clone(),
        mode: engine::mode_name(scenario.mode).to_owned(),
        time_step: scenario.trace.time_step,
        f0,
        inputs: scenario.trace.inputs.clone(),
        reference,
        computed: computed_forces,
    };
    Ok((rows, traces))
}

fn judge(
    key: tolerance::Key,
    error: ForceError,
    (flags, expected_flags): (vm_nostd::Status, vm_nostd::Status),
    (class, table): (Class, Option<&BTreeMap<tolerance::Key, Tolerance>>),
    f0: f64,
) -> Row {
    let entry = table.and_then(|table| table.get(&key));
    let (promised, promised_rms) = tolerance::promise(&key, class, f0);
    let mut problems = Vec::new();
    let limit = |found: f64, most: f64, what: &str, problems: &mut Vec<String>| {
        if found > most || found.is_nan() {
            problems.push(format!("{what} {found:.5} > {most:.5}"));
        }
    };
    limit(error.max, promised, "max", &mut problems);
    if let Some(most) = promised_rms {
        limit(error.rms, most, "rms", &mut problems);
    }
    match entry {
        None if table.is_none() => {}
        None => problems.push("no tolerance in data/tolerances.csv".to_owned()),
        Some(entry) => {
            limit(error.max, entry.max, "max", &mut problems);
            limit(
                entry.max,
                LOOSEST * error.max,
                "stale tolerance: limit over twice the error:",
                &mut problems,
            );
            if let Some(rms) = entry.rms {
                limit(error.rms, rms, "rms", &mut problems);
                limit(
                    rms,
                    LOOSEST * error.rms,
                    "stale rms tolerance: limit over twice the error:",
                    &mut problems,
                );
            }
        }
    }
    if flags != expected_flags {
        problems.push(format!("flagged {}", engine::status_names(flags)));
    }
    let [scenario, mode, arithmetic, against] = key;
    Row {
        scenario,
        mode,
        arithmetic,
        against,
        max_pct_f0: error.max,
        rms_pct_f0: error.rms,
        bias_pct_f0: error.bias,
        arithmetic_pct_f0: None,
        seconds: 0.0,
        tolerance_pct_f0: entry.map_or(promised, |entry| entry.max),
        pass: problems.is_empty(),
        problem: problems.join("; "),
        reason: entry.map_or(String::new(), |entry| entry.reason.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a row passes with an error and a tolerance.
    fn passes(max: f64, tolerance: Option<f64>) -> bool {
        let key = ["steps", "fes", "f32", "reference"].map(str::to_owned);
        let entry = |max| Tolerance { max, rms: None, reason: "a reason".to_owned() };
        let table = tolerance.map(|max| (key.clone(), entry(max))).into_iter().collect();
        let error = ForceError { max, rms: 0.0, bias: 0.0 };
        judge(key, error, Default::default(), (Class::Standard, Some(&table)), 266.0).pass
    }

    #[test]
    fn a_row_passes_between_half_its_tolerance_and_its_tolerance() {
        assert!(passes(0.04, Some(0.05)));
        assert!(!passes(0.051, Some(0.05)), "an error beyond the tolerance");
        assert!(!passes(0.024, Some(0.05)), "a tolerance looser than twice the error");
        assert!(!passes(0.11, Some(0.12)), "beyond the promised limit");
        assert!(!passes(0.04, None), "no entry");
        assert!(!passes(f64::NAN, Some(0.05)), "not a number");
    }
}
