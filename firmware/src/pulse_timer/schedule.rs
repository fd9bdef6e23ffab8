//! Schedule of pulses: one at a time, earliest due first, none cut short.
//!
//! [`Schedule::advance`] returns the next step and its duration for a hardware timer. A pulse that
//! is due while another runs starts after it: it waits for at most one pulse of every other
//! channel. The next pulse is due as if the last had been on time, but no closer than half a period
//! or than the frequency limit allows.
//!
//! Amplitudes rise from zero, by at most the plan's rise per pulse. Only pulses that were put out
//! count, not how often a host asks.

use crate::between::guarded::Guarded;
use crate::between::plan::{Plan, Train};
use crate::between::step::Step;
use crate::between::stimulus::LEAST_PHASE_US;
use crate::between::waveform::Pulse;

/// Pulse history of a channel. It outlasts a halt, so that switching off and on cannot exceed the
/// frequency.
#[derive(Clone, Copy, Debug)]
struct Rhythm {
    /// Time until the next pulse may come, µs; negative when it may.
    due_us: i32,
    /// The period that `due_us` counts down, µs.
    period_us: i32,
    /// Time since the last pulse began, µs.
    since_us: i32,
    /// Counts of the last pulse; 0 after the channel was off.
    counts: u16,
    /// Width of the last pulse, µs.
    width_us: u16,
}

impl Rhythm {
    /// Without a pulse: due at once.
    const NONE: Self = Self { due_us: 0, period_us: 0, since_us: i32::MAX, counts: 0, width_us: 0 };

    /// Most counts of the next pulse of a width. A wider pulse starts weaker, because charge
    /// stimulates.
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

/// A running pulse.
#[derive(Clone, Copy, Debug)]
struct Running {
    channel: usize,
    /// The pulse as it began.
    pulse: Pulse,
    /// Index of the next phase, and its remaining time, µs.
    phase: usize,
    left_us: u32,
}

/// Schedule of all channels.
#[derive(Clone, Copy, Debug)]
pub struct Schedule<const CHANNELS: usize> {
    plan: Guarded<Plan<CHANNELS>>,
    rhythms: [Rhythm; CHANNELS],
    running: Option<Running>,
    /// A pulse has ended: one shortest step without current follows, in which plans are read.
    rests: bool,
}

impl<const CHANNELS: usize> Default for Schedule<CHANNELS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const CHANNELS: usize> Schedule<CHANNELS> {
    /// An idle schedule.
    pub fn new() -> Self {
        Self {
            plan: Guarded::new(Plan::NOTHING),
            rhythms: [Rhythm::NONE; CHANNELS],
            running: None,
            rests: false,
        }
    }

    /// Follows a new plan from the next pulse of each channel on; a running pulse is not changed.
    pub fn follow(&mut self, plan: &Guarded<Plan<CHANNELS>>) {
        // A plan whose checksum fails stays, and starts nothing.
        if let (Some(new), Some(old)) = (plan.get(), self.plan.get()) {
            let trains = new.trains.iter().zip(&old.trains);
            for (rhythm, (train, before)) in self.rhythms.iter_mut().zip(trains) {
                match train {
                    None => rhythm.counts = 0,
                    // An unchanged train continues. A pulse of a new train comes no sooner after
                    // the last than its own period: else strong, rare pulses could follow weak,
                    // frequent ones.
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

    /// Whether the plan's checksum is valid.
    pub fn is_intact(&self) -> bool {
        self.plan.get().is_some()
    }

    /// Stops every channel at once, also a running pulse.
    pub fn halt(&mut self) {
        self.plan = Guarded::new(Plan::NOTHING);
        self.rhythms.iter_mut().for_each(|rhythm| rhythm.counts = 0);
        self.running = None;
        self.rests = false;
    }

    /// Whether no pulse will come.
    pub fn is_idle(&self) -> bool {
        self.running.is_none() && self.plan.get().is_none_or(Plan::is_nothing)
    }

    /// A step without current instead of [`Schedule::advance`].
    pub(crate) fn wait(&mut self) -> Step {
        self.pass(Step::IDLE)
    }

    /// The next step. Call it when the last step has ended.
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

    /// Next step of the running pulse.
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

    /// First phase of the pulse that is due first, or a step without current.
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
                // A late pulse is made up for in part: pulses are never closer than half a period,
                // or than the frequency limit allows.
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
            // May be later than due by less than the shortest step.
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
    use crate::between::guarded::Guarded;
    use crate::between::limits::Limits;
    use crate::between::plan::Plan;
    use crate::between::stimulus::{Scale, Stimulus};

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
