//! `vm fit` with other kinds of recordings: electrode pulses, joint torque, a fatiguing muscle.

use host_sim::engine::{self, Arithmetic};
use host_sim::muscle_file::{self, NamedMuscle};
use host_sim::reference::{Fatigue, Input, Mode, Muscle};
use host_sim::trace::InputTrace;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use vm_nostd::{Pulse, RecruitmentCurve, RecruitmentCurveParams};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");
const PATH: f64 = 0.155;

/// Starting recruitment curve; the recordings have another.
const CURVE: &str = "[recruitment_curve]\nthreshold_ma = 4\nsaturation_ma = 12\n\
                     chronaxie_us = 200\nslope = 2\n";
const FATIGUE: &str = "[fatigue]\nT_fat_s = 18\nT_rec_s = 30\nfit_min = 0.2\nbeta = 0.6\n";

/// The muscle file with an additional table.
fn file(table: &str) -> String {
    format!("{MUSCLE}\n{table}")
}

fn parse(text: &str) -> NamedMuscle {
    muscle_file::parse(text, Path::new("m.toml")).expect("a muscle")
}

/// Force (N) of the reference every 10 ms, on a constant path.
fn forces(muscle: &Muscle, seconds: f64, pps: f64, activation: impl Fn(f64) -> f64) -> Vec<f64> {
    let input = |tick: usize| Input {
        // Constant during the tick.
        activation: activation(tick as f64 * 1e-3 - 0.5e-3),
        path_length: PATH,
        stimulation_frequency: pps,
    };
    let mut inputs: Vec<Input> = (0..=(seconds * 1e3) as usize).map(input).collect();
    inputs[0].activation = 0.0;
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs };
    let rows = engine::run(muscle, Mode::Fes, Arithmetic::Reference, &trace).expect("a run");
    rows.iter().step_by(10).map(|row| row.0.force).collect()
}

