//! The second level: steps the muscles and supervises.

pub(crate) mod angle_sensor;
pub(crate) mod angle_watch;
pub(crate) mod closed_loop;
pub(crate) mod controller;
pub(crate) mod deadline;
pub(crate) mod device;
pub(crate) mod dose;
pub(crate) mod placed_controller;
pub(crate) mod placed_muscle;
pub mod safety;
pub mod watchdog;
