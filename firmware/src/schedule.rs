//! Which channel's pulse comes when: one at a time, the one that is due first, none cut short.
//!
//! Driven by a hardware timer: [`Schedule::advance`] says what to put out and when to be called again. A pulse that
//! is due while another is running starts when that has ended: it waits for at most one pulse of every other channel.
//! The one after it is due as if it had not been late, but never closer than half a period, nor than the limit on
//! frequencies allows.
//!
//! An amplitude rises from nothing, and by no more from one pulse of a channel to the next than the plan says. What
//! counts is what was put out: how often, and how, a host asks makes no difference.

use crate::guarded::Guarded;
use crate::limits::SHORTEST_TICK_US;
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
    /// No step is longer, µs: a quarter of the shortest tick. At its end, whoever drives the schedule looks for what has
    /// changed, and whether the tick still allows current.
    pub const LONGEST_US: u32 = SHORTEST_TICK_US / 4;
    /// Nothing for a while.
    pub const IDLE: Self = Self { output: None, duration_us: Self::LONGEST_US };
}

/// What a channel has put out, which outlasts every halt: off and on again is no way round a frequency.
#[derive(Clone, Copy, Debug)]
struct Rhythm {
    /// From now until the next pulse may come, µs; negative once it may.
    due_us: i32,
    /// The period that `due_us` counts down, µs.
    period_us: i32,
    /// Since the last pulse began, µs.
    since_us: i32,
    /// Counts of the last pulse; none of a channel that has been off since.
    counts: u16,
    /// Width of the last pulse, µs.
    width_us: u16,
}

impl Rhythm {
    /// Without a pulse: due at once, whatever the period.
    const NONE: Self = Self { due_us: 0, period_us: 0, since_us: i32::MAX, counts: 0, width_us: 0 };

    /// The most counts of a next pulse of that width. Charge stimulates: a pulse that becomes wider becomes weaker
    /// first.
    fn reach(&self, rise: u16, width_us: u16) -> u16 {
        let counts = if width_us > self.width_us {
            let charge = u32::from(self.counts) * u32::from(self.width_us);
            // No more than the counts, for the width is less.
            (charge / u32::from(width_us)) as u16
        } else {
            self.counts
        };
        counts.saturating_add(rise)
    }
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
    plan: Guarded<Plan<CHANNELS>>,
    rhythms: [Rhythm; CHANNELS],
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
    pub fn new() -> Self {
        Self {
            plan: Guarded::new(Plan::NOTHING),
            rhythms: [Rhythm::NONE; CHANNELS],
            running: None,
            rests: false,
        }
    }

    /// Follows another plan from each channel's next pulse on. A pulse that is running ends as it began.
    pub fn follow(&mut self, plan: &Guarded<Plan<CHANNELS>>) {
        // One that memory has changed stays as it is, and starts nothing.
        if let (Some(new), Some(old)) = (plan.get(), self.plan.get()) {
            let trains = new.trains.iter().zip(&old.trains);
            for (rhythm, (train, before)) in self.rhythms.iter_mut().zip(trains) {
                match train {
                    None => rhythm.counts = 0,
                    // A rhythm goes on. Of another one, a pulse comes no sooner after the last than its own period
                    // says, or strong and rare pulses could take the places of weak and frequent ones.
                    Some(Train { period_us, .. }) => {
                        // Periods are ten seconds at most.
                        let period_us = *period_us as i32;
                        if before.is_none() || period_us != rhythm.period_us {
                            rhythm.due_us = period_us.saturating_sub(rhythm.since_us).max(0);
                            rhythm.period_us = period_us;
                        }
                    }
                }
            }
        }
        self.plan = *plan;
    }

    /// Whether memory holds the plan as it was made.
    pub fn is_intact(&self) -> bool {
        self.plan.get().is_some()
    }

    /// Stops every channel, the pulse that is running as well: what is put out next is nothing.
    pub fn halt(&mut self) {
        self.plan = Guarded::new(Plan::NOTHING);
        self.rhythms.iter_mut().for_each(|rhythm| rhythm.counts = 0);
        self.running = None;
        self.rests = false;
    }

    /// Whether nothing will come by itself.
    pub fn is_idle(&self) -> bool {
        self.running.is_none() && self.plan.get().is_none_or(Plan::is_nothing)
    }

