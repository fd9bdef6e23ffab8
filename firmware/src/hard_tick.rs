//! The second level: steps the muscles and supervises.

pub(crate) mod controller;
pub(crate) mod deadline;
pub(crate) mod device;
pub(crate) mod placed_muscle;
pub mod safety;
pub mod watchdog;
