//! Figures 5 and 6: sinusoids of activation (0 to 1) and of path length (14 to 18 cm), 1 to 10 Hz,
//! with continuous and with discrete recruitment, and with effective length.

use super::files::{Figures, FiguresError};
use super::setting::{Case, PATH, TIME_STEP, cases};
use crate::chart::{Chart, Line, Panel};
use crate::engine::{self, Arithmetic, RunError};
use crate::metrics::ForceError;
use crate::reference::{Input, Mode};
use crate::trace::InputTrace;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;

const FREQUENCIES: [u32; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
/// Settling time before the evaluated cycles, s.
const SETTLING: f64 = 2.0;
/// Duration of those: whole cycles of every frequency, s.
const COUNTED: f64 = 1.0;
/// Frequency of the paper's figure 6, whose responses are drawn, Hz.
pub(super) const DRAWN: u32 = 3;
/// Peak forces of the discrete curves that the paper prints in figures 5 and 6, activation and
/// length (N).
pub(super) const PRINTED_PEAKS: [f64; 2] = [128.0, 152.0];
/// Activation during sinusoids of length, and their range, m.
const HELD_ACTIVATION: f64 = 0.5;
const SWING: f64 = 0.02;

/// The sinusoidal input.
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

/// Response of 30 + 30 motor units to a sinusoid, and the others relative to it.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) swing: Swing,
    pub(super) frequency_hz: u32,
    /// Greatest force of 30 + 30 units, N.
    pub(super) peak_n: f64,
    /// Mean force of 30 + 30 units, N.
    pub(super) mean_n: f64,
    /// Range of force of 30 + 30 units, N.
    pub(super) range_n: f64,
    /// Continuous over discrete.
    pub(super) mean_ratio: f64,
    pub(super) range_ratio: f64,
    /// Largest effect of effective length, % of peak force.
    pub(super) effective_length_pct: f64,
    /// The same in % of F0.
    pub(super) effective_length_pct_f0: f64,
    /// Its root mean square, in % of F0.
    pub(super) effective_length_rms_pct_f0: f64,
}

/// Forces of the evaluated cycles, N.
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
    fn row(&self, f0: f64) -> Row {
        let [continuous, discrete, effective] = &self.forces;
        let ((mean_n, range_n), other) = (mean_and_range(discrete), mean_and_range(continuous));
        let most = discrete.iter().copied().fold(0.0, f64::max);
        let difference = ForceError::between(effective, discrete, f0);
        Row {
            swing: self.swing,
            frequency_hz: self.frequency,
            peak_n: most,
            mean_n,
            range_n,
            mean_ratio: other.0 / mean_n,
            range_ratio: other.1 / range_n,
            effective_length_pct: difference.max * f0 / most,
            effective_length_pct_f0: difference.max,
            effective_length_rms_pct_f0: difference.rms,
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

pub(super) fn make(
    figures: &mut Figures,
    arithmetic: Arithmetic,
) -> Result<Vec<Row>, FiguresError> {
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
    figures.table("sinusoid_responses.csv", &points)?;
    let panels = drawn().flat_map(|response| {
        let trace = response.swing.trace(DRAWN);
        let counted = &trace.inputs[trace.inputs.len() - response.forces[0].len()..];
        let over_time = |label: &str, values: &mut dyn Iterator<Item = f64>| {
            Line::new(label, (0..).map(|tick| f64::from(tick) * TIME_STEP).zip(values))
        };
        let (input, force, printed): (Panel, &str, f64) = match response.swing {
            Swing::Activation => {
                let mut values = counted.iter().map(|input| input.activation);
                let input = Panel::input("U (1)", vec![over_time("", &mut values)]);
                (input, "force, L_mt 16 cm (N)", PRINTED_PEAKS[0])
            }
            Swing::Length => {
                let mut values = counted.iter().map(|input| input.path_length * 100.0);
                let input = Panel::input("L_mt (cm)", vec![over_time("", &mut values)]);
                (input, "force, U 0.5 (N)", PRINTED_PEAKS[1])
            }
        };
        let lines = cases
            .iter()
            .zip(&response.forces)
            .map(|(case, forces)| over_time(case.name, &mut forces.iter().copied()));
        let peak = Line::new("peak printed in the paper", [(0.0, printed), (COUNTED, printed)]);
        [input, Panel::new(force, lines.chain([peak]).collect())]
    });
    let title = "Figures 5 and 6: response to sinusoids at 3 Hz";
    let chart = Chart { title, x: "time (s)", panels: panels.collect() };
    figures.figure("sinusoid_responses.svg", &chart);

    let f0 = cases[0].muscle.f0();
    let rows: Vec<Row> = responses.iter().map(|response| response.row(f0)).collect();
    figures.table("sinusoids.csv", &rows)?;
    let line = |name: &str, swing: Swing, value: fn(&Row) -> f64| {
        let of_swing = rows.iter().filter(move |row| row.swing == swing);
        Line::new(name, of_swing.map(|row| (f64::from(row.frequency_hz), value(row))))
    };
    let ratios = Panel::new(
        "continuous / discrete (1)",
        vec![
            line("mean force, sinusoids of activation", Swing::Activation, |row| row.mean_ratio),
            line("range of force", Swing::Activation, |row| row.range_ratio),
        ],
    );
    let effective = Panel::new(
        "change by L_eff (% of peak)",
        vec![
            line("sinusoids of activation", Swing::Activation, |row| row.effective_length_pct),
            line("sinusoids of length (figure 6 has 3 Hz)", Swing::Length, |row| {
                row.effective_length_pct
            }),
        ],
    );
    let title = "Figures 5(e) and 6: sinusoids of 1 to 10 Hz";
    let chart = Chart { title, x: "frequency (Hz)", panels: vec![ratios, effective] };
    figures.figure("sinusoids.svg", &chart);
    Ok(rows)
}
