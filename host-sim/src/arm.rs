//! A planar arm of two joints and six muscles, to see what a muscle does in a limb that it moves: figure 3
//! of the paper.
//!
//! Source of the experiment: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, section 3; of the
//! arm, which the paper does not list: `host-sim/data/arm.toml`.

mod data;
mod outcome;
mod path;
mod simulation;
mod skeleton;

pub use data::{Arm, ArmMuscle, Group};
pub use outcome::{Outcome, Swings};
pub use path::PathPolynomial;
pub use simulation::{Activations, ArmError, Drive, Moment, run};
pub use skeleton::{Joints, Segment, Skeleton};
