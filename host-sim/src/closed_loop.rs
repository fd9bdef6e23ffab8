//! Controllers of stimulation in closed loop, on patients that differ from the model.
//!
//! The plant is the model in `f64` with parameters that the controllers do not know and structure
//! that they do not have ([`Patient`], [`Plant`]). Three controllers are compared, each tuned by
//! the same tuner with the same number of evaluations on patients that are not scored: PI on pulse
//! width, PI through a static recruitment curve, and the controller of `vm_nostd::control`.

mod controller;
mod patient;
mod percentile;
mod plant;
mod random;
mod study;
mod task;
mod trial;
mod tuner;

pub use controller::{Controller, Kind, Settings};
pub use patient::Patient;
pub use plant::Plant;
pub use study::{Row, Study, StudyError, run};
pub use task::Task;
pub use trial::{Instant, Score, Trial};
pub use tuner::Tuned;
