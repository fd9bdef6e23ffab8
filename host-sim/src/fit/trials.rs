//! The list of recordings and free parameters, `TRIALS.toml`; its shape is in `docs/trials.md`.

use super::error::FitError;
use super::keys::{self, Key};
use super::parameters::{Parameter, Place, Prior, admitted};
use super::priors;
use super::signal::{Signal, SignalTable};
use crate::engine::mode_name;
use crate::muscle_file::NamedMuscle;
use crate::muscle_file::curve::{self, CURVE, CurveTable};
use crate::reference::{Mode, Muscle};
use serde::Deserialize;
use std::path::Path;
use vm_nostd::RecruitmentCurveParams;

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

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TrialTable {
    name: String,
    role: Role,
    mode: String,
    #[serde(default = "one")]
    weight: f64,
    window_s: Option<(f64, f64)>,
    #[serde(default)]
    lead_s: f64,
    force: Option<SignalTable>,
    torque: Option<SignalTable>,
    moment_arm_m: Option<f64>,
    length: SignalTable,
    activation: Option<SignalTable>,
    pulse_amplitude_ma: Option<SignalTable>,
    pulse_width_us: Option<SignalTable>,
    stimulation_pps: Option<SignalTable>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FreeTable {
    name: String,
    start: Option<f64>,
    bounds: Option<(f64, f64)>,
    prior: Option<PriorKey>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "must be \"published\" or { mean = ..., spread = ... }")]
enum PriorKey {
    Named(String),
    Given(Prior),
}

fn one() -> f64 {
    1.0
}

/// What a trial is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The parameters are fitted to it.
    Fit,
    /// It is predicted, and not looked at before.
    Predict,
}

impl Role {
    /// Its name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => "fit",
            Self::Predict => "predict",
        }
    }
}

/// How strongly a muscle is driven.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Activation, 0..1.
    Activation(Signal),
    /// Pulses of an amplitude (mA) and a width (µs), by the recruitment curve.
    Pulses(Signal, Signal),
}

/// A recording, and what the muscle was made to do in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Its name.
    pub name: String,
    /// What it is for.
    pub role: Role,
    /// How the muscle was recruited.
    pub mode: Mode,
    /// Weight of its squared residuals.
    pub weight: f64,
    /// When it begins, the muscle at rest: the first reading of force, s.
    pub begin: f64,
    /// From when to when force is compared, s.
    pub window: (f64, f64),
    /// The muscle is held as at the start for so long before, s.
    pub lead: f64,
    /// Time (s) of the force readings in the window, and the readings as they are in the file.
    pub readings: Vec<(f64, f64)>,
    /// Force, N.
    pub force: Signal,
    /// Path, m.
    pub path: Signal,
    /// Activation or pulses.
    pub drive: Drive,
    /// pps.
    pub frequency: Signal,
}

/// Recordings of one muscle, and what is to be fitted to them.
#[derive(Clone, Debug)]
pub struct Trials {
    /// Standard deviation of a force reading, N.
    pub noise: f64,
    /// The muscle is stepped by this, s.
    pub time_step: f64,
    /// All of them.
    pub trials: Vec<Trial>,
    /// What is free.
    pub parameters: Vec<Parameter>,
    /// The recruitment curve to start from.
    pub curve: Option<RecruitmentCurveParams>,
}

/// A refusal, with the file's name put before it.
type Refuse<'a> = &'a dyn Fn(String) -> FitError;

impl Trials {
    /// Reads the list and the recordings of a muscle, these from `folder`.
    pub fn read(path: &Path, folder: &Path, start: &NamedMuscle) -> Result<Self, FitError> {
        let text = std::fs::read_to_string(path).map_err(|error| FitError::Trials {
            path: path.to_owned(),
            problem: error.to_string(),
        })?;
        Self::parse(&text, path, folder, start)
    }

