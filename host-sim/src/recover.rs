//! Parameter recovery: synthetic patients with known parameters are recorded with a protocol and
//! noise and fitted by the code of `vm fit`. Reports the errors of the estimates and the coverage
//! of their confidence intervals.
//!
//! The protocol and the results are in `docs/fitting.md`.

mod bout;
mod list;
mod patient;
mod protocol;
mod study;
mod summary;

pub use bout::{Bout, Setting};
pub use list::{Free, free, list};
pub use patient::{Patient, PatientError};
pub use protocol::{LIST, WriteError, bouts, stimulated, write};
pub use study::Study;
pub use summary::{Recovered, Summary, summaries, text};

/// Default mean muscle of the patients.
pub const MUSCLE: &str = include_str!("../data/recovery_muscle.toml");
