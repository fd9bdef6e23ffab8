//! Controllers of stimulation in closed loop, on patients that differ from the model.
//!
//! The plant is the model in `f64` with parameters that the controllers do not know and structure
//! that they do not have ([`Patient`], [`Plant`]). The controllers compared are PI on pulse
//! width, PI and PID through a static recruitment curve, and that of `vm_nostd::control` in `f32`
//! and fixed point. All are tuned by the same tuner with the same number of evaluations, on
//! patients that are not scored; fixed point takes the settings tuned in `f32`.

mod controller;
mod patient;
mod percentile;
mod picture;
mod plant;
mod random;
mod study;
mod task;
mod trial;
mod tuner;

pub use controller::{AMPLITUDE, Controller, GREATEST_WIDTH, Kind, Settings, params};
pub use patient::{ELECTRODE, Patient};
pub use picture::picture;
pub use plant::Plant;
pub use study::{COLUMNS, Row, Study, StudyError, run};
pub use task::{Motion, Task};
pub use trial::{Instant, Score, Trial};
pub use tuner::Tuned;