    /// The same from the text of a list; `path` is for the messages.
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
        let noise = match (file.noise_n, file.noise_pct_f0) {
            (Some(noise), None) => noise,
            (None, Some(percent)) => percent * 1e-2 * muscle.f0(),
            _ => return Err(refuse("give one of noise_n and noise_pct_f0".to_owned())),
        };
        if !(noise > 0.0 && noise.is_finite()) {
            return Err(refuse(format!("noise = {noise} N: must be more than 0")));
        }
        // The list's own, which may be another electrode's than that of the muscle file.
        let curve = file.recruitment_curve.map(CurveTable::params).or(start.curve);
        if let Some((key, value, limit)) = curve.as_ref().and_then(curve::refusal) {
            return Err(refuse(format!("{key} = {value}: {limit}")));
        }
        let parameters = file
            .free
            .iter()
            .map(|free| parameter(free, muscle, curve.as_ref(), refuse))
            .collect::<Result<Vec<_>, _>>()?;
        if parameters.is_empty() {
            return Err(refuse("[[free]]: at least one parameter must be".to_owned()));
        }
        let twice = (1..parameters.len()).find(|&index| {
            parameters[..index].iter().any(|other| other.name == parameters[index].name)
        });
        if let Some(index) = twice {
            return Err(refuse(format!("[[free]] {}: is there twice", parameters[index].name)));
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
            .map(|table| {
                let refuse = |problem| refuse(format!("trial \"{}\": {problem}", table.name));
                trial(table, folder, &offsets, curve.is_some(), &refuse)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let all = Self { noise, time_step: file.time_step_ms * 1e-3, trials, parameters, curve };
        all.check(refuse)?;
        Ok(all)
    }

    /// Keeps the parameters of the muscle that `wanted` says; offsets, which signals name, stay.
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

    /// Starts the search at these values of the parameters that have these names.
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
                let limit = "no key of a muscle, and no offset of a trial of role fit";
                return Err(refuse(format!("[[free]] {name}: {limit}; keys: {}", keys::names())));
            }
        }
        Ok(())
    }
}

impl Trial {
    fn signals_mut(&mut self) -> impl Iterator<Item = &mut Signal> {
        let drive = match &mut self.drive {
            Drive::Activation(activation) => [Some(activation), None],
            Drive::Pulses(amplitude, width) => [Some(amplitude), Some(width)],
        };
        let own = [&mut self.force, &mut self.path, &mut self.frequency];
        own.into_iter().chain(drive.into_iter().flatten())
    }

    fn signals(&self) -> impl Iterator<Item = &Signal> {
        let drive = match &self.drive {
            Drive::Activation(activation) => [Some(activation), None],
            Drive::Pulses(amplitude, width) => [Some(amplitude), Some(width)],
        };
        [&self.force, &self.path, &self.frequency].into_iter().chain(drive.into_iter().flatten())
    }
}

fn parameter(
    free: &FreeTable,
    muscle: &Muscle,
    curve: Option<&RecruitmentCurveParams>,
    refuse: Refuse<'_>,
) -> Result<Parameter, FitError> {
    let name = &free.name;
    let refuse = |problem: String| refuse(format!("[[free]] {name}: {problem}"));
    let missing = |what: &str| refuse(format!("{what} = (missing): give it"));
    let (place, start, builder) = if let Some(key) = Key::named(name) {
        let part = || refuse("the muscle has no such part".to_owned());
        let value = key.value(muscle).ok_or_else(part)?;
        let bounds = admitted(muscle, &key);
        (Place::Muscle(key), Some(value), bounds)
    } else if let Some(rest) = name.strip_prefix(CURVE) {
        let index = curve::key(rest)
            .ok_or_else(|| refuse(format!("a recruitment curve has {}", curve::names())))?;
        let curve = curve.ok_or_else(|| missing("[recruitment_curve]"))?;
        (Place::Curve(index), Some(curve::values(curve)[index]), None)
    } else {
        (Place::Offset, None, None)
    };
    let start = free.start.or(start).ok_or_else(|| missing("start"))?;
    let bounds = free.bounds.or(builder).ok_or_else(|| missing("bounds"))?;
    if !(bounds.0 < start && start < bounds.1 && (bounds.1 - bounds.0).is_finite()) {
        let (least, most) = bounds;
        return Err(refuse(format!(
            "start = {start}: must be within its bounds {least} and {most}"
        )));
    }
    let prior = match &free.prior {
        None => None,
        Some(PriorKey::Given(prior)) => Some(*prior),
        Some(PriorKey::Named(word)) if word == "published" => {
            let spread = priors::published(name).ok_or_else(|| {
                refuse(format!("no published spread; there is one of {}", priors::names()))
            })?;
            Some(Prior { mean: start, spread: spread * start.abs() })
        }
        Some(PriorKey::Named(word)) => {
            let limit = "must be \"published\" or { mean = ..., spread = ... }";
            return Err(refuse(format!("prior = \"{word}\": {limit}")));
        }
    };
    if let Some(prior) = prior
        && !(prior.spread > 0.0 && prior.mean.is_finite() && prior.spread.is_finite())
    {
        return Err(refuse(format!("prior.spread = {}: must be more than 0", prior.spread)));
    }
    Ok(Parameter { name: name.clone(), place, start, bounds, prior })
}

