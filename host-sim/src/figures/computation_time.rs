//! Figure 7: what the modes cost by the number of motor units, relative to continuous recruitment, on
//! this machine and in one run.

use super::{Case, FiguresError, Folder, PATH, TIME_STEP};
use crate::chart::{Chart, Panel};
use crate::engine::{self, Arithmetic, RunError};
use crate::reference::{Input, Mode};
use crate::scenario::{paper_muscle, paper_muscle_of_units};
use crate::trace::InputTrace;
use serde::Serialize;
use std::time::Instant;

const UNITS: [usize; 6] = [1, 3, 5, 10, 20, 30];
/// As long as the simulation that the paper timed, s.
const DURATION: f64 = 2.0;
/// Machines are noisy: the fastest of so many runs counts.
const RUNS: usize = 5;

/// What so many motor units of each type cost, relative to continuous recruitment.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) units_per_type: usize,
    pub(super) discrete: f64,
    pub(super) effective_length: f64,
}

fn seconds(case: &Case) -> Result<f64, RunError> {
    let inputs = (0..=(DURATION / TIME_STEP) as u32)
        .map(|tick| Input {
            activation: 0.5 - 0.5 * libm::cos(f64::from(tick) * 0.02),
            path_length: PATH,
            stimulation_frequency: 0.0,
        })
        .collect();
    let trace = InputTrace { start: 0.0, time_step: TIME_STEP, inputs };
    let mut fastest = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        std::hint::black_box(engine::run(&case.muscle, case.mode, Arithmetic::F32, &trace)?);
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    Ok(fastest)
}

pub(super) fn make(folder: &Folder<'_>) -> Result<Vec<Row>, FiguresError> {
    let case = |mode, muscle| Case { name: "", mode, muscle };
    let continuous = seconds(&case(Mode::Continuous, paper_muscle()))?;
    let mut rows = Vec::new();
    for units in UNITS {
        let ratio =
            |mode| seconds(&case(mode, paper_muscle_of_units(units))).map(|s| s / continuous);
        rows.push(Row {
            units_per_type: units,
            discrete: ratio(Mode::Discrete)?,
            effective_length: ratio(Mode::DiscreteEffectiveLength)?,
        });
    }
    folder.table("computation_time.csv", &rows)?;
    let line = |name: &str, value: fn(&Row) -> f64| {
        (name.to_owned(), rows.iter().map(|row| (row.units_per_type as f64, value(row))).collect())
    };
    let panel = Panel {
        y: "time over that of continuous (1)",
        lines: vec![
            line("discrete", |row| row.discrete),
            line("discrete, effective length", |row| row.effective_length),
        ],
    };
    let title = "Computation time by motor units, in f32 on this machine";
    let chart = Chart { title, x: "motor units per type", panels: vec![panel] };
    folder.figure("computation_time.svg", &chart)?;
    Ok(rows)
}
