//! A planar arm of two joints and six muscles (figure 3 of the paper).
//!
//! Source of the experiment: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, section 3.
//! The paper does not list the arm's parameters; `host-sim/data/arm.toml` has their sources.

mod data;
mod outcome;
mod simulation;
mod skeleton;

pub use data::{Arm, ArmMuscle, Group};
pub use outcome::{Outcome, Swings};
pub use simulation::{Activations, ArmError, Drive, Moment, run};
pub use skeleton::{Joints, Segment, Skeleton};
