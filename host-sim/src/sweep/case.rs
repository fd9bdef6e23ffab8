//! A case: muscle, inputs and the error of every arithmetic.

use super::keys::KEYS;
use crate::engine::{self, Arithmetic, Class};
use crate::metrics::{ForceError, forces};
use crate::model_muscle;
use crate::muscle_file;
use crate::reference::{Input, Mode, Muscle};
use crate::trace::InputTrace;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use vm_nostd::Status;

/// Duration of a case, s.
const DURATION: f64 = 1.0;
/// Fade-in of the path's oscillation, s.
const START: f64 = 0.3;

/// The values of all keys, and a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Recruitment mode.
    pub mode: Mode,
    /// Values, in the order of the keys.
    pub values: [f64; KEYS.len()],
}

impl Case {
    fn value(&self, name: &str) -> f64 {
        let index = KEYS.iter().position(|key| key.name == name);
        index.map_or(f64::NAN, |index| self.values[index])
    }

    /// Length of the tendon and longest path, cm.
    fn lengths(&self) -> (f64, f64) {
        let fascicle = self.value("fascicle_length_cm");
        let tendon = self.value("tendon_ratio") * fascicle;
        (tendon, tendon + self.value("longest_length_l0") * fascicle)
    }

    /// The muscle, as a file that `vm run` takes.
    pub fn muscle_file(&self) -> String {
        let (tendon, longest) = self.lengths();
        let slow = self.value("slow_fraction");
        format!(
            "name = \"a case of a sweep\"\n\
             mass_g = {}\nfascicle_length_cm = {}\ntendon_length_cm = {tendon}\n\
             max_path_length_cm = {longest}\nrecruitment_saturation = {}\n\n\
             [[fiber]]\npreset = \"paper-table-1/slow\"\nfraction = {slow}\nunits = 3\n\n\
             [[fiber]]\npreset = \"paper-table-1/fast\"\nfraction = {}\nunits = 3\n",
            self.value("mass_g"),
            self.value("fascicle_length_cm"),
            self.value("recruitment_saturation"),
            1.0 - slow,
        )
    }

    /// The muscle, or why it was refused.
    pub fn muscle(&self) -> Result<Muscle, String> {
        let named = muscle_file::parse(&self.muscle_file(), Path::new("muscle"));
        Ok(named.map_err(|error| error.to_string())?.muscle)
    }

    /// Inputs.
    pub fn trace(&self) -> InputTrace {
        let [from, to, hz] =
            ["activation_from", "activation_to", "activation_hz"].map(|name| self.value(name));
        let [speed, path_hz] = ["path_l0_per_s", "path_hz"].map(|name| self.value(name));
        let fascicle = self.value("fascicle_length_cm") * 1e-2;
        let (tendon, longest) = self.lengths();
        let middle = tendon * 1e-2 + self.value("path_l0") * fascicle;
        let swing = speed / (TAU * path_hz) * fascicle;
        let time_step = self.value("tick_ms") * 1e-3;
        // The path is limited to the muscle's domain.
        let end =
            self.muscle().map_or(longest * 1e-2, |muscle| model_muscle::path_domain(&muscle).1);
        let input = |tick: usize| {
            let time = tick as f64 * time_step;
            let activation = 0.5 * (from + to) + 0.5 * (from - to) * (TAU * hz * time).cos();
            let fade_in = (time / START).min(1.0);
            let path = middle + swing * fade_in * fade_in * (TAU * path_hz * time).sin();
            Input {
                activation,
                path_length: path.min(end),
                stimulation_frequency: self.value("stim_hz"),
            }
        };
        let ticks = (DURATION / time_step).round() as usize;
        InputTrace { start: 0.0, time_step, inputs: (0..=ticks).map(input).collect() }
    }

    /// Inputs, as a file for `vm run`.
    pub fn input_file(&self) -> String {
        let trace = self.trace();
        let mut text = "t_s,activation,path_length_m,stim_hz\n".to_owned();
        for (row, input) in trace.inputs.iter().enumerate() {
            let Input { activation, path_length, stimulation_frequency } = input;
            let time = trace.time(row);
            writeln!(text, "{time},{activation},{path_length},{stimulation_frequency}")
                .expect("a string grows");
        }
        text
    }

    /// Error and flags of every arithmetic against the reference, or why the case could not be run.
    pub fn errors(
        &self,
        arithmetics: &[Arithmetic],
        class: Class,
    ) -> Result<Vec<Measured>, String> {
        let (muscle, trace) = (self.muscle()?, self.trace());
        let run = |arithmetic| {
            engine::run_in_class(&muscle, self.mode, arithmetic, class, &trace)
                .map_err(|error| format!("{}: {error}", arithmetic.name()))
        };
        let computed: Vec<_> = arithmetics.iter().map(|&arithmetic| run(arithmetic)).collect();
        // The reference is the slowest: skipped if there is nothing to compare.
        if let Some(Err(refusal)) = computed.iter().find(|_| computed.iter().all(Result::is_err)) {
            return Err(refusal.clone());
        }
        let reference = forces(run(Arithmetic::Reference)?.iter().map(|row| &row.0));
        let error = |rows: Vec<engine::Row>| {
            let found = forces(rows.iter().map(|row| &row.0));
            let status = rows.iter().fold(Status::empty(), |all, row| all | row.1);
            (ForceError::between(&found, &reference, muscle.f0()), status)
        };
        Ok(computed.into_iter().map(|rows| rows.map(error)).collect())
    }
}

/// Result of an arithmetic: error and flags, or its refusal.
pub type Measured = Result<(ForceError, Status), String>;
