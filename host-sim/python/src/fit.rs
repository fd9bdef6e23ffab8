//! Fits of a muscle to recordings.

use crate::errors;
use crate::muscle::Muscle;
use crate::results::{ESTIMATE, TRIAL};
use crate::source::table;
use host_sim::fit::{CONFIRMED, Fit as Found, Search, Trials, fit_until, fitted_file};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A fitted muscle with the uncertainty of its parameters. From `fit`.
#[pyclass(module = "vm_nostd", frozen)]
pub struct Fit {
    found: Found,
    /// The fitted muscle's file.
    text: String,
}

/// How often Ctrl-C is looked for.
const LOOK: Duration = Duration::from_millis(20);

/// Works in another thread, without the interpreter's lock. Ctrl-C sets `stop`.
fn interruptible<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    std::thread::scope(|scope| {
        let working = scope.spawn(work);
        while !working.is_finished() {
            py.detach(|| std::thread::park_timeout(LOOK));
            py.check_signals().inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
        }
        Ok(working.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// Fits a muscle to the recordings of a list: a dict, or the path of a file.
#[pyfunction]
#[pyo3(name = "fit_list", signature = (muscle, trials, folder, starts, seed))]
pub fn fit(
    py: Python<'_>,
    muscle: &Bound<'_, Muscle>,
    trials: &Bound<'_, PyAny>,
    folder: PathBuf,
    starts: i64,
    seed: i64,
) -> PyResult<Fit> {
    if !(1..=1000).contains(&starts) {
        return Err(errors::refused("starts", &starts.to_string(), "must be 1 to 1000"));
    }
    let Ok(seed) = u64::try_from(seed) else {
        return Err(errors::refused("seed", &seed.to_string(), "must be at least 0"));
    };
    let start = &muscle.get().start;
    let trials = if let Ok(dict) = trials.cast::<PyDict>() {
        let text = toml::to_string(&table("trials", dict)?).map_err(|error| {
            errors::refused("trials", "dict", &format!("must have the keys of a list: {error}"))
        })?;
        Trials::parse(&text, Path::new("dict"), &folder, &start.named)
    } else {
        Trials::read(&trials.extract::<PathBuf>()?, &folder, &start.named)
    }
    .map_err(errors::fit)?;
    let search = Search { starts: starts as usize, seed };
    let stop = Arc::default();
    let found = interruptible(py, &stop, || {
        fit_until(&start.named, start.keep_force, trials, &search, &CONFIRMED, &stop)
    })?
    .map_err(errors::fit)?;
    let origin = format!("Fitted by vm_nostd.fit, {starts} starts, seed {seed}.");
    let text = fitted_file(&start.table, &found, &origin);
    Ok(Fit { found, text })
}

#[pymethods]
impl Fit {
    /// Every free parameter: value, standard error, 95 % interval, in the unit of its name.
    #[getter]
    fn estimates<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let estimates = self.found.estimates.iter();
        estimates
            .map(|estimate| {
                let (name, note) = (estimate.name.as_str(), estimate.note());
                let (value, error) = (estimate.value, estimate.standard_error);
                ESTIMATE.of(py, (name, value, error, estimate.interval(), note))
            })
            .collect()
    }

    /// Every trial: measured force and that of the fitted muscle (N), and the errors (% of F0).
    #[getter]
    fn trials<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let array = |values: &Vec<f64>| values.clone().into_pyarray(py);
        let trials = self.found.trials.iter();
        trials
            .map(|trial| {
                TRIAL.of(
                    py,
                    (
                        trial.name.as_str(),
                        trial.role.name(),
                        array(&trial.times),
                        array(&trial.measured),
                        array(&trial.model),
                        trial.mae_pct_f0,
                        trial.rms_pct_f0,
                        trial.bias_pct_f0,
                    ),
                )
            })
            .collect()
    }

    /// Pairs of parameters that trade off, with their correlation.
    #[getter]
    fn pairs(&self) -> Vec<(String, String, f64)> {
        let pairs = self.found.pairs.iter();
        pairs
            .map(|pair| {
                let [one, other] = pair.names.clone();
                (one, other, pair.correlation)
            })
            .collect()
    }

    /// Root mean square of the residuals over the stated noise.
    #[getter]
    fn noise_ratio(&self) -> f64 {
        self.found.noise_ratio
    }

    /// The fitted muscle as a muscle file, with its uncertainty in comments.
    fn to_toml(&self) -> &str {
        &self.text
    }
}
