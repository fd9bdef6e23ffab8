//! Host side of the muscle model: the independent reference, and the proof of accuracy.

pub mod coefficients;
pub mod reference;
