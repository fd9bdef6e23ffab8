//! Plan of all channels, validated before the pulse timer gets it.

use crate::between::guarded::{Guarded, Sum};
use crate::between::limits::Limits;
use crate::between::step::Step;
use crate::between::stimulus::{
    LONGEST_PULSE_US, Scale, Stimulus, StimulusError, period_us, within,
};
use crate::between::waveform::Pulse;
use crate::config::{CHANNELS, SHORTEST_TICK_US};
use heapless::spsc::Queue;
use vm_nostd::Checksum;

/// Largest share of time for pulses of all channels, thousandths; the rest lets late pulses catch
/// up.
const MOST_LOAD: u32 = 900;

/// Queue of plans from tick to pulse timer.
pub type PlanQueue = Queue<Guarded<Plan<CHANNELS>>, PLAN_QUEUE>;

/// Capacity of that queue: one plan per tick during the longest pulse and the step before it, when
/// the pulse timer does not read it, and one more if it is late. A queue keeps one place free.
const PLAN_QUEUE: usize = {
    let unread_us = LONGEST_PULSE_US + Step::LONGEST_US;
    unread_us.div_ceil(SHORTEST_TICK_US) as usize + 2
};

/// Pulse train of a validated stimulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Train {
    /// Requested counts of the stimulating phase.
    counts: u16,
    /// Width of that phase, µs.
    pub(crate) width_us: u16,
    gap_us: u16,
    recovery: u8,
    /// Period, µs.
    pub(crate) period_us: u32,
}

impl Train {
    /// A pulse of the train, of at most `most` counts.
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

/// Validated plan of all channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan<const CHANNELS: usize> {
    pub(crate) trains: [Option<Train>; CHANNELS],
    /// Greatest rise from one pulse of a channel to the next, counts.
    pub(crate) rise: u16,
    /// Least time between pulses of a channel, µs, also when catching up.
    pub(crate) least_period_us: u32,
}

impl<const CHANNELS: usize> Plan<CHANNELS> {
    /// No pulses on any channel.
    pub const NOTHING: Self = Self { trains: [None; CHANNELS], rise: 0, least_period_us: 0 };

    /// Whether it has no pulse train.
    pub(crate) fn is_nothing(&self) -> bool {
        self.trains.iter().all(Option::is_none)
    }

    /// The plan of each channel's stimulus, with rise and frequency within the limits. The error
    /// has field, value and limit, if the stimulator cannot do one of them or not all of them one
    /// at a time.
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
