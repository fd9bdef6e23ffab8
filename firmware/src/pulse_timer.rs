//! The first level: the pulse that is due.

pub(crate) mod output;
pub(crate) mod pulses;
pub(crate) mod schedule;
