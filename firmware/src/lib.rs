//! The stimulator controller's logic, free of any chip: testable on a host.
//!
//! [`Schedule`] says which channel's [`Pulse`] comes when, and [`OutputStage`] puts it out over
//! `embedded-hal`. [`Rig::tick`] is what the 1 kHz interrupt runs; where its inputs come from and where its
//! results go are the [`Inputs`] and [`Record`] it is given.
#![no_std]

mod controller;
#[cfg(feature = "board")]
pub mod end;
mod output;
mod rig;
pub mod safety;
mod scenario;
mod schedule;
mod stimulus;
mod waveform;

pub use controller::Controller;
pub use output::{Bridge, OutputError, OutputStage};
pub use rig::{Arithmetic, Inputs, MUSCLE, Record, Rig, frame_words};
pub use scenario::{Scenario, TICKS};
pub use schedule::{Schedule, Step};
pub use stimulus::{Scale, Stimulus, StimulusError};
pub use waveform::{Direction, Phase, Pulse};
