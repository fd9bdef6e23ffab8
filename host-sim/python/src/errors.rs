//! What is refused, as Python exceptions: `ParameterError` with field, value and limit.

use crate::arguments::{ARGUMENTS, in_unit};
use host_sim::engine::RunError;
use host_sim::fit::FitError;
use host_sim::muscle_file::MuscleFileError;
use host_sim::trace::TraceError;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use vm_nostd::Limit;
use vm_nostd::control::JointError;

static PARAMETER_ERROR: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// `vm_nostd.ParameterError`; the value is a number if its text is one.
pub fn refused(field: &str, value: &str, limit: &str) -> PyErr {
    refused_at("", field, value, limit)
}

/// The same, in a file and a line of it.
fn refused_at(place: &str, field: &str, value: &str, limit: &str) -> PyErr {
    Python::attach(|py| {
        let class = match PARAMETER_ERROR.import(py, "vm_nostd._errors", "ParameterError") {
            Ok(class) => class.clone(),
            Err(error) => return error,
        };
        let (field, limit, place) = (field.to_owned(), limit.to_owned(), place.to_owned());
        match value.parse::<f64>() {
            Ok(number) => PyErr::from_type(class, (field, number, limit, place)),
            Err(_) => PyErr::from_type(class, (field, value.to_owned(), limit, place)),
        }
    })
}

/// Something of a type that is not taken.
pub fn wrong_type(field: &str, found: &str, wanted: &str) -> PyErr {
    PyTypeError::new_err(format!("{field} is {found}: must be {wanted}"))
}

/// A value that `vm-nostd` refuses.
pub fn parameter(error: vm_nostd::ParameterError) -> PyErr {
    let place = error.fiber.map(|fiber| format!("fibers[{fiber}]."));
    argument(&place.unwrap_or_default(), &error)
}

/// A joint, controller or prosthesis that `vm-nostd` refuses.
pub fn joint(JointError { muscle, error }: JointError) -> PyErr {
    let place = muscle.map(|muscle| format!("muscles[{muscle}]."));
    argument(&place.unwrap_or_default(), &error)
}

/// A refused argument, by its name and in its unit.
fn argument(place: &str, error: &vm_nostd::ParameterError) -> PyErr {
    // A derived quantity with a unit of its own follows the field after a colon.
    let (field, derived) = match error.field.split_once(": ") {
        Some((field, derived)) => (field, format!(": {derived}")),
        None => (error.field, String::new()),
    };
    let known = ARGUMENTS.iter().find(|(name, ..)| *name == field);
    let (name, scale) = known.map_or((field, 1.0), |&(_, name, scale)| (name, scale));
    let scale = if derived.is_empty() { scale } else { 1.0 };
    let limit = match error.limit {
        Limit::Within { least, most } => {
            let [least, most] = [least, most].map(|bound| in_unit(bound, scale));
            Limit::Within { least, most }
        }
        other => other,
    };
    let value = in_unit(error.value, scale).to_string();
    refused(&format!("{place}{name}{derived}"), &value, &limit.to_string())
}

/// Saved words that are not taken back.
pub fn restore(words: usize, problem: &str) -> PyErr {
    refused("words", &format!("{words} words"), problem)
}

/// A muscle that cannot be run.
pub fn run(error: RunError) -> PyErr {
    match error {
        RunError::Refused(error) => parameter(error),
        RunError::Restore { words, problem } => restore(words, &problem),
        RunError::Solver(error) => PyRuntimeError::new_err(error.to_string()),
        RunError::NoUnits(rank) => {
            let limit = format!("fibre type of rank {rank}: the discrete modes need the number");
            refused("units", "(missing)", &limit)
        }
        RunError::UnitCount(count) => {
            let limit = format!("must be at most {}", host_sim::engine::MOST_UNITS);
            refused("units", &count.to_string(), &limit)
        }
        error => PyValueError::new_err(error.to_string()),
    }
}

/// A muscle file, name or dict that is refused.
pub fn muscle_file(error: MuscleFileError) -> PyErr {
    match error {
        MuscleFileError::Value { path, line, key, value, limit } => {
            let line = line.map_or(String::new(), |line| format!(", line {line}"));
            refused_at(&format!("{}{line}", path.display()), &key, &value, &limit)
        }
        MuscleFileError::Unknown(path) => {
            let names: Vec<String> =
                host_sim::muscles::all().into_iter().map(|muscle| muscle.name).collect();
            let limit = format!("must be a file, or one of {}", names.join(", "));
            refused("muscle", &path.display().to_string(), &limit)
        }
        error @ MuscleFileError::Read { .. } => PyOSError::new_err(error.to_string()),
        MuscleFileError::Parse { path, message } => {
            refused("muscle", &path.display().to_string(), &message)
        }
    }
}

/// A fit that is refused.
pub fn fit(error: FitError) -> PyErr {
    match error {
        FitError::Muscle(error) => muscle_file(error),
        FitError::Recording(TraceError::Cell { path, line, column, problem }) => {
            let place = format!("{}, line {line}", path.display());
            refused_at(&place, &column, "recording", &problem)
        }
        FitError::Recording(error @ TraceError::File { .. }) => {
            PyOSError::new_err(error.to_string())
        }
        FitError::Trials { path, problem } => {
            refused("trials", &path.display().to_string(), &problem)
        }
        FitError::Start { source, .. } => run(source),
        error => PyValueError::new_err(error.to_string()),
    }
}
