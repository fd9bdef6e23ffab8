//! What runs on emulated cores: two muscles and a scenario whose bits are compared with the host's,
//! and the programs of `vm cycles` and of the tests. Any core with the Rust target will do.
#![no_std]

mod rig;
mod scenario;

pub use rig::{Arithmetic, Inputs, MUSCLE, Record, Rig, frame_words};
pub use scenario::{Scenario, TICKS};
