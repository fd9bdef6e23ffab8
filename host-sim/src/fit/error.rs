//! Why there is no fitted muscle.

use crate::engine::RunError;
use crate::muscle_file::MuscleFileError;
use crate::trace::TraceError;
use std::path::PathBuf;

/// Why there is no fitted muscle.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The muscle to start from was refused.
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
        /// Key, value and limit, or what TOML found wrong.
        problem: String,
    },
    /// The muscle to start from cannot be run on a trial.
    #[error("trial \"{trial}\": {source}")]
    Start {
        /// The trial.
        trial: String,
        /// Why.
        source: RunError,
    },
    /// No start came to an end.
    #[error("none of {0} starts led anywhere: {1}")]
    NoSolution(usize, String),
    /// The recordings do not determine these parameters, and they have no prior.
    #[error(
        "not determined by the recordings: {}; give a prior, other recordings, or leave them as they are",
        .0.join(", ")
    )]
    Undetermined(Vec<String>),
}