    /// Nothing for a while, whatever is due: in place of [`Schedule::advance`].
    pub(crate) fn wait(&mut self) -> Step {
        self.pass(Step::IDLE)
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
        self.pass(step)
    }

    fn pass(&mut self, step: Step) -> Step {
        for rhythm in &mut self.rhythms {
            // A step is short.
            let duration_us = step.duration_us as i32;
            rhythm.due_us = rhythm.due_us.saturating_sub(duration_us);
            rhythm.since_us = rhythm.since_us.saturating_add(duration_us);
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
        let Some(plan) = self.plan.get() else { return Step::IDLE };
        let mut first: Option<(usize, &Train, &mut Rhythm)> = None;
        for (channel, (train, rhythm)) in plan.trains.iter().zip(&mut self.rhythms).enumerate() {
            if let Some(train) = train
                && first.as_ref().is_none_or(|(_, _, other)| rhythm.due_us < other.due_us)
            {
                first = Some((channel, train, rhythm));
            }
        }
        match first {
            Some((channel, train, rhythm)) if rhythm.due_us <= 0 => {
                let pulse = train.pulse(rhythm.reach(plan.rise, train.width_us));
                // What was late makes up for it in part: two pulses are never closer than half a period, nor than
                // the greatest frequency has them.
                let period_us = train.period_us as i32;
                let closest_us = (period_us / 2).max(plan.least_period_us as i32);
                rhythm.due_us = (rhythm.due_us + period_us).max(closest_us);
                rhythm.since_us = 0;
                rhythm.counts = pulse.counts();
                rhythm.width_us = train.width_us;
                let left_us = duration(&pulse, 0);
                self.running = Some(Running { channel, pulse, phase: 0, left_us });
                self.phase().unwrap_or(Step::IDLE)
            }
            // Not exactly when it is due, if that is very soon: a step has its shortest length.
            Some((_, _, rhythm)) => {
                let due_us = rhythm.due_us.unsigned_abs();
                let duration_us = due_us.clamp(LEAST_PHASE_US, Step::LONGEST_US);
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

#[cfg(test)]
mod tests {
    use super::{Schedule, Step};
    use crate::guarded::Guarded;
    use crate::limits::Limits;
    use crate::plan::Plan;
    use crate::stimulus::{Scale, Stimulus};

    const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };

    fn plan() -> Guarded<Plan<2>> {
        let stimulus = Stimulus {
            amplitude_ua: 10_000,
            width_us: 200,
            gap_us: 50,
            frequency_tenths_pps: 400,
            recovery: 1,
        };
        let plan =
            Plan::new(&[Some(stimulus), None], &SCALE, &Limits::SURFACE).expect("a legal command");
        Guarded::new(plan)
    }

    /// Counts that come within 0.2 s.
    fn most_counts(schedule: &mut Schedule<2>) -> u16 {
        (0..2_000)
            .map(|_| schedule.advance())
            .filter_map(|step: Step| step.output.map(|(_, phase)| phase.counts))
            .max()
            .unwrap_or(0)
    }

    #[test]
    fn a_plan_that_lost_a_bit_on_its_way_puts_nothing_out() {
        let mut schedule = Schedule::<2>::new();
        let mut waiting = plan();
        waiting.corrupt(|plan| plan.rise ^= 1);
        schedule.follow(&waiting);
        assert!(!schedule.is_intact());
        assert_eq!(most_counts(&mut schedule), 0);
    }

    #[test]
    fn a_plan_that_loses_a_bit_while_it_is_followed_starts_no_other_pulse() {
        let mut schedule = Schedule::<2>::new();
        schedule.follow(&plan());
        assert!(schedule.is_intact());
        assert!(most_counts(&mut schedule) > 0);
        while schedule.running.is_some() {
            schedule.advance();
        }
        schedule.plan.corrupt(|plan| {
            if let Some(Some(train)) = plan.trains.first_mut() {
                train.width_us ^= 1 << 9;
            }
        });
        assert!(!schedule.is_intact());
        assert_eq!(most_counts(&mut schedule), 0);
        // It is forgotten with a halt, and another one is followed.
        schedule.halt();
        assert!(schedule.is_intact());
        schedule.follow(&plan());
        assert!(most_counts(&mut schedule) > 0);
    }
}
