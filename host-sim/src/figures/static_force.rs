//! Figure 4: steady force by activation, full and where recruitment starts.

use super::{Case, FiguresError, Folder, PATH, TIME_STEP, cases};
use crate::chart::{Chart, Panel};
use crate::engine::{self, Arithmetic, RunError};
use crate::reference::Input;
use crate::trace::InputTrace;
use rayon::prelude::*;
use serde::Serialize;

/// A force is steady after this many seconds, as in the authors' table.
const STEADY: f64 = 3.0;
const STEPS: u32 = 100;
/// Activation up to which the start is shown.
const ZOOM: f64 = 0.2;

/// Steady force (N) at an activation.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) activation: f64,
    pub(super) continuous_n: f64,
    pub(super) discrete_3_n: f64,
    pub(super) discrete_30_n: f64,
}

fn steady_force(case: &Case, arithmetic: Arithmetic, activation: f64) -> Result<f64, RunError> {
    let input = Input { activation, path_length: PATH, stimulation_frequency: 0.0 };
    let inputs = vec![input; (STEADY / TIME_STEP) as usize + 1];
    let trace = InputTrace { start: 0.0, time_step: TIME_STEP, inputs };
    let rows = engine::run(&case.muscle, case.mode, arithmetic, &trace)?;
    Ok(rows.last().map_or(f64::NAN, |row| row.0.force))
}

pub(super) fn make(folder: &Folder<'_>, arithmetic: Arithmetic) -> Result<Vec<Row>, FiguresError> {
    let cases = cases();
    let rows: Vec<Row> = (0..=STEPS)
        .into_par_iter()
        .map(|step| {
            let activation = f64::from(step) / f64::from(STEPS);
            let force = |case| steady_force(case, arithmetic, activation);
            let [continuous_n, discrete_3_n, discrete_30_n] =
                [force(&cases[0])?, force(&cases[1])?, force(&cases[2])?];
            Ok(Row { activation, continuous_n, discrete_3_n, discrete_30_n })
        })
        .collect::<Result<_, RunError>>()?;
    folder.table("static_force.csv", &rows)?;
    let panel = |most: f64| {
        let line = |name: &str, force: fn(&Row) -> f64| {
            let shown = rows.iter().filter(|row| row.activation <= most);
            (name.to_owned(), shown.map(|row| (row.activation, force(row))).collect())
        };
        Panel {
            y: "steady tendon force (N)",
            lines: vec![
                line(cases[0].name, |row| row.continuous_n),
                line(cases[1].name, |row| row.discrete_3_n),
                line(cases[2].name, |row| row.discrete_30_n),
            ],
        }
    };
    for (name, title, most) in [
        ("static_force.svg", "Steady force by activation, path 16 cm", 1.0),
        ("static_force_start.svg", "The same where recruitment starts", ZOOM),
    ] {
        let chart = Chart { title, x: "activation U (1)", panels: vec![panel(most)] };
        folder.figure(name, &chart)?;
    }
    Ok(rows)
}

/// The first force (N) at which the 3 + 3 units have more than the passive force: the step with which
/// the first of them is recruited.
pub(super) fn first_step(rows: &[Row]) -> f64 {
    let passive = rows.first().map_or(f64::NAN, |row| row.discrete_3_n);
    let recruited = rows.iter().find(|row| row.discrete_3_n > passive + 1.0);
    recruited.map_or(f64::NAN, |row| row.discrete_3_n - passive)
}
