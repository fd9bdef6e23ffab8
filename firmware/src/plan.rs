//! What all channels do together, checked before the pulse timer has anything to do with it.

use crate::stimulus::{Scale, Stimulus, StimulusError, within};
use crate::waveform::Pulse;

/// Share of the time that pulses of all channels may take, thousandths: what is left makes up for waiting.
const MOST_LOAD: u32 = 900;

/// The pulses of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Train {
    pub(crate) pulse: Pulse,
    /// From the start of a pulse to that of the next, µs.
    pub(crate) period_us: u32,
}

/// What all channels do; nothing in it can be refused any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan<const CHANNELS: usize> {
    pub(crate) trains: [Option<Train>; CHANNELS],
}

impl<const CHANNELS: usize> Plan<CHANNELS> {
    /// No pulses on any channel.
    pub const NOTHING: Self = Self { trains: [None; CHANNELS] };

    /// The plan of what is wanted of each channel. Refused with field, value and limit if the stimulator cannot
    /// do one of them, or not all of them one at a time.
    pub fn new(
        wanted: &[Option<Stimulus>; CHANNELS],
        scale: &Scale,
    ) -> Result<Self, StimulusError> {
        let mut plan = Self::NOTHING;
        let mut load = 0;
        for (train, stimulus) in plan.trains.iter_mut().zip(wanted) {
            let Some(stimulus) = stimulus else { continue };
            let pulse = Pulse::new(stimulus, scale)?;
            let period_us = stimulus.period_us();
            load += (stimulus.duration_us() * 1000).div_ceil(period_us.max(1));
            *train = Some(Train { pulse, period_us });
        }
        within("load: thousandths of the time", load, 0, MOST_LOAD)?;
        Ok(plan)
    }
}
