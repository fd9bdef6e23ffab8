//! Which channel's pulse comes when: one at a time, the one that is due first, none cut short.
//!
//! Driven by a hardware timer: [`Schedule::advance`] says what to put out and when to be called again. A pulse that
//! is due while another is running starts when that has ended: it waits for at most one pulse of every other channel.
//! The one after it is due as if it had not been late, but never closer than half a period.

use crate::plan::{Plan, Train};
use crate::stimulus::LEAST_PHASE_US;
use crate::waveform::{Phase, Pulse};

/// What the output stage is to do until the next call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The channel and its current; none between pulses.
    pub output: Option<(usize, Phase)>,
    /// How long, µs; [`LEAST_PHASE_US`] to [`Step::LONGEST_US`].
    pub duration_us: u32,
}

impl Step {
    /// No step is longer, µs: at its end, whoever drives the schedule looks for what has changed.
    pub const LONGEST_US: u32 = 500;
    /// Nothing for a while.
    pub const IDLE: Self = Self { output: None, duration_us: 250 };
}

#[derive(Clone, Copy, Debug)]
struct Channel {
    /// None while the channel is off; its rhythm goes on, or off and on again would be a way round frequencies.
    pulse: Option<Pulse>,
    period_us: u32,
    /// From now until the next pulse is due, µs; negative once it is.
    due_us: i32,
}

/// A pulse on its way.
#[derive(Clone, Copy, Debug)]
struct Running {
    channel: usize,
    /// As it was when it began.
    pulse: Pulse,
    /// Index of the phase that comes, and what is left of it, µs.
    phase: usize,
    left_us: u32,
}

/// The pulses of all channels.
#[derive(Clone, Copy, Debug)]
pub struct Schedule<const CHANNELS: usize> {
    channels: [Option<Channel>; CHANNELS],
    running: Option<Running>,
    /// A pulse has ended, and nothing is put out for the shortest of steps: there is a time for new plans.
    rests: bool,
}

impl<const CHANNELS: usize> Default for Schedule<CHANNELS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const CHANNELS: usize> Schedule<CHANNELS> {
    /// No channel does anything.
    pub const fn new() -> Self {
        Self { channels: [None; CHANNELS], running: None, rests: false }
    }

    /// Follows another plan from each channel's next pulse on. A pulse that is running ends as it began.
    pub fn follow(&mut self, plan: &Plan<CHANNELS>) {
        for (place, train) in self.channels.iter_mut().zip(&plan.trains) {
            *place = match *train {
                None => place.map(|before| Channel { pulse: None, ..before }),
                Some(Train { pulse, period_us }) => {
                    // A rhythm goes on; a new one, or one that has been off for long, begins at once.
                    let due_us = place.map_or(0, |before| {
                        // Periods are a second at most.
                        let due_us = before.due_us.min(period_us as i32);
                        if before.pulse.is_some() { due_us } else { due_us.max(0) }
                    });
                    Some(Channel { pulse: Some(pulse), period_us, due_us })
                }
            };
        }
    }

    /// Forgets everything, the pulse that is running as well: what is put out next is nothing.
    pub fn halt(&mut self) {
        *self = Self::new();
    }

    /// Whether nothing will come by itself.
    pub fn is_idle(&self) -> bool {
        self.running.is_none() && self.channels.iter().flatten().all(|one| one.pulse.is_none())
    }

    /// What is put out now, and for how long. To be called when the last step has lasted as long as it said.
    pub fn advance(&mut self) -> Step {
        let step = match self.phase() {
            Some(step) => {
                self.rests = true;
                step
            }
            None if core::mem::take(&mut self.rests) => {
                Step { output: None, duration_us: LEAST_PHASE_US }
            }
            None => {
                let step = self.start();
                self.rests = step.output.is_some();
                step
            }
        };
        for channel in self.channels.iter_mut().flatten() {
            // A step is short, and a pulse is late by less than a second.
            channel.due_us = channel.due_us.saturating_sub(step.duration_us as i32);
        }
        step
    }

    /// What is left of the pulse that is running.
    fn phase(&mut self) -> Option<Step> {
        let mut running = self.running.take()?;
        while let Some(&phase) = running.pulse.phases.get(running.phase) {
            let left_us = running.left_us;
            let duration_us = if left_us <= Step::LONGEST_US {
                running.phase += 1;
                running.left_us = duration(&running.pulse, running.phase);
                left_us
            } else {
                // Neither piece may be shorter than the shortest phase.
                let piece_us = Step::LONGEST_US.min(left_us - LEAST_PHASE_US);
                running.left_us = left_us - piece_us;
                piece_us
            };
            if duration_us > 0 {
                self.running = Some(running);
                return Some(Step { output: Some((running.channel, phase)), duration_us });
            }
        }
        None
    }

    /// The first phase of the pulse that is due first, or nothing until one is.
    fn start(&mut self) -> Step {
        let mut first: Option<(i32, usize)> = None;
        for (index, channel) in self.channels.iter().enumerate() {
            if let Some(Channel { pulse: Some(_), due_us, .. }) = channel
                && first.is_none_or(|(earliest_us, _)| *due_us < earliest_us)
            {
                first = Some((*due_us, index));
            }
        }
        match first {
            Some((due_us, channel)) if due_us <= 0 => {
                if let Some(Some(one)) = self.channels.get_mut(channel)
                    && let Some(pulse) = one.pulse
                {
                    // What was late makes up for it in part: two pulses are never closer than half a period.
                    let period_us = one.period_us as i32;
                    one.due_us = (one.due_us + period_us).max(period_us / 2);
                    let left_us = duration(&pulse, 0);
                    self.running = Some(Running { channel, pulse, phase: 0, left_us });
                }
                self.phase().unwrap_or(Step::IDLE)
            }
            // Not exactly when it is due, if that is very soon: a step has its shortest length.
            Some((due_us, _)) => {
                let duration_us = (due_us as u32).clamp(LEAST_PHASE_US, Step::IDLE.duration_us);
                Step { output: None, duration_us }
            }
            None => Step::IDLE,
        }
    }
}

/// Of a phase, µs; nothing after the last.
fn duration(pulse: &Pulse, phase: usize) -> u32 {
    pulse.phases.get(phase).map_or(0, |phase| phase.duration_us.into())
}
