//! Runs a fit: parameters with their uncertainty, and the model's force in every trial.

use super::error::FitError;
use super::problem::Problem;
use super::solve::Search;
use super::statistics::{Estimate, Pair, Series, statistics};
use super::trials::{Role, Trials};
use crate::engine::{self, Arithmetic, RunError};
use crate::metrics::ForceError;
use crate::muscle_file::NamedMuscle;
use crate::reference::Muscle;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use vm_nostd::Status;

/// A trial with the model's force.
#[derive(Clone, Debug)]
pub struct TrialFit {
    /// Name.
    pub name: String,
    /// Role: fit or predict.
    pub role: Role,
    /// Times of the readings, s.
    pub times: Vec<f64>,
    /// Measured force, N.
    pub measured: Vec<f64>,
    /// Force of the model, N.
    pub model: Vec<f64>,
    /// Mean absolute error, % of F0.
    pub mae_pct_f0: f64,
    /// Root mean square error, % of F0.
    pub rms_pct_f0: f64,
    /// Mean error, % of F0.
    pub bias_pct_f0: f64,
    /// Flags of the model.
    pub status: Status,
}

/// Difference of the fitted muscle in another arithmetic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confirmed {
    /// Arithmetic.
    pub arithmetic: Arithmetic,
    /// Largest and root mean square difference from `f64` over all trials, % of F0.
    pub difference: (f64, f64),
}

/// Result of a fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The fitted muscle.
    pub muscle: Muscle,
    /// The fitted recruitment curve, in the units of the list of trials.
    pub curve: Option<[f64; 4]>,
    /// Every parameter.
    pub estimates: Vec<Estimate>,
    /// Pairs that trade off.
    pub pairs: Vec<Pair>,
    /// Root mean square of the residuals over the stated noise.
    pub noise_ratio: f64,
    /// Stated noise (standard deviation of a reading), N.
    pub noise: f64,
    /// Every trial.
    pub trials: Vec<TrialFit>,
    /// The same muscle in the other arithmetics.
    pub confirmed: Vec<Confirmed>,
    /// Number of starts, and of those that ended at the best solution.
    pub starts: (usize, usize),
}

/// Arithmetics that a fitted muscle is run in, besides `f64`.
pub const CONFIRMED: [Arithmetic; 3] = [Arithmetic::Reference, Arithmetic::F32, Arithmetic::Fixed];

/// Residuals below this share of the stated noise are far below it: by chance the root mean square
/// of as few as 24 readings with that noise is there less than once in 1,000 times.
const BELOW_NOISE: f64 = 0.55;

/// Fits a muscle to trials. With `keep_force`, F0 is kept if it is not free; otherwise mass. The
/// result is run again in the arithmetics `confirm`. If fixed point is among them, the search is
/// limited to muscles that it accepts.
pub fn fit(
    start: &NamedMuscle,
    keep_force: bool,
    trials: Trials,
    search: &Search,
    confirm: &[Arithmetic],
) -> Result<Fit, FitError> {
    fit_until(start, keep_force, trials, search, confirm, &Arc::default())
}

/// [`fit`], which fails soon after `stop` is set by another thread: it is looked at before a trial
/// is run.
pub fn fit_until(
    start: &NamedMuscle,
    keep_force: bool,
    trials: Trials,
    search: &Search,
    confirm: &[Arithmetic],
    stop: &Arc<AtomicBool>,
) -> Result<Fit, FitError> {
    let in_fixed_point = confirm.contains(&Arithmetic::Fixed);
    let start = start.muscle.clone();
    let problem = Problem::new(start, keep_force, in_fixed_point, trials, Arc::clone(stop))?;
    let (solution, near) = search.best(&problem)?;
    let values = &solution.values;
    let failed = |why: &str| FitError::NoSolution(search.starts, why.to_owned());
    let jacobian =
        problem.jacobian(values).ok_or_else(|| failed("no derivatives at the solution"))?;
    let noise = problem.trials.noise;
    let played = |arithmetic| {
        problem
            .trials
            .trials
            .par_iter()
            .map(|trial| {
                problem.play(trial, values, arithmetic).map_err(|source: RunError| {
                    FitError::Start { trial: trial.name.clone(), source }
                })
            })
            .collect::<Result<Vec<_>, _>>()
    };
    let f0 = problem.f0(values);
    let all = played(Arithmetic::F64)?;
    let series: Vec<Series> = problem
        .trials
        .trials
        .iter()
        .zip(&all)
        .filter(|(trial, _)| trial.role == Role::Fit)
        .map(|(trial, played)| {
            let scale = trial.weight.sqrt() / noise;
            let pairs = played.model.iter().zip(&played.measured);
            let residuals = pairs.map(|(m, f)| scale * (m - f)).collect();
            Series { weight: trial.weight, residuals }
        })
        .collect();
    let found = statistics(problem.parameters(), values, &jacobian, &series);
    if !found.undetermined.is_empty() {
        return Err(FitError::Undetermined(found.undetermined));
    }
    let forces = |played: &[super::problem::Played]| -> Vec<f64> {
        played.iter().flat_map(|played| played.model.iter().copied()).collect()
    };
    let confirmed = confirm
        .iter()
        .map(|&arithmetic| {
            let error = ForceError::between(&forces(&played(arithmetic)?), &forces(&all), f0);
            Ok(Confirmed { arithmetic, difference: (error.max, error.rms) })
        })
        .collect::<Result<_, FitError>>()?;
    let trials = problem
        .trials
        .trials
        .iter()
        .zip(all)
        .map(|(trial, played)| {
            let error = ForceError::between(&played.model, &played.measured, f0);
            let absolute: f64 =
                played.model.iter().zip(&played.measured).map(|(m, f)| (m - f).abs()).sum();
            TrialFit {
                name: trial.name.clone(),
                role: trial.role,
                times: trial.readings.iter().map(|reading| reading.0).collect(),
                mae_pct_f0: 100.0 * absolute / (f0 * played.model.len() as f64),
                rms_pct_f0: error.rms,
                bias_pct_f0: error.bias,
                measured: played.measured,
                model: played.model,
                status: played.status,
            }
        })
        .collect();
    Ok(Fit {
        muscle: problem.muscle(values),
        curve: problem.curve(values),
        estimates: found.estimates,
        pairs: found.pairs,
        noise_ratio: found.noise_ratio,
        noise,
        trials,
        confirmed,
        starts: (search.starts, near),
    })
}

impl Fit {
    /// Whether the residuals are far below the stated noise, which then is too large or no noise at
    /// all.
    pub fn is_below_noise(&self) -> bool {
        self.noise_ratio < BELOW_NOISE
    }
}

impl TrialFit {
    /// Flags of the model, for a table.
    pub fn status_names(&self) -> String {
        engine::status_names(self.status)
    }
}
