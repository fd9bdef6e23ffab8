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

mod between;
mod config;
mod hard_tick;
pub mod link;
mod pulse_timer;

pub use between::guarded::{Guarded, Sum};
pub use between::limits::{LimitError, Limits};
pub use between::link_queues::{Banks, LinkEnds, LinkQueues, TickEnds};
pub use between::permission::Permission;
pub use between::plan::{Plan, PlanQueue};
#[cfg(feature = "explore")]
pub use between::shared::explore;
pub use between::step::Step;
pub use between::stimulus::{LEAST_PHASE_US, Scale, Stimulus, StimulusError};
pub use between::waveform::{Direction, Phase, Pulse};
pub use config::{MUSCLES, SCALE, TICK_US, TYPES};
pub use hard_tick::angle_sensor::{AngleSensor, HostSensor};
pub use hard_tick::controller::Controller;
pub use hard_tick::deadline::Deadline;
pub use hard_tick::device::Device;
pub use hard_tick::{safety, watchdog};
pub use link::flash;
pub use link::ram::RamFlash;
pub use link::randomness::{Noise, NoiseGenerator, NoiseStatus, PollCount, Randomness};
pub use link::server::{Server, ServerRoom};
pub use link::storage::{MOST_STORED, NotStored, SlotBuffer, Slots};
pub use pulse_timer::output::{Bridge, OutputError, OutputStage};
pub use pulse_timer::pulses::Pulses;
pub use pulse_timer::schedule::Schedule;
