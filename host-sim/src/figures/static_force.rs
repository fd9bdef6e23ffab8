//! Figure 4: steady force by activation, over the full range and at the start of recruitment.

use super::files::{Figures, FiguresError};
use super::setting::{Case, PATH, TIME_STEP, cases};
use crate::chart::{Chart, Line, Panel, Point};
use crate::engine::{self, Arithmetic, RunError};
use crate::reference::{Input, Mode, Muscle};
use crate::trace::InputTrace;
use rayon::prelude::*;
use serde::Serialize;

/// Settling time of a force, as in the authors' table, s.
const STEADY: f64 = 3.0;
const STEPS: u32 = 100;
/// Largest activation of figure 4(b).
const ZOOM: f64 = 0.3;
/// Distance from a recruitment threshold, above the rounding of any arithmetic.
const BESIDE: f64 = 1e-6;
/// No unit is recruited below this activation.
const LEAST_THRESHOLD: f64 = 0.001;

/// Steady forces of the authors' own program (N): activation, then the cases in their order.
const AUTHORS: [[f64; 4]; 11] = [
    [0.05, 5.244, 0.307, 5.938],
    [0.1, 10.905, 0.307, 11.855],
    [0.2, 23.876, 16.061, 25.549],
    [0.3, 38.403, 37.293, 41.896],
    [0.4, 53.929, 42.511, 59.156],
    [0.5, 68.993, 70.776, 77.675],
    [0.6, 84.388, 89.337, 96.941],
    [0.7, 103.551, 111.894, 119.096],
    [0.8, 123.752, 137.049, 143.575],
    [0.9, 143.822, 157.451, 159.204],
    [1.0, 163.384, 165.026, 165.026],
];

/// Steady force (N) at an activation.
#[derive(Clone, Debug, Serialize)]
struct Row {
    activation: f64,
    continuous_n: f64,
    discrete_3_n: f64,
    discrete_30_n: f64,
}

/// Steady force (N) below and above the threshold of a motor unit.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Step {
    units_per_type: usize,
    /// Recruitment threshold (activation).
    threshold: f64,
    below_n: f64,
    pub(super) above_n: f64,
}

fn steady_force(case: &Case, arithmetic: Arithmetic, activation: f64) -> Result<f64, RunError> {
    let input = Input { activation, path_length: PATH, stimulation_frequency: 0.0 };
    let inputs = vec![input; (STEADY / TIME_STEP) as usize + 1];
    let trace = InputTrace { start: 0.0, time_step: TIME_STEP, inputs };
    let rows = engine::run(&case.muscle, case.mode, arithmetic, &trace)?;
    Ok(rows.last().map_or(f64::NAN, |row| row.0.force))
}

/// The recruitment thresholds of a muscle's motor units: U_r times the cumulative PCSA, unit by
/// unit.
fn thresholds(muscle: &Muscle) -> Vec<f64> {
    let shares = muscle.fibers.iter().flat_map(|fiber| {
        let all: f64 = fiber.units.iter().sum();
        fiber.units.iter().map(move |unit| fiber.fraction * unit / all)
    });
    let mut cumulative = 0.0;
    shares
        .map(|share| {
            cumulative += share;
            (muscle.U_r * cumulative).max(LEAST_THRESHOLD)
        })
        .collect()
}

fn steps(case: &Case, arithmetic: Arithmetic) -> Result<Vec<Step>, RunError> {
    thresholds(&case.muscle)
        .into_par_iter()
        .map(|threshold| {
            Ok(Step {
                units_per_type: case.muscle.fibers[0].units.len(),
                threshold,
                below_n: steady_force(case, arithmetic, threshold - BESIDE)?,
                above_n: steady_force(case, arithmetic, (threshold + BESIDE).min(1.0))?,
            })
        })
        .collect()
}

/// Step of force (N) at the recruitment of the first of 3 + 3 units.
pub(super) fn make(figures: &mut Figures, arithmetic: Arithmetic) -> Result<f64, FiguresError> {
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
    figures.table("static_force.csv", &rows)?;
    let discrete = cases.iter().filter(|case| case.mode == Mode::Discrete);
    let steps: Vec<Vec<Step>> =
        discrete.map(|case| steps(case, arithmetic)).collect::<Result<_, _>>()?;
    figures.table("static_force_steps.csv", &steps.concat())?;

    let forces: [fn(&Row) -> f64; 3] =
        [|row| row.continuous_n, |row| row.discrete_3_n, |row| row.discrete_30_n];
    let lines: Vec<Vec<Point>> = forces
        .iter()
        .enumerate()
        .map(|(index, force)| {
            let mut points: Vec<Point> =
                rows.iter().map(|row| (row.activation, force(row))).collect();
            let of_case = index.checked_sub(1).map_or(&[][..], |index| &steps[index]);
            // Both at the threshold, so that a step is vertical.
            points.extend(of_case.iter().flat_map(|step| {
                [(step.threshold - 1e-12, step.below_n), (step.threshold, step.above_n)]
            }));
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points
        })
        .collect();
    for (name, title, most) in [
        ("static_force.svg", "Figure 4(a): steady force by activation, path 16 cm", 1.0),
        ("static_force_start.svg", "Figure 4(b): where recruitment starts", ZOOM),
    ] {
        let shown = |points: &[Point]| {
            points.iter().copied().filter(|point| point.0 <= most).collect::<Vec<_>>()
        };
        let curves = cases.iter().zip(&lines);
        let mut drawn: Vec<Line> =
            curves.map(|(case, points)| Line::new(case.name, shown(points))).collect();
        for case in 1..=3 {
            let points: Vec<Point> = AUTHORS.iter().map(|row| (row[0], row[case])).collect();
            let label = if case == 1 { "authors' program (circles)" } else { "" };
            drawn.push(Line::marks(label, shown(&points)));
        }
        let panels = vec![Panel::new("steady tendon force (N)", drawn)];
        figures.figure(name, &Chart { title, x: "activation U (1)", panels });
    }
    let first = steps.first().and_then(|steps| steps.first());
    Ok(first.map_or(f64::NAN, |step| step.above_n - step.below_n))
}
