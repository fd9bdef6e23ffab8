//! What the tick and the pulse timer do with supervision, schedule and output stage.

use crate::output::OutputStage;
use crate::safety::{CHANNELS, Fault, Limits, NotArmed, Observed, State, Supervisor};
use crate::schedule::Schedule;
use crate::stimulus::{Scale, Stimulus};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

/// A supervised stimulator.
#[derive(Debug)]
pub struct Controller<D, P> {
    supervisor: Supervisor,
    schedule: Schedule<CHANNELS>,
    stage: OutputStage<D, P, CHANNELS>,
    /// What the schedule was last told.
    scheduled: [Option<Stimulus>; CHANNELS],
    output_answers: bool,
}

impl<D: SpiDevice, P: OutputPin> Controller<D, P> {
    /// Off, with the fault [`Fault::Boot`] to be acknowledged.
    pub fn new(limits: Limits, scale: Scale, stage: OutputStage<D, P, CHANNELS>) -> Self {
        Self {
            supervisor: Supervisor::new(limits),
            schedule: Schedule::new(scale),
            stage,
            scheduled: [None; CHANNELS],
            output_answers: true,
        }
    }

    /// Where supervision is.
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// See [`Supervisor::acknowledge`]. The output stage gets another chance.
    pub fn acknowledge(&mut self, seen: Fault) -> Result<(), NotArmed> {
        self.supervisor.acknowledge(seen)?;
        self.output_answers = self.stage.neutral().is_ok();
        Ok(())
    }

    /// See [`Supervisor::arm`].
    pub fn arm(&mut self) -> Result<(), NotArmed> {
        self.supervisor.arm()
    }

    /// The hard tick, every millisecond. Where stimulation is not allowed, everything is neutral when it returns.
    pub fn tick(&mut self, observed: &Observed, requested: &[Option<Stimulus>; CHANNELS]) {
        let output_answers = observed.output_answers && self.output_answers;
        let observed = Observed { output_answers, ..*observed };
        let allowed = self.supervisor.tick(&observed, requested);
        // Twice: what is too much may fit once another channel has given way.
        for _ in 0..2 {
            self.schedule_changes(&allowed);
        }
        if self.scheduled != allowed {
            self.supervisor.fail(Fault::Request);
        }
        if self.supervisor.state() != State::Armed {
            self.halt();
        }
    }

    /// The pulse timer has run out: puts out the next step, and says when it runs out again (µs).
    pub fn timer(&mut self) -> u32 {
        let step = self.schedule.advance();
        if self.stage.apply(&step).is_err() {
            self.output_answers = false;
            self.supervisor.fail(Fault::Output);
            self.halt();
        }
        step.duration_us
    }

    fn schedule_changes(&mut self, allowed: &[Option<Stimulus>; CHANNELS]) {
        for (channel, (&wanted, scheduled)) in allowed.iter().zip(&mut self.scheduled).enumerate() {
            if wanted != *scheduled && self.schedule.set(channel, wanted).is_ok() {
                *scheduled = wanted;
            }
        }
    }

    fn halt(&mut self) {
        self.schedule.halt();
        self.scheduled = [None; CHANNELS];
        if self.stage.neutral().is_err() {
            self.output_answers = false;
        }
    }
}
