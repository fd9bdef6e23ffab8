//! The firmware's rig and scenario by their files: its queues do not build on RV32IMC, which has no
//! atomics.
#![no_std]

#[path = "../../../firmware/src/rig.rs"]
mod rig;
#[path = "../../../firmware/src/scenario.rs"]
mod scenario;

pub use rig::{Arithmetic, Inputs, MUSCLE, Record, Rig, frame_words};
pub use scenario::{Scenario, TICKS};
