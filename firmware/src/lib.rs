//! The stimulator controller's logic, free of any chip: testable on a host.
//!
//! Three things run, each above the next and never waiting for it:
//!
//! 1. the pulse timer: [`Pulses`] puts out what [`Schedule`] says is due, for as long as the tick allows it;
//! 2. the hard tick: [`Device`] steps the muscles and supervises the stimulator;
//! 3. the link: [`Server`] takes what a host asks for, and gives back what the muscles do.
//!
//! Between the first two are a queue of [`Plan`]s and a [`Gate`], between the last two the queues of [`Lines`].
#![no_std]

#[cfg(any(test, feature = "explore"))]
extern crate std;

mod configuration;
mod controller;
mod deadline;
mod device;
mod driven;
#[cfg(feature = "board")]
pub mod end;
mod fault;
pub mod flash;
mod gate;
mod guarded;
mod limits;
mod lines;
pub mod link;
mod output;
mod plan;
mod pulses;
mod ram;
mod randomness;
mod rig;
pub mod safety;
mod scenario;
mod schedule;
mod server;
mod shared;
mod stimulus;
mod storage;
mod uploads;
pub mod watchdog;
mod waveform;

pub use configuration::{MUSCLES, TICK_US, TYPES};
pub use controller::Controller;
pub use deadline::Deadline;
pub use device::Device;
pub use gate::Gate;
pub use guarded::{Guarded, Sum};
pub use limits::{LimitError, Limits};
pub use lines::{Banks, Lines, LinkEnds, TickEnds};
pub use output::{Bridge, OutputError, OutputStage};
pub use plan::{Plan, PlanQueue};
pub use pulses::Pulses;
pub use ram::RamFlash;
pub use randomness::{Noise, NoiseGenerator, NoiseStatus, PollCount, Randomness};
pub use rig::{Arithmetic, Inputs, MUSCLE, Record, Rig, frame_words};
pub use scenario::{Scenario, TICKS};
pub use schedule::{Schedule, Step};
pub use server::{Server, ServerRoom};
#[cfg(feature = "explore")]
pub use shared::explore;
pub use stimulus::{LEAST_PHASE_US, Scale, Stimulus, StimulusError};
pub use storage::{MOST_STORED, NotStored, SlotBuffer, Slots};
pub use waveform::{Direction, Phase, Pulse};
