//! Proof by recovery: muscles whose parameters are known are recorded by a protocol, with noise,
//! and fitted by the code of `vm fit`; how far what it finds is from what they are, and how often
//! its intervals hold it.
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
pub use protocol::{WriteError, bouts, stimulated, write};
pub use study::Study;
pub use summary::{Recovered, Summary, summaries, text};

/// The mean of the patients, where no other muscle is named.
pub const MUSCLE: &str = include_str!("../data/recovery_muscle.toml");
