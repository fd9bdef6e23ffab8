//! Compares the model with the recordings: forces, residuals and their derivatives.

use super::error::FitError;
use super::parameters::{Parameter, Place, applied};
use super::trials::{Drive, Role, Trial, Trials};
use crate::engine::{self, Arithmetic, RunError};
use crate::muscle_file::curve;
use crate::reference::{Input, Muscle};
use crate::trace::InputTrace;
use nalgebra::DMatrix;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use vm_nostd::{Pulse, RecruitmentCurve, Status};

/// Recordings and the starting muscle.
#[derive(Clone, Debug)]
pub struct Problem {
    start: Muscle,
    /// Whether F0 is kept while other parameters change.
    keep_force: bool,
    /// Whether fixed point must accept every muscle of the search.
    in_fixed_point: bool,
    pub(super) trials: Trials,
    /// Set when nothing more is to be run.
    stop: Arc<AtomicBool>,
}

/// Result of running a trial with given parameters.
#[derive(Clone, Debug)]
pub struct Played {
    /// Force of the model at every reading, N.
    pub model: Vec<f64>,
    /// Measured force at every reading, N.
    pub measured: Vec<f64>,
    /// Flags raised during the run.
    pub status: Status,
}

impl Problem {
    /// Checks that the starting muscle can be run on all recordings.
    pub fn new(
        start: Muscle,
        keep_force: bool,
        in_fixed_point: bool,
        trials: Trials,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, FitError> {
        let problem = Self { start, keep_force, in_fixed_point, trials, stop };
        let values: Vec<f64> = problem.parameters().iter().map(|p| p.start).collect();
        for trial in &problem.trials.trials {
            problem
                .play(trial, &values, Arithmetic::F64)
                .map_err(|source| FitError::Start { trial: trial.name.clone(), source })?;
        }
        Ok(problem)
    }

    /// The free parameters.
    pub fn parameters(&self) -> &[Parameter] {
        &self.trials.parameters
    }

    /// The trials of a role.
    pub fn trials(&self, role: Role) -> impl Iterator<Item = &Trial> {
        self.trials.trials.iter().filter(move |trial| trial.role == role)
    }

    /// The muscle with its parameters at `values`.
    pub fn muscle(&self, values: &[f64]) -> Muscle {
        applied(&self.start, self.parameters(), values, self.keep_force)
    }

    /// The recruitment curve with its parameters at `values`, in the file's units.
    pub fn curve(&self, values: &[f64]) -> Option<[f64; 4]> {
        let mut numbers = curve::values(self.trials.curve.as_ref()?);
        for (parameter, &value) in self.parameters().iter().zip(values) {
            if let Place::Curve(index) = parameter.place {
                numbers[index] = value;
            }
        }
        Some(numbers)
    }

    /// Runs a trial.
    pub fn play(
        &self,
        trial: &Trial,
        values: &[f64],
        arithmetic: Arithmetic,
    ) -> Result<Played, RunError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(RunError::Stopped);
        }
        let muscle = self.muscle(values);
        let trace = self.inputs(trial, values)?;
        let path = trace.inputs[0].path_length;
        if self.in_fixed_point {
            engine::at_rest(&muscle, trial.mode, Arithmetic::Fixed, trace.time_step, path)?;
        }
        let rows = engine::run(&muscle, trial.mode, arithmetic, &trace)?;
        let forces: Vec<f64> = rows.iter().map(|row| row.0.force).collect();
        let model = trial
            .readings
            .iter()
            .map(|reading| interpolated(&forces, (reading.0 - trace.start) / trace.time_step))
            .collect();
        let measured =
            trial.readings.iter().map(|reading| trial.force.scaled(reading.1, values)).collect();
        let status = rows.iter().fold(Status::empty(), |all, row| all | row.1);
        Ok(Played { model, measured, status })
    }

    /// Inputs of a trial.
    pub fn inputs(&self, trial: &Trial, values: &[f64]) -> Result<InputTrace, RunError> {
        let time_step = self.trials.time_step;
        let begin = trial.begin;
        let start = begin - (trial.lead / time_step).ceil() * time_step;
        let ticks = ((trial.window.1 - start) / time_step).ceil() as usize;
        let curve = self
            .curve(values)
            .map(|numbers| RecruitmentCurve::<f64>::build(&curve::of_values(numbers)))
            .transpose()?;
        let input = |tick: usize| {
            let end = (start + tick as f64 * time_step).max(begin);
            // Inputs that are constant during a tick are sampled at its middle.
            let middle = (end - 0.5 * time_step).max(begin);
            let activation = match (&trial.drive, &curve) {
                (Drive::Activation(activation), _) => activation.at(middle, values),
                (Drive::Pulses(amplitude, width), Some(curve)) => {
                    let amplitude = amplitude.at(middle, values);
                    curve.activation(Pulse { amplitude, width: width.at(middle, values) }).0
                }
                (Drive::Pulses(..), None) => 0.0,
            };
            Input {
                activation,
                path_length: trial.path.at(end, values),
                stimulation_frequency: trial.frequency.at(middle, values),
            }
        };
        let mut inputs: Vec<Input> = (0..=ticks.max(1)).map(input).collect();
        // The muscle is at rest on the first row.
        inputs[0].activation = 0.0;
        Ok(InputTrace { start, time_step, inputs })
    }

    /// Residuals of all trials of role fit, over the noise; `None` if a muscle with these values is
    /// refused.
    pub fn residuals(&self, values: &[f64]) -> Option<Vec<f64>> {
        let mut residuals = Vec::new();
        for trial in self.trials(Role::Fit) {
            let played = self.play(trial, values, Arithmetic::F64).ok()?;
            let scale = trial.weight.sqrt() / self.trials.noise;
            residuals.extend(
                played
                    .model
                    .iter()
                    .zip(&played.measured)
                    .map(|(model, force)| scale * (model - force)),
            );
        }
        residuals.iter().all(|residual| residual.is_finite()).then_some(residuals)
    }

    /// Residuals of the priors: distance from the mean, in spreads.
    pub fn prior_residuals(&self, values: &[f64]) -> Vec<f64> {
        let of = |(parameter, value): (&Parameter, &f64)| {
            parameter.prior.map(|prior| (value - prior.mean) / prior.spread)
        };
        self.parameters().iter().zip(values).filter_map(of).collect()
    }

    /// Derivatives of the residuals by each parameter in units of its range: central differences,
    /// one-sided where the muscle on the other side is refused.
    pub fn jacobian(&self, values: &[f64]) -> Option<DMatrix<f64>> {
        const STEP: f64 = 1e-4;
        let middle = self.residuals(values)?;
        let columns = self
            .parameters()
            .iter()
            .enumerate()
            .map(|(index, parameter)| {
                let (least, most) = parameter.range();
                let at = |sign: f64| {
                    let mut moved = values.to_vec();
                    moved[index] += sign * STEP * (most - least);
                    self.residuals(&moved)
                };
                let slope = |high: &[f64], low: &[f64], steps: f64| -> Vec<f64> {
                    high.iter().zip(low).map(|(h, l)| (h - l) / (steps * STEP)).collect()
                };
                match (at(1.0), at(-1.0)) {
                    (Some(high), Some(low)) => Some(slope(&high, &low, 2.0)),
                    (Some(high), None) => Some(slope(&high, &middle, 1.0)),
                    (None, Some(low)) => Some(slope(&middle, &low, 1.0)),
                    (None, None) => None,
                }
            })
            .collect::<Option<Vec<_>>>()?;
        Some(DMatrix::from_fn(middle.len(), columns.len(), |row, column| columns[column][row]))
    }

    /// F0 of the muscle with its parameters at `values`, N.
    pub fn f0(&self, values: &[f64]) -> f64 {
        self.muscle(values).f0()
    }
}

/// Linear interpolation of a sequence at a fractional index.
fn interpolated(values: &[f64], index: f64) -> f64 {
    let index = index.max(0.0);
    let before = (index as usize).min(values.len() - 1);
    let after = (before + 1).min(values.len() - 1);
    values[before] + (values[after] - values[before]) * (index - before as f64).min(1.0)
}
