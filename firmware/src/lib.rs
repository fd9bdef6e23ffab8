//! Logic of the stimulator, independent of the chip and testable on a host.
//!
//! Three levels, each of which interrupts the next and never waits for it:
//!
//! 1. pulse timer: [`Pulses`] outputs the pulse that is due in [`Schedule`], while the tick permits
//!    it;
//! 2. hard tick: [`Device`] steps the muscles and supervises;
//! 3. link: [`Server`] takes a host's requests and returns the muscles' outputs.
//!
//! Between the first two are a queue of [`Plan`]s and a [`Permission`], between the last two the
//! queues of [`LinkQueues`].
#![no_std]

#[cfg(any(test, feature = "explore"))]
extern crate std;

mod configuration;
mod controller;
mod deadline;
mod device;
#[cfg(feature = "board")]
pub mod end;
mod fault;
pub mod flash;
mod guarded;
mod limits;
pub mod link;
mod link_queues;
mod output;
mod permission;
mod placed_muscle;
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
pub use guarded::{Guarded, Sum};
pub use limits::{LimitError, Limits};
pub use link_queues::{Banks, LinkEnds, LinkQueues, TickEnds};
pub use output::{Bridge, OutputError, OutputStage};
pub use permission::Permission;
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
