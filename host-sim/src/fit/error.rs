//! Errors of a fit.

use crate::engine::RunError;
use crate::muscle_file::MuscleFileError;
use crate::trace::TraceError;
use std::path::PathBuf;

/// Why a fit failed.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The starting muscle was refused.
    #[error(transparent)]
    Muscle(#[from] MuscleFileError),
    /// A recording was refused.
    #[error(transparent)]
    Recording(#[from] TraceError),
    /// The list of trials was refused.
    #[error("{}: {problem}", path.display())]
    Trials {
        /// The file.
        path: PathBuf,
        /// Key, value and limit, or the TOML error.
        problem: String,
    },
    /// The starting muscle could not be run on a trial.
    #[error("trial \"{trial}\": {source}")]
    Start {
        /// The trial.
        trial: String,
        /// The error of the run.
        source: RunError,
    },
    /// The search converged from no start.
    #[error("the search converged from none of {0} starts: {1}")]
    NoSolution(usize, String),
    /// The recordings do not determine these parameters, and they have no prior.
    #[error(
        "not determined by the recordings: {}; give a prior, add recordings, or do not fit them",
        .0.join(", ")
    )]
    Undetermined(Vec<String>),
}

/// Makes an error of a problem in the list of trials.
pub(super) type Refuse<'a> = &'a dyn Fn(String) -> FitError;
