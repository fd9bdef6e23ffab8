//! The picture of the README: force over time under FES, computed in `f32`.

use super::place::ReadmeError;
use crate::chart::{Chart, Line, Panel, Point};
use crate::engine::{self, Arithmetic};
use crate::reference::{Input, Mode};
use crate::scenario::paper_muscle;
use crate::trace::InputTrace;

/// Stimulation frequencies, pps.
const FREQUENCIES: [f64; 3] = [10.0, 20.0, 40.0];
/// Musculotendon path, m.
const PATH: f64 = 0.16;
/// Tick at which the stimulus is switched on, ms.
const ON: usize = 100;
/// Tick at which it is switched off, ms.
const OFF: usize = 900;
/// Last tick, ms.
const END: usize = 1400;

/// Draws the picture as SVG.
pub fn picture() -> Result<String, ReadmeError> {
    let lines = FREQUENCIES
        .iter()
        .map(|&frequency| Ok(Line::new(format!("{frequency} pps"), force(frequency)?)))
        .collect::<Result<Vec<_>, ReadmeError>>()?;
    let panels = vec![Panel::new("tendon force (N)", lines)];
    let title = "FES of a muscle of 266 N, path 16 cm: full stimulus from 0.1 to 0.9 s";
    Ok(Chart { title, x: "time (s)", panels }.draw())
}

/// Force over time at a stimulation frequency.
fn force(frequency: f64) -> Result<Vec<Point>, ReadmeError> {
    let input = |tick| Input {
        activation: if (ON..OFF).contains(&tick) { 1.0 } else { 0.0 },
        path_length: PATH,
        stimulation_frequency: frequency,
    };
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs: (0..=END).map(input).collect() };
    let rows = engine::run(&paper_muscle(), Mode::Fes, Arithmetic::F32, &trace)?;
    let point = |(row, (sample, _)): (usize, &(crate::reference::Sample, _))| {
        (trace.time(row), sample.force)
    };
    Ok(rows.iter().enumerate().map(point).collect())
}
