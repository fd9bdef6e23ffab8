//! The half of the stimulator that the tick drives: supervision, and what may be put out until the next one.

use crate::gate::Gate;
use crate::guarded::Guarded;
use crate::limits::{LimitError, Limits};
use crate::plan::Plan;
use crate::safety::{CHANNELS, Fault, NotArmed, Observed, Requested, State, Supervisor};
use crate::shared::Giver;
use crate::stimulus::Scale;
use heapless::spsc::Producer;

/// A supervised stimulator.
pub struct Controller<'q> {
    supervisor: Supervisor,
    scale: Guarded<Scale>,
    plans: Giver<'q, Guarded<Plan<CHANNELS>>>,
    gate: &'q Gate,
    /// What the pulse timer has last been told.
    told: Plan<CHANNELS>,
}

impl<'q> Controller<'q> {
    /// Off, with a fault of [`Supervisor::new`] to be acknowledged; for a tick of so many µs. Refused if the limits
    /// are not those of a stimulator of that tick and scale: see [`Limits::validate`].
    pub fn new(
        limits: Limits,
        tick_us: u32,
        boot: Fault,
        scale: Scale,
        plans: Producer<'q, Guarded<Plan<CHANNELS>>>,
        gate: &'q Gate,
    ) -> Result<Self, LimitError> {
        Ok(Self {
            supervisor: Supervisor::new(limits, tick_us, &scale, boot)?,
            scale: Guarded::new(scale),
            plans: Giver(plans),
            gate,
            told: Plan::NOTHING,
        })
    }

    /// What supervision allows; none once memory has lost a bit of it.
    pub fn limits(&self) -> Option<&Limits> {
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
        self.gate.set_plan_lost(false);
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

    /// What memory does to a scale.
    #[cfg(test)]
    pub(crate) fn corrupt_scale(&mut self) {
        self.scale.corrupt(|scale| scale.full_scale_ua /= 2);
    }

    /// The hard tick. Where stimulation is not allowed it returns false, and the pulse timer's interrupt is to be
    /// called for: everything is neutral when that has passed.
    #[must_use]
    pub fn tick(&mut self, observed: &Observed, requested: &Requested) -> bool {
        let scale = self.scale.get().copied();
        let observed = Observed {
            in_time: observed.in_time && !self.gate.is_late(),
            output_answers: observed.output_answers && !self.gate.output_failed(),
            memory_is_intact: observed.memory_is_intact
                && !self.gate.is_plan_lost()
                && scale.is_some(),
            ..*observed
        };
        self.supervisor.tick(&observed, requested);
        if self.state() == State::Armed {
            // Before there is a plan: a pulse timer that finds the gate shut throws away what it was told.
            self.gate.renew();
            self.gate.set_open(true);
            self.tell(requested, scale);
        }
        let armed = self.state() == State::Armed;
        if !armed {
            // The pulse timer forgets it, too.
            self.told = Plan::NOTHING;
            self.gate.set_open(false);
        }
        armed
    }

    /// Tells the pulse timer what is wanted, if that is something else than before.
    fn tell(&mut self, requested: &Requested, scale: Option<Scale>) {
        let (Some(scale), Some(limits)) = (scale, self.supervisor.limits()) else {
            return self.supervisor.fail(Fault::Checksum);
        };
        match Plan::new(&requested.stimuli, &scale, limits) {
            Err(_) => self.supervisor.fail(Fault::Request),
            Ok(plan) if plan == self.told => (),
            // The pulse timer takes several in a tick; it has stopped if there is no room.
            Ok(plan) if self.plans.enqueue(Guarded::new(plan)).is_err() => {
                self.supervisor.fail(Fault::Output);
            }
            Ok(plan) => self.told = plan,
        }
    }
}
