//! A muscle of one's own: the numbers of a muscle file fitted to recordings, and what the
//! recordings can and cannot tell of them.
//!
//! Non-linear least squares by Levenberg and Marquardt's method (crate `levenberg-marquardt`, after
//! MINPACK) from several starts. The shape of the file that lists recordings and free parameters is
//! in `docs/trials.md`.

mod keys;
mod outcome;
mod page;
mod parameters;
mod priors;
mod problem;
mod recording;
mod signal;
mod solve;
mod start;
mod statistics;
mod trials;
mod write;

pub use keys::Key;
pub use outcome::{CONFIRMED, Confirmed, Fit, TrialFit, fit};
pub use page::{PageError, page};
pub use parameters::{Parameter, Place, Prior, applied};
pub use priors::{Basis, Spread, spread};
pub use solve::Search;
pub use start::Start;
pub use statistics::{Estimate, Pair};
pub use trials::{Role, Trial, Trials};
pub use write::fitted_file;

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
