//! Which channel's pulse comes when: one at a time, the one that is due first, none cut short.
//!
//! Driven by a hardware timer: [`Schedule::advance`] says what to put out and when to be called again. A pulse that
//! is due while another is running starts when that has ended, so that it is late by at most one pulse of every
//! other channel; the one after it is due as if it had not been late.

use crate::stimulus::{Scale, Stimulus, StimulusError, within};
use crate::waveform::{Phase, Pulse};

/// What the output stage is to do until the next call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// The channel and its current; none between pulses.
    pub output: Option<(usize, Phase)>,
    /// How long, µs; at least 1.
    pub duration_us: u32,
}

/// Between pulses, new stimuli are looked for so often, µs.
const IDLE_US: u32 = 250;
/// Share of the time that pulses of all channels may take, thousandths: what is left makes up for waiting.
const MOST_LOAD: u32 = 900;

#[derive(Clone, Copy, Debug)]
struct Channel {
    /// None while the channel is off; its rhythm goes on, or off and on again would be a way round frequencies.
    pulse: Option<Pulse>,
    period_us: u32,
    duration_us: u32,
    /// From now until the next pulse is due, µs; negative once it is.
    due_us: i32,
}

/// The pulses of all channels.
#[derive(Clone, Copy, Debug)]
pub struct Schedule<const CHANNELS: usize> {
    scale: Scale,
    channels: [Option<Channel>; CHANNELS],
    /// The channel, its pulse as it was when it began, and its next phase.
    running: Option<(usize, Pulse, usize)>,
}

impl<const CHANNELS: usize> Schedule<CHANNELS> {
    /// No channel does anything.
    pub const fn new(scale: Scale) -> Self {
        Self { scale, channels: [None; CHANNELS], running: None }
    }

    /// Sets what a channel does from its next pulse on, or refuses and leaves it as it was; `None` for no more
    /// pulses. A pulse that is running ends as it began.
    pub fn set(&mut self, channel: usize, stimulus: Option<Stimulus>) -> Result<(), StimulusError> {
        within("channel", channel as u32, 0, CHANNELS.saturating_sub(1) as u32)?;
        let Some(place) = self.channels.get(channel) else { return Ok(()) };
        let wanted = match stimulus {
            None => place.map(|before| Channel { pulse: None, ..before }),
            Some(stimulus) => {
                let pulse = Pulse::new(&stimulus, &self.scale)?;
                let (period_us, duration_us) = (stimulus.period_us(), stimulus.duration_us());
                let others =
                    self.channels.iter().enumerate().filter(|(other, _)| *other != channel);
                let load = others.filter_map(|(_, one)| *one).map(|one| one.load()).sum::<u32>();
                let added = Channel { pulse: Some(pulse), period_us, duration_us, due_us: 0 };
                within("load: thousandths of the time", load + added.load(), 0, MOST_LOAD)?;
                // A rhythm goes on; a new one, or one that has been off for long, begins at once.
                let due_us = place.map_or(0, |before| {
                    let due_us = before.due_us.min(period_us as i32);
                    if before.pulse.is_some() { due_us } else { due_us.max(0) }
                });
                Some(Channel { due_us, ..added })
            }
        };
        if let Some(place) = self.channels.get_mut(channel) {
            *place = wanted;
        }
        Ok(())
    }

    /// Forgets all stimuli, and the pulse that is running: what is put out next is nothing.
    pub fn halt(&mut self) {
        self.channels = [None; CHANNELS];
        self.running = None;
    }

    /// What is put out now, and for how long. To be called when the last step has lasted as long as it said.
    pub fn advance(&mut self) -> Step {
        let step = self.phase().unwrap_or_else(|| self.start());
        for channel in self.channels.iter_mut().flatten() {
            // A step lasts 8 ms at most, and a pulse is late by less than a second.
            channel.due_us = channel.due_us.saturating_sub(step.duration_us as i32);
        }
        step
    }

    /// The next phase of the pulse that is running.
    fn phase(&mut self) -> Option<Step> {
        let (channel, pulse, mut index) = self.running.take()?;
        while let Some(&phase) = pulse.phases.get(index) {
            index += 1;
            if phase.duration_us > 0 {
                self.running = Some((channel, pulse, index));
                let duration_us = phase.duration_us.into();
                return Some(Step { output: Some((channel, phase)), duration_us });
            }
        }
        None
    }

    /// The first phase of the pulse that is due first, or nothing until one is.
    fn start(&mut self) -> Step {
        let of_channel = |(index, channel): (usize, &Option<Channel>)| {
            channel.filter(|channel| channel.pulse.is_some()).map(|channel| (channel.due_us, index))
        };
        let first = self.channels.iter().enumerate().filter_map(of_channel).min();
        match first {
            Some((due_us, index)) if due_us <= 0 => {
                if let Some(channel) = self.channels.get_mut(index).and_then(Option::as_mut) {
                    channel.due_us += channel.period_us as i32;
                    self.running = channel.pulse.map(|pulse| (index, pulse, 0));
                }
                self.phase().unwrap_or(Step { output: None, duration_us: 1 })
            }
            Some((due_us, _)) => Step { output: None, duration_us: (due_us as u32).min(IDLE_US) },
            None => Step { output: None, duration_us: IDLE_US },
        }
    }
}

impl Channel {
    /// Share of the time that its pulses take, thousandths, rounded up.
    fn load(&self) -> u32 {
        if self.pulse.is_none() {
            return 0;
        }
        (self.duration_us * 1000).div_ceil(self.period_us.max(1))
    }
}
