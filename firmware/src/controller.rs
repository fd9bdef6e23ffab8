//! The half of the stimulator that the tick drives: supervision, and what may be put out until the next one.

use crate::gate::Gate;
use crate::plan::Plan;
use crate::safety::{CHANNELS, Fault, Limits, NotArmed, Observed, State, Supervisor};
use crate::stimulus::{Scale, Stimulus};
use heapless::spsc::Producer;

/// A supervised stimulator.
pub struct Controller<'q> {
    supervisor: Supervisor,
    scale: Scale,
    plans: Producer<'q, Plan<CHANNELS>>,
    gate: &'q Gate,
    /// What the pulse timer has last been told.
    told: Plan<CHANNELS>,
}

impl<'q> Controller<'q> {
    /// Off, with a fault of [`Supervisor::new`] to be acknowledged; for a tick of so many µs.
    pub fn new(
        limits: Limits,
        tick_us: u32,
        boot: Fault,
        scale: Scale,
        plans: Producer<'q, Plan<CHANNELS>>,
        gate: &'q Gate,
    ) -> Self {
        Self {
            supervisor: Supervisor::new(limits, tick_us, boot),
            scale,
            plans,
            gate,
            told: Plan::NOTHING,
        }
    }

    /// What supervision allows.
    pub fn limits(&self) -> &Limits {
        self.supervisor.limits()
    }

    /// Where supervision is.
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// See [`Supervisor::wrong`].
    pub fn wrong(&self) -> Option<Fault> {
        self.supervisor.wrong()
    }

    /// Whether the host was heard of since this was asked last.
    pub(crate) fn take_heard(&self) -> bool {
        self.gate.take_heard()
    }

    /// See [`Supervisor::acknowledge`]. What was late before does not count any more.
    pub fn acknowledge(&mut self, seen: Fault) -> Result<(), NotArmed> {
        self.supervisor.acknowledge(seen)?;
        self.gate.set_late(false);
        Ok(())
    }

    /// See [`Supervisor::arm`].
    pub fn arm(&mut self) -> Result<(), NotArmed> {
        self.supervisor.arm()
    }

    /// Latches a fault, or a stop, at once. The pulse timer's interrupt is to be called for then.
    pub fn fail(&mut self, fault: Fault) {
        self.supervisor.fail(fault);
        self.told = Plan::NOTHING;
        self.gate.set_open(self.state() == State::Armed);
    }

    /// The hard tick. Where stimulation is not allowed it returns false, and the pulse timer's interrupt is to be
    /// called for: everything is neutral when that has passed.
    #[must_use]
    pub fn tick(&mut self, observed: &Observed, requested: &[Option<Stimulus>; CHANNELS]) -> bool {
        let observed = Observed {
            in_time: observed.in_time && !self.gate.is_late(),
            output_answers: observed.output_answers && !self.gate.output_failed(),
            ..*observed
        };
        let allowed = self.supervisor.tick(&observed, requested);
        if self.state() == State::Armed {
            // Before there is a plan: a pulse timer that finds the gate shut throws away what it was told.
            self.gate.renew();
            self.gate.set_open(true);
            match Plan::new(&allowed, &self.scale) {
                Err(_) => self.supervisor.fail(Fault::Request),
                Ok(plan) if plan == self.told => (),
                // The pulse timer takes several in a tick; it has stopped if there is no room.
                Ok(plan) if self.plans.enqueue(plan).is_err() => {
                    self.supervisor.fail(Fault::Output);
                }
                Ok(plan) => self.told = plan,
            }
        }
        let armed = self.state() == State::Armed;
        if !armed {
            // The pulse timer forgets it, too.
            self.told = Plan::NOTHING;
            self.gate.set_open(false);
        }
        armed
    }
}
