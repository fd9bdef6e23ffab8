//! What all channels do together, checked before the pulse timer has anything to do with it.

use crate::guarded::{Guarded, Sum};
use crate::limits::{Limits, SHORTEST_TICK_US};
use crate::safety::CHANNELS;
use crate::schedule::Step;
use crate::stimulus::{LONGEST_PULSE_US, Scale, Stimulus, StimulusError, period_us, within};
use crate::waveform::Pulse;
use heapless::spsc::Queue;
use vm_nostd::Checksum;

/// Share of the time that pulses of all channels may take, thousandths: what is left makes up for waiting.
const MOST_LOAD: u32 = 900;

/// Plans on their way from the tick to the pulse timer.
pub type PlanQueue = Queue<Guarded<Plan<CHANNELS>>, PLAN_QUEUE>;

/// Places of that queue. The pulse timer reads it at the start of each step without current, so that for the longest
/// pulse, and the step before it, no plan is read while each tick may bring one. A queue keeps one place free.
const PLAN_QUEUE: usize = {
    let unread_us = LONGEST_PULSE_US + Step::LONGEST_US;
    unread_us.div_ceil(SHORTEST_TICK_US) as usize + 2
};

/// The pulse train of a channel, of a stimulus that was validated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Train {
    /// Of the phase that stimulates: what was asked for.
    counts: u16,
    /// Of that phase, µs.
    pub(crate) width_us: u16,
    gap_us: u16,
    recovery: u8,
    /// From the start of a pulse to that of the next, µs.
    pub(crate) period_us: u32,
}

impl Train {
    /// A pulse of it, of at most so many counts.
    pub(crate) fn pulse(&self, most: u16) -> Pulse {
        Pulse::of(self.counts.min(most), self.width_us, self.gap_us, self.recovery)
    }
}

impl Sum for Train {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { counts, width_us, gap_us, recovery, period_us } = *self;
        checksum.add(u32::from(counts) << 16 | u32::from(width_us));
        checksum.add(u32::from(gap_us) << 16 | u32::from(recovery));
        checksum.add(period_us);
    }
}

/// What all channels do; nothing in it can be refused any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan<const CHANNELS: usize> {
    pub(crate) trains: [Option<Train>; CHANNELS],
    /// How many counts an amplitude may rise by from one pulse of a channel to the next.
    pub(crate) rise: u16,
    /// No pulse of a channel comes sooner after the one before, µs, also where it makes up for waiting.
    pub(crate) least_period_us: u32,
}

impl<const CHANNELS: usize> Plan<CHANNELS> {
    /// No pulses on any channel.
    pub const NOTHING: Self = Self { trains: [None; CHANNELS], rise: 0, least_period_us: 0 };

    /// Whether no channel has a train.
    pub(crate) fn is_nothing(&self) -> bool {
        self.trains.iter().all(Option::is_none)
    }

    /// The plan of what is wanted of each channel, whose amplitudes rise, and whose pulses follow each other, no
    /// faster than the limits say. Refused with field, value and limit if the stimulator cannot do one of them, or
    /// not all of them one at a time.
    pub fn new(
        wanted: &[Option<Stimulus>; CHANNELS],
        scale: &Scale,
        limits: &Limits,
    ) -> Result<Self, StimulusError> {
        let rise = scale.counts_of(limits.rise_ua);
        let least_period_us = period_us(limits.frequency_tenths_pps);
        let mut plan = Self { rise, least_period_us, ..Self::NOTHING };
        let mut load = 0;
        for (train, stimulus) in plan.trains.iter_mut().zip(wanted) {
            let Some(stimulus) = stimulus else { continue };
            stimulus.validate(scale)?;
            let Stimulus { amplitude_ua, width_us, gap_us, recovery, .. } = *stimulus;
            let period_us = stimulus.period_us();
            load += (stimulus.duration_us() * 1000).div_ceil(period_us.max(1));
            let counts = scale.counts_of(amplitude_ua);
            *train = Some(Train { counts, width_us, gap_us, recovery, period_us });
        }
        within("load: thousandths of the time", load, 0, MOST_LOAD)?;
        Ok(plan)
    }
}

impl<const CHANNELS: usize> Sum for Plan<CHANNELS> {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { trains, rise, least_period_us } = self;
        trains.sum(checksum);
        checksum.add((*rise).into());
        checksum.add(*least_period_us);
    }
}
