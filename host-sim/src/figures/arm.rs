//! Figure 3: the planar arm under constant activations, with and without effective length.

use super::files::{Figures, FiguresError};
use super::setting::TIME_STEP;
use crate::arm::{self, Activations, Arm, Drive, Moment, Outcome};
use crate::chart::{Chart, Line, Panel};
use crate::engine::Arithmetic;
use crate::reference::Mode;
use rayon::prelude::*;
use serde::Serialize;

/// The paper's activations.
pub const ACTIVATIONS: Activations = Activations { shoulder: 0.9, elbow: 0.4, biarticular: 0.0 };
/// Initial angles, degrees: upper arm half way forward, elbow at a right angle.
pub const START: [f64; 2] = [45.0, 90.0];
/// Duration, long enough to distinguish sustained, growing and decaying oscillations, s.
pub const DURATION: f64 = 30.0;

const MODES: [(&str, Mode); 3] = [
    ("continuous", Mode::Continuous),
    ("discrete 3 + 3", Mode::Discrete),
    ("discrete 3 + 3, effective length", Mode::DiscreteEffectiveLength),
];

/// Angles of shoulder and elbow, degrees.
#[derive(Debug, Serialize)]
struct Row {
    t_s: f64,
    continuous_shoulder_deg: f64,
    continuous_elbow_deg: f64,
    discrete_shoulder_deg: f64,
    discrete_elbow_deg: f64,
    effective_length_shoulder_deg: f64,
    effective_length_elbow_deg: f64,
}

/// Outcomes with continuous recruitment, with discrete, and with effective length.
pub(super) fn make(
    figures: &mut Figures,
    arithmetic: Arithmetic,
) -> Result<[Outcome; 3], FiguresError> {
    let arm = Arm::built_in();
    let runs: Vec<Vec<Moment>> = MODES
        .par_iter()
        .map(|&(_, mode)| {
            let drive = Drive {
                mode,
                arithmetic,
                activations: ACTIVATIONS,
                stimulation_frequency: 0.0,
                start: START.map(f64::to_radians),
                time_step: TIME_STEP,
                duration: DURATION,
            };
            arm::run(&arm, &drive)
        })
        .collect::<Result<_, _>>()?;
    let [continuous, discrete, effective] = [&runs[0], &runs[1], &runs[2]];
    let degrees = |moment: &Moment, joint: usize| moment.angles[joint].to_degrees();
    let rows: Vec<Row> = continuous
        .iter()
        .zip(discrete)
        .zip(effective)
        .map(|((a, b), c)| Row {
            t_s: a.time,
            continuous_shoulder_deg: degrees(a, 0),
            continuous_elbow_deg: degrees(a, 1),
            discrete_shoulder_deg: degrees(b, 0),
            discrete_elbow_deg: degrees(b, 1),
            effective_length_shoulder_deg: degrees(c, 0),
            effective_length_elbow_deg: degrees(c, 1),
        })
        .collect();
    figures.table("arm.csv", &rows)?;
    let panel = |y, joint| {
        let line = |((name, _), run): (&(&str, Mode), &Vec<Moment>)| {
            Line::new(*name, run.iter().map(|moment| (moment.time, degrees(moment, joint))))
        };
        Panel::new(y, MODES.iter().zip(&runs).map(line).collect())
    };
    let Activations { shoulder, elbow, biarticular } = ACTIVATIONS;
    let inputs = [("shoulder", shoulder), ("elbow", elbow), ("biarticular", biarticular)];
    let input = |(name, value)| Line::new(name, [(0.0, value), (DURATION, value)]);
    let chart = Chart {
        title: "Figure 3: an arm at constant activations",
        x: "time (s)",
        panels: vec![
            Panel::input("U (1)", inputs.map(input).into()),
            panel("shoulder angle (degrees)", 0),
            panel("elbow angle (degrees)", 1),
        ],
    };
    figures.figure("arm.svg", &chart);
    Ok([continuous, discrete, effective].map(|run| Outcome::of(&arm, run, TIME_STEP)))
}
