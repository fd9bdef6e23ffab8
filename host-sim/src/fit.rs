//! Fits the numbers of a muscle file to recordings, with the uncertainty of each number.
//!
//! Non-linear least squares by Levenberg and Marquardt's method (crate `levenberg-marquardt`, after
//! MINPACK) from several starts. The format of the file that lists recordings and free parameters
//! is in `docs/trials.md`.

mod error;
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

pub use error::FitError;
pub use keys::Key;
pub use outcome::{CONFIRMED, Confirmed, Fit, TrialFit, fit, fit_until};
pub use page::{PageError, page};
pub use parameters::{Parameter, Place, Prior, applied};
pub use priors::{Basis, Spread, spread};
pub use solve::Search;
pub use start::Start;
pub use statistics::{Estimate, Pair};
pub use trials::{Role, Trial, Trials};
pub use write::fitted_file;
