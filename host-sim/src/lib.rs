//! Host side of the muscle model: the independent reference, and the proof of accuracy.

pub mod arm;
pub mod chart;
pub mod coefficients;
pub mod command_line;
pub mod cycles;
pub mod engine;
pub mod figures;
pub mod fit;
pub mod golden;
pub mod hil;
pub mod link;
pub mod measured;
pub mod metrics;
pub mod muscle_file;
pub mod muscles;
pub mod output_file;
mod progress;
pub mod readme;
pub mod reference;
pub mod report;
pub mod scenario;
pub mod stack;
pub mod sweep;
pub mod target;
pub mod tolerance;
pub mod trace;
pub mod verify;
