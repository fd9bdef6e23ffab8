//! A step of the pulse timer.

use crate::between::waveform::Phase;
use crate::config::SHORTEST_TICK_US;

/// Output until the next call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The channel and its current; none between pulses.
    pub output: Option<(usize, Phase)>,
    /// Duration, µs; [`LEAST_PHASE_US`](crate::LEAST_PHASE_US) to [`Step::LONGEST_US`].
    pub duration_us: u32,
}

impl Step {
    /// Longest step, µs: a quarter of the shortest tick. After each step plans and permission are
    /// checked.
    pub const LONGEST_US: u32 = SHORTEST_TICK_US / 4;
    /// Nothing for a while.
    pub const IDLE: Self = Self { output: None, duration_us: Self::LONGEST_US };
}