/// Fits to a recording and returns the text of the fitted file.
fn fitted(muscle: &str, trials: &str, column: &str, recorded: &[f64]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    let mut text = format!("t_s,{column}\n");
    for (index, value) in recorded.iter().enumerate() {
        text += &format!("{},{value:.6}\n", index as f64 * 0.01);
    }
    for (name, text) in [("m.toml", muscle), ("trials.toml", trials), ("r.csv", &text)] {
        fs::write(path(name), text).expect("a file");
    }
    let done = Command::new(env!("CARGO_BIN_EXE_vm"))
        .current_dir(folder.path())
        .args(["fit", "--muscle", "m.toml", "--trials", "trials.toml", "--output", "fitted.toml"])
        .args(["--starts", "1"])
        .output()
        .expect("vm runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    fs::read_to_string(path("fitted.toml")).expect("a file")
}

fn near(found: f64, truth: f64, what: &str) {
    // Without noise the error is the truncation error, 0.1 % of F0.
    assert!((found / truth - 1.0).abs() < 0.01, "{what}: {found}, and not {truth}");
}

/// Pairs of time and value in the format of `steps`.
fn steps(pairs: &[(f64, f64)]) -> String {
    let pairs: Vec<String> = pairs.iter().map(|(t, v)| format!("[{t}, {v}]")).collect();
    format!("{{ steps = [{}] }}", pairs.join(", "))
}

fn at(pairs: &[(f64, f64)], time: f64) -> f64 {
    pairs.iter().rfind(|pair| pair.0 <= time).map_or(0.0, |pair| pair.1)
}

#[test]
fn a_recruitment_curve_is_fitted_and_written_to_the_file() {
    let truth = RecruitmentCurveParams {
        threshold: 5e-3,
        saturation: 10e-3,
        chronaxie: 250e-6,
        slope: 3.0,
    };
    let curve = RecruitmentCurve::<f64>::build(&truth).expect("a curve");
    // A staircase of amplitudes at each of two widths.
    let stair = |from: f64| {
        (0..10).map(move |step| (from + 0.3 * f64::from(step), 6.0 + 2.0 * f64::from(step)))
    };
    let amplitudes: Vec<(f64, f64)> =
        [(0.0, 0.0)].into_iter().chain(stair(0.1)).chain([(3.1, 0.0)]).chain(stair(3.6)).collect();
    let widths = [(0.0, 300.0), (3.3, 120.0)];
    let recorded = forces(&parse(MUSCLE).muscle, 6.8, 40.0, |time| {
        let (amplitude, width) = (at(&amplitudes, time), at(&widths, time));
        curve.activation(Pulse { amplitude, width }).0
    });
    let trials = format!(
        "noise_n = 1\n[[trial]]\nname = \"stair\"\nrole = \"fit\"\nmode = \"fes\"\n\
         force = {{ file = \"r.csv\", time = \"t_s\", value = \"force_n\" }}\n\
         length = {{ constant = {PATH} }}\nstimulation_pps = {{ constant = 40 }}\n\
         pulse_amplitude_ma = {}\npulse_width_us = {}\n\
         [[free]]\nname = \"recruitment_curve.threshold_ma\"\nbounds = [2, 8]\n\
         [[free]]\nname = \"recruitment_curve.saturation_ma\"\nbounds = [8.5, 20]\n\
         [[free]]\nname = \"recruitment_curve.chronaxie_us\"\nbounds = [60, 800]\n\
         [[free]]\nname = \"recruitment_curve.slope\"\nbounds = [1, 8]\n",
        steps(&amplitudes),
        steps(&widths),
    );
    let found = fitted(&file(CURVE), &trials, "force_n", &recorded);
    let read = parse(&found).curve.expect("the fitted file has the curve as data");
    near(read.threshold, truth.threshold, "threshold");
    near(read.saturation, truth.saturation, "saturation");
    near(read.chronaxie, truth.chronaxie, "chronaxie");
    near(read.slope, truth.slope, "slope");
    // A list may have its own curve, which is written to the fitted file as well.
    let own = format!("{CURVE}{}", trials.replace("noise_n = 1\n", ""));
    let own = format!("noise_n = 1\n{own}");
    let found = fitted(MUSCLE, &own, "force_n", &recorded);
    near(parse(&found).curve.expect("a curve").threshold, truth.threshold, "threshold");
}

#[test]
fn torque_divided_by_the_moment_arm_is_force() {
    let mut strong = parse(MUSCLE).muscle;
    strong.mass *= 300.0 / strong.f0();
    let arm = 0.04;
    let on = |time: f64| if (0.1..0.8).contains(&time) { 1.0 } else { 0.0 };
    let torque: Vec<f64> = forces(&strong, 1.2, 40.0, on).iter().map(|f| f * arm).collect();
    let trials = format!(
        "noise_n = 1\n[[trial]]\nname = \"torque\"\nrole = \"fit\"\nmode = \"fes\"\n\
         torque = {{ file = \"r.csv\", time = \"t_s\", value = \"torque_nm\" }}\nmoment_arm_m = {arm}\n\
         length = {{ constant = {PATH} }}\nstimulation_pps = {{ constant = 40 }}\n\
         activation = {{ steps = [[0, 0], [0.1, 1], [0.8, 0]] }}\n\
         [[free]]\nname = \"max_isometric_force_n\"\nbounds = [100, 600]\n",
    );
    let found = parse(&fitted(MUSCLE, &trials, "torque_nm", &torque)).muscle;
    near(found.f0(), 300.0, "F0");
}

#[test]
fn fatigue_parameters_are_fitted() {
    let mut tired = parse(&file(FATIGUE)).muscle;
    let truth = Fatigue { T_fat: 12.0, T_rec: 40.0, fit_min: 0.3, beta: 0.6 };
    tired.fatigue = Some(truth);
    let on = |time: f64| f64::from((0.1..15.0).contains(&time) || (25.0..25.5).contains(&time));
    let recorded = forces(&tired, 26.0, 80.0, on);
    let trials = format!(
        "noise_n = 1\ntime_step_ms = 2\n\
         [[trial]]\nname = \"fatigue\"\nrole = \"fit\"\nmode = \"fes\"\n\
         force = {{ file = \"r.csv\", time = \"t_s\", value = \"force_n\" }}\n\
         length = {{ constant = {PATH} }}\nstimulation_pps = {{ constant = 80 }}\n\
         activation = {{ steps = [[0, 0], [0.1, 1], [15, 0], [25, 1], [25.5, 0]] }}\n\
         [[free]]\nname = \"fatigue.T_fat_s\"\nbounds = [5, 60]\n\
         [[free]]\nname = \"fatigue.T_rec_s\"\nbounds = [5, 200]\n\
         [[free]]\nname = \"fatigue.fit_min\"\nbounds = [0, 0.9]\n",
    );
    let found = fitted(&file(FATIGUE), &trials, "force_n", &recorded);
    let read = parse(&found).muscle.fatigue.expect("it tires");
    near(read.T_fat, truth.T_fat, "T_fat");
    near(read.T_rec, truth.T_rec, "T_rec");
    near(read.fit_min, truth.fit_min, "fit_min");
    assert_eq!(read.beta, truth.beta);
}

#[test]
fn an_invalid_curve_is_refused_with_key_and_line() {
    let text = file(&CURVE.replace("saturation_ma = 12", "saturation_ma = 4.1"));
    let error = muscle_file::parse(&text, Path::new("m.toml")).expect_err("refused").to_string();
    let line = text.lines().position(|line| line.starts_with("saturation_ma")).expect("a line") + 1;
    for word in [&format!("line {line}"), "recruitment_curve.saturation_ma = 4.1", "4.2"] {
        assert!(error.contains(word), "no \"{word}\" in: {error}");
    }
}