fn trial(
    table: &TrialTable,
    folder: &Path,
    offsets: &[&str],
    has_curve: bool,
    refuse: Refuse<'_>,
) -> Result<Trial, FitError> {
    let signal = |key: &str, table: &SignalTable| {
        Signal::read(table, folder, offsets, &|problem| refuse(format!("{key}: {problem}")))
    };
    let optional = |key: &str, table: &Option<SignalTable>| {
        table.as_ref().map(|table| signal(key, table)).transpose()
    };
    let modes = [Mode::Fes, Mode::Continuous, Mode::Discrete, Mode::DiscreteEffectiveLength];
    let mode = modes.into_iter().find(|&mode| mode_name(mode) == table.mode).ok_or_else(|| {
        let known = modes.map(mode_name).join(", ");
        refuse(format!("mode = \"{}\": must be one of {known}", table.mode))
    })?;
    if !(table.weight > 0.0 && table.weight.is_finite()) {
        return Err(refuse(format!("weight = {}: must be more than 0", table.weight)));
    }
    if !(0.0..=600.0).contains(&table.lead_s) {
        return Err(refuse(format!("lead_s = {}: must be 0 to 600", table.lead_s)));
    }
    let force = match (&table.force, &table.torque, table.moment_arm_m) {
        (Some(force), None, None) => signal("force", force)?,
        (None, Some(torque), Some(arm)) if arm.is_finite() && arm != 0.0 => {
            signal("torque", torque)?.times(1.0 / arm)
        }
        _ => {
            let limit = "give force, or torque with moment_arm_m that is not 0".to_owned();
            return Err(refuse(limit));
        }
    };
    let drive = match (&table.activation, &table.pulse_amplitude_ma, &table.pulse_width_us) {
        (Some(activation), None, None) => Drive::Activation(signal("activation", activation)?),
        (None, Some(amplitude), Some(width)) if has_curve => Drive::Pulses(
            signal("pulse_amplitude_ma", amplitude)?,
            signal("pulse_width_us", width)?,
        ),
        _ => {
            let limit = "give activation, or pulse_amplitude_ma and pulse_width_us with a table \
                         [recruitment_curve]";
            return Err(refuse(limit.to_owned()));
        }
    };
    let recording = force
        .recording()
        .ok_or_else(|| refuse("force: must be a file, as it is measured".to_owned()))?;
    let (first, last) = recording.span();
    let window = table.window_s.unwrap_or((first, last));
    if !(window.0 < window.1 && window.0 >= first && window.1 <= last) {
        let given = format!("window_s = [{}, {}]", window.0, window.1);
        return Err(refuse(format!("{given}: the force is recorded from {first} to {last} s")));
    }
    let recording = recording.between(window.0, window.1);
    recording.check_force()?;
    let frequency = optional("stimulation_pps", &table.stimulation_pps)?;
    if mode == Mode::Fes && frequency.is_none() {
        return Err(refuse("stimulation_pps = (missing): FES needs it".to_owned()));
    }
    Ok(Trial {
        name: table.name.clone(),
        role: table.role,
        mode,
        weight: table.weight,
        begin: first,
        window,
        lead: table.lead_s,
        readings: recording.readings().collect(),
        path: signal("length", &table.length)?,
        drive,
        frequency: frequency.unwrap_or_else(|| Signal::constant(0.0)),
        force,
    })
}
