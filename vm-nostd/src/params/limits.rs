//! Limits of inputs and state that do not depend on parameters.

/// Greatest stimulation frequency, pps.
pub(crate) const MAXIMUM_STIMULATION_FREQUENCY: f64 = 500.0;
/// Greatest fascicle speed, L_ce0/s.
pub(crate) const MAXIMUM_SPEED: f64 = 60.0;
