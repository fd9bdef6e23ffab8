//! A trial: a recording of force and the inputs during it.

use crate::engine::mode_name;
use crate::fit::error::{FitError, Refuse};
use crate::fit::signal::{Signal, SignalTable};
use crate::reference::Mode;
use serde::Deserialize;
use std::path::Path;

/// `[[trial]]` in the list of trials.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialTable {
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

/// Highest stimulation frequency that the model takes, pps (`vm_nostd::Input`).
const MOST_PPS: f64 = 500.0;

fn one() -> f64 {
    1.0
}

/// Role of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// The parameters are fitted to it.
    Fit,
    /// It is predicted with the fitted parameters, and not used in the fit.
    Predict,
}

impl Role {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fit => "fit",
            Self::Predict => "predict",
        }
    }
}

/// Drive of a muscle.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Activation, 0..1.
    Activation(Signal),
    /// Pulse amplitude (mA) and width (µs), converted by the recruitment curve.
    Pulses(Signal, Signal),
}

/// A recording of force with its inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Name.
    pub name: String,
    /// Role.
    pub role: Role,
    /// Recruitment mode.
    pub mode: Mode,
    /// Weight of its squared residuals.
    pub weight: f64,
    /// Start, with the muscle at rest: time of the first force reading, s.
    pub begin: f64,
    /// Start and end of the comparison, s.
    pub window: (f64, f64),
    /// Time before `begin` for which the inputs at the start are held, s.
    pub lead: f64,
    /// Time (s) and raw value of the force readings in the window.
    pub readings: Vec<(f64, f64)>,
    /// Force, N.
    pub force: Signal,
    /// Path, m.
    pub path: Signal,
    /// Activation or pulses.
    pub drive: Drive,
    /// Stimulation frequency, pps.
    pub frequency: Signal,
}

impl Trial {
    pub(super) fn signals_mut(&mut self) -> impl Iterator<Item = &mut Signal> {
        let drive = match &mut self.drive {
            Drive::Activation(activation) => [Some(activation), None],
            Drive::Pulses(amplitude, width) => [Some(amplitude), Some(width)],
        };
        let own = [&mut self.force, &mut self.path, &mut self.frequency];
        own.into_iter().chain(drive.into_iter().flatten())
    }

    pub(super) fn signals(&self) -> impl Iterator<Item = &Signal> {
        let drive = match &self.drive {
            Drive::Activation(activation) => [Some(activation), None],
            Drive::Pulses(amplitude, width) => [Some(amplitude), Some(width)],
        };
        [&self.force, &self.path, &self.frequency].into_iter().chain(drive.into_iter().flatten())
    }
}

impl TrialTable {
    /// Reads the trial with its files in `folder`; `offsets` are the names of the free offsets.
    pub fn read(
        &self,
        folder: &Path,
        offsets: &[&str],
        has_curve: bool,
        refuse: Refuse<'_>,
    ) -> Result<Trial, FitError> {
        let refuse = |problem| refuse(format!("trial \"{}\": {problem}", self.name));
        let signal = |key: &str, table: &SignalTable| {
            Signal::read(table, folder, offsets, &|problem| refuse(format!("{key}: {problem}")))
        };
        let optional = |key: &str, table: &Option<SignalTable>| {
            table.as_ref().map(|table| signal(key, table)).transpose()
        };
        let modes = [Mode::Fes, Mode::Continuous, Mode::Discrete, Mode::DiscreteEffectiveLength];
        let mode =
            modes.into_iter().find(|&mode| mode_name(mode) == self.mode).ok_or_else(|| {
                let known = modes.map(mode_name).join(", ");
                refuse(format!("mode = \"{}\": must be one of {known}", self.mode))
            })?;
        if !(self.weight > 0.0 && self.weight.is_finite()) {
            return Err(refuse(format!("weight = {}: must be more than 0", self.weight)));
        }
        if !(0.0..=600.0).contains(&self.lead_s) {
            return Err(refuse(format!("lead_s = {}: must be 0 to 600", self.lead_s)));
        }
        let force = match (&self.force, &self.torque, self.moment_arm_m) {
            (Some(force), None, None) => signal("force", force)?,
            (None, Some(torque), Some(arm)) if arm.is_finite() && arm != 0.0 => {
                signal("torque", torque)?.times(1.0 / arm)
            }
            _ => {
                let limit = "give force, or torque with moment_arm_m that is not 0".to_owned();
                return Err(refuse(limit));
            }
        };
        let drive = match (&self.activation, &self.pulse_amplitude_ma, &self.pulse_width_us) {
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
        let recording =
            force.recording().ok_or_else(|| refuse("force: must be a file".to_owned()))?;
        let (first, last) = recording.span();
        let window = self.window_s.unwrap_or((first, last));
        if !(window.0 < window.1 && window.0 >= first && window.1 <= last) {
            let given = format!("window_s = [{}, {}]", window.0, window.1);
            return Err(refuse(format!("{given}: the force is recorded from {first} to {last} s")));
        }
        let recording = recording.between(window.0, window.1);
        recording.check_force()?;
        let frequency = optional("stimulation_pps", &self.stimulation_pps)?;
        if mode == Mode::Fes && frequency.is_none() {
            return Err(refuse("stimulation_pps = (missing): FES needs it".to_owned()));
        }
        let during = (first, window.1);
        if let Drive::Activation(activation) = &drive {
            activation.check("activation", (0.0, 1.0), during, &refuse)?;
        }
        if let Some(frequency) = &frequency {
            frequency.check("stimulation_pps", (0.0, MOST_PPS), during, &refuse)?;
        }
        Ok(Trial {
            name: self.name.clone(),
            role: self.role,
            mode,
            weight: self.weight,
            begin: first,
            window,
            lead: self.lead_s,
            readings: recording.readings().collect(),
            path: signal("length", &self.length)?,
            drive,
            frequency: frequency.unwrap_or_else(|| Signal::constant(0.0)),
            force,
        })
    }
}
