//! The recordings that determine a muscle's parameters: half a minute of stimulation or voluntary
//! contraction at three lengths.

use super::bout::{Bout, Setting, Steps, WIDTH_US};
use super::list::list;
use crate::fit::Role;
use crate::muscle_file::NamedMuscle;
use crate::reference::Mode;
use crate::trace::{TraceError, write_atomically};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// File name of the list of trials.
pub const LIST: &str = "trials.toml";

/// Short and long path relative to the neutral one, L_ce0.
const SHORT: f64 = -0.2;
const LONG: f64 = 0.12;
/// Default stimulation frequency, pps.
const PPS: f64 = 40.0;

/// Contractions (level, pps) of `on` s with pauses of `off` s from 0.1 s on: level, frequency and
/// end.
fn contractions(of: &[(f64, f64)], on: f64, off: f64) -> (Steps, Steps, f64) {
    let (mut level, mut pps) = (vec![(0.0, 0.0)], vec![(0.0, of[0].1)]);
    let mut time = 0.1;
    for &(strength, frequency) in of {
        level.extend([(time, strength), (time + on, 0.0)]);
        pps.push((time, frequency));
        time = round(time + on + off);
    }
    (level.into_iter().map(|(t, v)| (round(t), v)).collect(), pps, time)
}

/// Rounded to a millisecond, the resolution of the files.
fn round(time: f64) -> f64 {
    (time * 1e3).round() * 1e-3
}

fn bout(name: &'static str, at: f64, (level, pps, seconds): (Steps, Steps, f64)) -> Bout {
    let (width_us, path) = (vec![(0.0, WIDTH_US)], vec![(0.0, at)]);
    Bout { name, role: Role::Fit, seconds, level, width_us, pps, path }
}

/// A staircase of amplitudes at one width, then at a shorter one, which determines the chronaxie.
fn staircase() -> Bout {
    const STEP: f64 = 0.35;
    let wide = (2..=12).map(|step| f64::from(step) / 12.0);
    let narrow = [0.4, 0.55, 0.7, 0.85, 1.0];
    let levels: Vec<f64> = wide.chain([0.0, 0.0]).chain(narrow).collect();
    let starts = |index: usize| round(0.1 + STEP * index as f64);
    let mut level = vec![(0.0, 0.0)];
    level.extend(levels.iter().enumerate().map(|(index, &l)| (starts(index), l)));
    level.push((starts(levels.len()), 0.0));
    let seconds = starts(levels.len()) + 0.5;
    let mut stair = bout("staircase", 0.0, (level, vec![(0.0, PPS)], seconds));
    stair.width_us.push((starts(12), WIDTH_US / 3.0));
    stair
}

/// A passive stretch from short to long, then shortening and stretch while the muscle contracts.
fn movement(level: f64, pps: f64) -> Bout {
    let steps = vec![(0.0, 0.0), (1.8, level), (4.2, 0.0)];
    let mut moved = bout("movement", 0.0, (steps, vec![(0.0, pps)], 4.8));
    moved.path =
        vec![(0.1, SHORT), (1.1, LONG), (2.4, LONG), (3.0, SHORT), (3.3, SHORT), (3.7, LONG)];
    moved
}

/// Two fatiguing contractions at different frequencies, and short ones that show the recovery.
fn fatigue(level: f64, frequencies: [f64; 2]) -> Bout {
    let [fast, slow] = frequencies;
    let steps = [
        (0.0, 0.0),
        (0.1, level),
        (9.1, 0.0),
        (11.1, level),
        (17.1, 0.0),
        (22.1, level),
        (22.7, 0.0),
        (30.1, level),
        (30.7, 0.0),
    ];
    let pps = vec![(0.0, fast), (11.1, slow), (22.1, fast)];
    bout("fatigue", 0.0, (steps.to_vec(), pps, 31.2))
}

