//! Figures 5 and 6: sinusoids of activation (0 to 1) and of path length (14 to 18 cm), 1 to 10 Hz, with
//! continuous and with discrete recruitment, and with effective length.

use super::{Case, FiguresError, Folder, PATH, TIME_STEP, cases};
use crate::chart::{Chart, Panel};
use crate::engine::{self, Arithmetic, RunError};
use crate::reference::{Input, Mode};
use crate::trace::InputTrace;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;

const FREQUENCIES: [u32; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
/// Before the cycles that count, s.
const SETTLING: f64 = 2.0;
/// How long those last: whole cycles of every frequency, s.
const COUNTED: f64 = 1.0;
/// The frequency whose responses are drawn, Hz.
const DRAWN: u32 = 3;
/// Activation while the path swings, and the swing, m.
const HELD_ACTIVATION: f64 = 0.5;
const SWING: f64 = 0.02;

/// What swings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Swing {
    Activation,
    Length,
}

impl Swing {
    fn trace(self, frequency: u32) -> InputTrace {
        let ticks = ((SETTLING + COUNTED) / TIME_STEP).round() as usize;
        let input = |tick: usize| {
            let phase = TAU * f64::from(frequency) * tick as f64 * TIME_STEP;
            let (activation, path_length) = match self {
                Self::Activation => (0.5 - 0.5 * libm::cos(phase), PATH),
                Self::Length => (HELD_ACTIVATION, PATH + SWING * libm::sin(phase)),
            };
            Input { activation, path_length, stimulation_frequency: 0.0 }
        };
        InputTrace { start: 0.0, time_step: TIME_STEP, inputs: (0..=ticks).map(input).collect() }
    }
}

/// What 30 + 30 motor units do to a sinusoid, and the others relative to them.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) swing: Swing,
    pub(super) frequency_hz: u32,
    /// Mean force of 30 + 30 units, N.
    pub(super) mean_n: f64,
    /// From the least to the greatest force of 30 + 30 units, N.
    pub(super) range_n: f64,
    /// Continuous over discrete.
    pub(super) mean_ratio: f64,
    pub(super) range_ratio: f64,
    /// Largest difference that effective length makes, in % of the greatest force.
    pub(super) effective_length_pct: f64,
}

/// Forces of the cycles that count, N.
fn forces(case: &Case, arithmetic: Arithmetic, trace: &InputTrace) -> Result<Vec<f64>, RunError> {
    let rows = engine::run(&case.muscle, case.mode, arithmetic, trace)?;
    let first = rows.len() - (COUNTED / TIME_STEP).round() as usize;
    Ok(rows[first..].iter().map(|row| row.0.force).collect())
}

fn mean_and_range(forces: &[f64]) -> (f64, f64) {
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
    let most = forces.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (mean, most - least)
}

/// The forces of one sinusoid: continuous, discrete, and discrete with effective length.
struct Response {
    swing: Swing,
    frequency: u32,
    forces: [Vec<f64>; 3],
}

impl Response {
    fn row(&self) -> Row {
        let [continuous, discrete, effective] = &self.forces;
        let ((mean_n, range_n), other) = (mean_and_range(discrete), mean_and_range(continuous));
        let most = discrete.iter().copied().fold(0.0, f64::max);
        let differences = discrete.iter().zip(effective).map(|(a, b)| (a - b).abs());
        Row {
            swing: self.swing,
            frequency_hz: self.frequency,
            mean_n,
            range_n,
            mean_ratio: other.0 / mean_n,
            range_ratio: other.1 / range_n,
            effective_length_pct: 100.0 * differences.fold(0.0, f64::max) / most,
        }
    }
}

/// A point of the responses that are drawn.
#[derive(Debug, Serialize)]
struct Point {
    swing: Swing,
    t_s: f64,
    continuous_n: f64,
    discrete_30_n: f64,
    effective_length_n: f64,
}

pub(super) fn make(folder: &Folder<'_>, arithmetic: Arithmetic) -> Result<Vec<Row>, FiguresError> {
    let [continuous, _, discrete] = cases();
    let effective = Case {
        name: "discrete 30 + 30, effective length",
        mode: Mode::DiscreteEffectiveLength,
        ..discrete.clone()
    };
    let cases = [continuous, discrete, effective];
    let all: Vec<(Swing, u32)> = [Swing::Activation, Swing::Length]
        .into_iter()
        .flat_map(|swing| FREQUENCIES.map(|frequency| (swing, frequency)))
        .collect();
    let responses: Vec<Response> = all
        .into_par_iter()
        .map(|(swing, frequency)| {
            let trace = swing.trace(frequency);
            let [a, b, c] = cases.each_ref().map(|case| forces(case, arithmetic, &trace));
            Ok(Response { swing, frequency, forces: [a?, b?, c?] })
        })
        .collect::<Result<_, RunError>>()?;

    let drawn = || responses.iter().filter(|response| response.frequency == DRAWN);
    let points: Vec<Point> = drawn()
        .flat_map(|Response { swing, forces: [a, b, c], .. }| {
            a.iter().zip(b).zip(c).enumerate().map(move |(tick, ((a, b), c))| Point {
                swing: *swing,
                t_s: tick as f64 * TIME_STEP,
                continuous_n: *a,
                discrete_30_n: *b,
                effective_length_n: *c,
            })
        })
        .collect();
    folder.table("sinusoid_responses.csv", &points)?;
    let panels = drawn().map(|response| Panel {
        y: match response.swing {
            Swing::Activation => "force, U 0 to 1 (N)",
            Swing::Length => "force, path 14 to 18 cm (N)",
        },
        lines: cases
            .iter()
            .zip(&response.forces)
            .map(|(case, forces)| {
                let times = (0..).map(|tick| f64::from(tick) * TIME_STEP);
                (case.name.to_owned(), times.zip(forces.iter().copied()).collect())
            })
            .collect(),
    });
    let title = "Response to sinusoids at 3 Hz";
    let chart = Chart { title, x: "time (s)", panels: panels.collect() };
    folder.figure("sinusoid_responses.svg", &chart)?;

    let rows: Vec<Row> = responses.iter().map(Response::row).collect();
    folder.table("sinusoids.csv", &rows)?;
    let line = |name: &str, swing: Swing, value: fn(&Row) -> f64| {
        let of_swing = rows.iter().filter(|row| row.swing == swing);
        (name.to_owned(), of_swing.map(|row| (f64::from(row.frequency_hz), value(row))).collect())
    };
    let ratios = Panel {
        y: "continuous over discrete 30 + 30 (1)",
        lines: vec![
            line("mean, activation", Swing::Activation, |row| row.mean_ratio),
            line("range, activation", Swing::Activation, |row| row.range_ratio),
            line("mean, length", Swing::Length, |row| row.mean_ratio),
            line("range, length", Swing::Length, |row| row.range_ratio),
        ],
    };
    let effective = Panel {
        y: "largest change by L_eff (% of force)",
        lines: vec![
            line("activation", Swing::Activation, |row| row.effective_length_pct),
            line("length", Swing::Length, |row| row.effective_length_pct),
        ],
    };
    let title = "Sinusoids of activation and of path length";
    let chart = Chart { title, x: "frequency (Hz)", panels: vec![ratios, effective] };
    folder.figure("sinusoids.svg", &chart)?;
    Ok(rows)
}
