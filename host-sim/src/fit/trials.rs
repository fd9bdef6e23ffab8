//! The list of trials and free parameters, `TRIALS.toml`; its format is in `docs/trials.md`.

mod free;
mod trial;

pub use trial::{Drive, Role, Trial};

use super::error::{FitError, Refuse};
use super::keys;
use super::parameters::{Parameter, Place};
use crate::muscle_file::NamedMuscle;
use crate::muscle_file::curve::{self, CurveTable};
use crate::trace::check_time_step;
use free::FreeTable;
use serde::Deserialize;
use std::path::Path;
use trial::TrialTable;
use vm_nostd::RecruitmentCurveParams;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrialsFile {
    noise_n: Option<f64>,
    noise_pct_f0: Option<f64>,
    #[serde(default = "one")]
    time_step_ms: f64,
    recruitment_curve: Option<CurveTable>,
    trial: Vec<TrialTable>,
    free: Vec<FreeTable>,
}

fn one() -> f64 {
    1.0
}

/// Recordings of one muscle and the parameters to fit.
#[derive(Clone, Debug)]
pub struct Trials {
    /// Standard deviation of a force reading, N.
    pub noise: f64,
    /// The key that states it.
    pub stated: &'static str,
    /// Time step of the model, s.
    pub time_step: f64,
    /// All trials.
    pub trials: Vec<Trial>,
    /// Free parameters.
    pub parameters: Vec<Parameter>,
    /// The starting recruitment curve.
    pub curve: Option<RecruitmentCurveParams>,
}

impl Trials {
    /// Reads the list, and the recordings from `folder`.
    pub fn read(path: &Path, folder: &Path, start: &NamedMuscle) -> Result<Self, FitError> {
        let text = std::fs::read_to_string(path).map_err(|error| FitError::Trials {
            path: path.to_owned(),
            problem: error.to_string(),
        })?;
        Self::parse(&text, path, folder, start)
    }

    /// Parses the list, and reads the recordings from `folder`; `path` is for error messages.
    pub fn parse(
        text: &str,
        path: &Path,
        folder: &Path,
        start: &NamedMuscle,
    ) -> Result<Self, FitError> {
        let refuse: Refuse<'_> =
            &|problem: String| FitError::Trials { path: path.to_owned(), problem };
        let file: TrialsFile = toml::from_str(text)
            .map_err(|error| refuse(error.to_string().trim_end().to_owned()))?;
        let muscle = &start.muscle;
        let (noise, stated) = match (file.noise_n, file.noise_pct_f0) {
            (Some(noise), None) => (noise, "noise_n"),
            (None, Some(percent)) => (percent * 1e-2 * muscle.f0(), "noise_pct_f0"),
            _ => return Err(refuse("give one of noise_n and noise_pct_f0".to_owned())),
        };
        if !(noise > 0.0 && noise.is_finite()) {
            return Err(refuse(format!("noise = {noise} N: must be more than 0")));
        }
        let (time_step_ms, time_step) = (file.time_step_ms, file.time_step_ms * 1e-3);
        check_time_step(time_step, 1e3)
            .map_err(|limit| refuse(format!("time_step_ms = {time_step_ms}: {limit}")))?;
        // The list's curve takes precedence: it may have been recorded with another electrode.
        let curve = file.recruitment_curve.map(CurveTable::params).or(start.curve);
        if let Some((key, value, limit)) = curve.as_ref().and_then(curve::refusal) {
            return Err(refuse(format!("{key} = {value}: {limit}")));
        }
        let parameters = file
            .free
            .iter()
            .map(|free| free.parameter(muscle, curve.as_ref(), refuse))
            .collect::<Result<Vec<_>, _>>()?;
        if parameters.is_empty() {
            return Err(refuse("[[free]]: at least one parameter must be free".to_owned()));
        }
        let twice = (1..parameters.len()).find(|&index| {
            parameters[..index].iter().any(|other| other.name == parameters[index].name)
        });
        if let Some(index) = twice {
            return Err(refuse(format!("[[free]] {}: given twice", parameters[index].name)));
        }
        let offsets: Vec<&str> = parameters
            .iter()
            .map(|parameter| match parameter.place {
                Place::Offset => parameter.name.as_str(),
                _ => "",
            })
            .collect();
        let trials = file
            .trial
            .iter()
            .map(|table| table.read(folder, &offsets, curve.is_some(), refuse))
            .collect::<Result<Vec<_>, _>>()?;
        let all = Self { noise, stated, time_step, trials, parameters, curve };
        all.check(refuse)?;
        Ok(all)
    }

    /// Removes the parameters that are not `wanted`, except offsets, which signals refer to.
    pub fn keep(&mut self, wanted: impl Fn(&Parameter) -> bool) {
        let mut places = Vec::new();
        let mut kept = 0;
        for parameter in &self.parameters {
            let keep = parameter.place == Place::Offset || wanted(parameter);
            places.push(kept);
            kept += usize::from(keep);
        }
        for trial in &mut self.trials {
            for signal in trial.signals_mut() {
                signal.renumber(&places);
            }
        }
        self.parameters.retain(|parameter| parameter.place == Place::Offset || wanted(parameter));
    }

    /// Sets the starts of the named parameters.
    pub fn start_at<'a>(&mut self, values: impl Iterator<Item = (&'a str, f64)>) {
        for (name, value) in values {
            for parameter in self.parameters.iter_mut().filter(|p| p.name == name) {
                parameter.start = value;
            }
        }
    }

    fn check(&self, refuse: Refuse<'_>) -> Result<(), FitError> {
        let fitted = || self.trials.iter().filter(|trial| trial.role == Role::Fit);
        let readings: usize = fitted().map(|trial| trial.readings.len()).sum();
        let least = 3 * self.parameters.len();
        if readings < least {
            let limit = format!("{} parameters need at least {least}", self.parameters.len());
            return Err(refuse(format!("{readings} readings in trials of role fit: {limit}")));
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            if parameter.place == Place::Offset
                && !fitted().any(|trial| trial.signals().any(|s| s.free() == Some(index)))
            {
                let name = &parameter.name;
                let limit = "neither a key of a muscle nor an offset of a trial of role fit";
                return Err(refuse(format!("[[free]] {name}: {limit}; keys: {}", keys::names())));
            }
        }
        Ok(())
    }
}
