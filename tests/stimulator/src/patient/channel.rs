//! A channel as its electrodes have felt it, and what was asked of it.

use firmware::Stimulus;
use std::collections::VecDeque;

pub(super) const SECOND_US: u64 = 1_000_000;

/// A pulse as it was put out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pulse {
    pub begun_us: u64,
    pub counts: u16,
    pub width_us: u64,
}

/// What a channel was asked for, and until when.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub stimulus: Stimulus,
    pub until_us: u64,
}

impl Asked {
    /// Whether it asks for current.
    pub fn asks_at(&self, now_us: u64) -> bool {
        self.until_us > now_us && self.stimulus.amplitude_ua > 0
    }

    /// From the start of a pulse to that of the next, µs, as the frequency says.
    pub fn period_us(&self) -> u64 {
        10_000_000 / u64::from(self.stimulus.frequency_tenths_pps.max(1))
    }
}

/// A channel.
#[derive(Debug, Default)]
pub(super) struct Channel {
    /// Of the last second and a bit.
    pub pulses: VecDeque<Pulse>,
    /// The last pulse since the stimulator was last off: what the next may rise from.
    pub last: Option<Pulse>,
    /// Counts times µs since charge was last even.
    pub charge: i64,
    /// When phases of the last second ended, and their squares of counts times µs; and the sum of
    /// these.
    heat: VecDeque<(u64, u64)>,
    heat_sum: u64,
    pub asked: VecDeque<Asked>,
    /// The shortest period that was asked for since the last pulse.
    pub period_us: u64,
}

impl Channel {
    /// A phase has ended. The mean square of a second, the strongest pulse in it aside: a second
    /// may have a pulse more than its frequency says.
    pub fn heats(&mut self, now_us: u64, square: u64, most: u64) -> Result<(), String> {
        self.heat.push_back((now_us, square));
        self.heat_sum += square;
        while let Some(&(ended_us, square)) = self.heat.front()
            && ended_us + SECOND_US <= now_us
        {
            self.heat.pop_front();
            self.heat_sum -= square;
        }
        if self.heat_sum <= most * SECOND_US {
            return Ok(());
        }
        // A pulse has two phases, or more steps.
        let strongest = self.heat.iter().map(|(_, square)| square).max().copied().unwrap_or(0);
        if self.heat_sum - 2 * strongest <= most * SECOND_US {
            return Ok(());
        }
        Err(format!("{} counts squared, mean of a second", self.heat_sum / SECOND_US))
    }
}
