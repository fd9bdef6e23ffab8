//! The stimulator controller's logic, free of any chip: testable on a host.
//!
//! [`Rig::tick`] is what the 1 kHz interrupt runs; where its inputs come from and where its
//! results go are the [`Inputs`] and [`Record`] it is given.
#![no_std]

#[cfg(feature = "board")]
pub mod end;
mod rig;
mod scenario;

pub use rig::{Arithmetic, Inputs, MUSCLE, Record, Rig, frame_words};
pub use scenario::{Scenario, TICKS};