/// Two strides for prediction: smooth path and level as in walking, bursts of two amplitudes.
fn gait(pps: f64) -> Bout {
    const STRIDE: f64 = 1.1;
    const FINE: f64 = 0.02;
    let last = (2.0 * STRIDE / FINE).round() as i32;
    let times = (0..=last).map(|index| round(f64::from(index) * FINE));
    let path = |time: f64| {
        let phase = TAU * time / STRIDE;
        -0.03 - 0.1 * phase.cos() + 0.04 * (2.0 * phase).sin()
    };
    let level = |time: f64| {
        let phase = (time / STRIDE).fract();
        let height = if time < STRIDE { 0.85 } else { 0.5 };
        if (0.1..0.6).contains(&phase) {
            height * (TAU * (phase - 0.1)).sin().max(0.0)
        } else {
            0.0
        }
    };
    let steps = times.clone().map(|time| (time, (level(time) * 1e3).round() * 1e-3)).collect();
    let mut walk = bout("gait", 0.0, (steps, vec![(0.0, pps)], 2.0 * STRIDE));
    walk.path = times.map(|time| (time, path(time))).collect();
    walk.role = Role::Predict;
    walk
}

/// The bouts of a mode, each starting at rest; `tires`: the muscle has fatigue parameters.
pub fn bouts(mode: Mode, tires: bool) -> Vec<Bout> {
    let mut all = if mode == Mode::Fes {
        let at = |frequencies: &[f64]| frequencies.iter().map(|&f| (1.0, f)).collect::<Vec<_>>();
        let few = at(&[10.0, 20.0, 40.0]);
        vec![
            staircase(),
            bout(
                "trains",
                0.0,
                contractions(&at(&[5.0, 8.0, 12.0, 20.0, 30.0, 45.0, 80.0]), 0.6, 0.4),
            ),
            bout("short", SHORT, contractions(&few, 0.5, 0.4)),
            bout("long", LONG, contractions(&few, 0.5, 0.4)),
            movement(1.0, 30.0),
            fatigue(1.0, [80.0, 20.0]),
            gait(30.0),
        ]
    } else {
        let efforts = |levels: &[f64]| levels.iter().map(|&l| (l, 0.0)).collect::<Vec<_>>();
        vec![
            bout(
                "efforts",
                0.0,
                contractions(&efforts(&[0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0]), 0.7, 0.5),
            ),
            bout("short", SHORT, contractions(&efforts(&[0.3, 1.0]), 0.7, 0.5)),
            bout("long", LONG, contractions(&efforts(&[0.3, 1.0]), 0.7, 0.5)),
            movement(0.6, 0.0),
            fatigue(0.9, [0.0, 0.0]),
            gait(0.0),
        ]
    };
    all.retain(|bout| tires || bout.name != "fatigue");
    all
}

/// Time with activation or stimulation in all fitted bouts, s.
pub fn stimulated(bouts: &[Bout]) -> f64 {
    bouts.iter().filter(|bout| bout.role == Role::Fit).map(Bout::driven).sum()
}

/// Writes the inputs of a protocol and its list of trials for `vm fit` to a folder.
pub fn write(named: &NamedMuscle, mode: Mode, folder: &Path) -> Result<(), WriteError> {
    let setting = Setting::of(named, mode);
    let bouts = bouts(mode, named.muscle.fatigue.is_some());
    for bout in &bouts {
        let trace = bout.inputs(&setting, named.curve.as_ref(), 0.0)?;
        let mut text = "t_s,activation,path_length_m,stim_hz\n".to_owned();
        for (row, input) in trace.inputs.iter().enumerate() {
            let (time, path) = (trace.time(row), input.path_length);
            let (activation, pps) = (input.activation, input.stimulation_frequency);
            writeln!(text, "{time:.3},{activation:.6},{path:.7},{pps}").expect("a string grows");
        }
        write_atomically(&folder.join(bout.file_name()), text.as_bytes())?;
    }
    write_atomically(&folder.join(LIST), list(named, mode, &bouts).as_bytes())?;
    Ok(())
}

/// Why a protocol could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Invalid recruitment curve.
    #[error(transparent)]
    Curve(#[from] vm_nostd::ParameterError),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] TraceError),
}
