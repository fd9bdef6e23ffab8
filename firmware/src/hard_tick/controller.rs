//! The tick's half of the stimulator: supervision and the plan of pulses.

use crate::between::fault::Fault;
use crate::between::guarded::Guarded;
use crate::between::limits::{LimitError, Limits};
use crate::between::permission::Permission;
use crate::between::plan::Plan;
use crate::between::shared::Giver;
use crate::between::stimulus::Scale;
use crate::config::CHANNELS;
use crate::hard_tick::safety::{NotArmed, Observed, Requested, State, Supervisor};
use heapless::spsc::Producer;

/// A supervised stimulator.
pub struct Controller<'q> {
    supervisor: Supervisor,
    scale: Guarded<Scale>,
    plans: Giver<'q, Guarded<Plan<CHANNELS>>>,
    permission: &'q Permission,
    /// Last plan given to the pulse timer.
    told: Plan<CHANNELS>,
}

impl<'q> Controller<'q> {
    /// Disarmed, with a latched fault (see [`Supervisor::new`]), for a tick time in µs. An error if
    /// the limits do not fit tick and scale, see [`Limits::validate`].
    pub fn new(
        limits: Limits,
        tick_us: u32,
        boot: Fault,
        scale: Scale,
        plans: Producer<'q, Guarded<Plan<CHANNELS>>>,
        permission: &'q Permission,
    ) -> Result<Self, LimitError> {
        Ok(Self {
            supervisor: Supervisor::new(limits, tick_us, &scale, boot)?,
            scale: Guarded::new(scale),
            plans: Giver(plans),
            permission,
            told: Plan::NOTHING,
        })
    }

    /// Limits; none if their checksum failed.
    pub fn limits(&self) -> Option<&Limits> {
        self.supervisor.limits()
    }

    /// State of supervision.
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// See [`Supervisor::wrong`].
    pub fn wrong(&self) -> Option<Fault> {
        self.supervisor.wrong()
    }

    /// Whether the host was heard since the last call.
    pub(crate) fn take_heard(&self) -> bool {
        self.permission.take_heard()
    }

    /// See [`Supervisor::acknowledge`]. Clears earlier late ticks.
    pub fn acknowledge(&mut self, seen: Fault) -> Result<(), NotArmed> {
        self.supervisor.acknowledge(seen)?;
        self.permission.set_late(false);
        self.permission.set_plan_lost(false);
        Ok(())
    }

    /// See [`Supervisor::arm`].
    pub fn arm(&mut self) -> Result<(), NotArmed> {
        self.supervisor.arm()
    }

    /// Latches a fault or a stop at once. The pulse timer's interrupt must be triggered then.
    pub fn fail(&mut self, fault: Fault) {
        self.supervisor.fail(fault);
        self.told = Plan::NOTHING;
        self.permission.set_open(self.state() == State::Armed);
    }

    /// A flipped bit in the scale, for tests.
    #[cfg(test)]
    pub(crate) fn corrupt_scale(&mut self) {
        self.scale.corrupt(|scale| scale.full_scale_ua /= 2);
    }

    /// The hard tick. Returns false if stimulation is not allowed; the pulse timer's interrupt must
    /// then be triggered and makes everything neutral.
    #[must_use]
    pub fn tick(&mut self, observed: &Observed, requested: &Requested) -> bool {
        let scale = self.scale.get().copied();
        let observed = Observed {
            in_time: observed.in_time && !self.permission.is_late(),
            output_answers: observed.output_answers && !self.permission.output_failed(),
            memory_is_intact: observed.memory_is_intact
                && !self.permission.is_plan_lost()
                && scale.is_some(),
            ..*observed
        };
        self.supervisor.tick(&observed, requested);
        if self.state() == State::Armed {
            // Before the plan: a pulse timer that finds the permission closed discards its plans.
            self.permission.renew();
            self.permission.set_open(true);
            self.tell(requested, scale);
        }
        let armed = self.state() == State::Armed;
        if !armed {
            // The pulse timer discards it, too.
            self.told = Plan::NOTHING;
            self.permission.set_open(false);
        }
        armed
    }

    /// Sends a plan to the pulse timer if it has changed.
    fn tell(&mut self, requested: &Requested, scale: Option<Scale>) {
        let (Some(scale), Some(limits)) = (scale, self.supervisor.limits()) else {
            return self.supervisor.fail(Fault::Checksum);
        };
        match Plan::new(&requested.stimuli, &scale, limits) {
            Err(_) => self.supervisor.fail(Fault::Request),
            Ok(plan) if plan == self.told => (),
            // The pulse timer takes several per tick; a full queue means that it has stopped.
            Ok(plan) if self.plans.enqueue(Guarded::new(plan)).is_err() => {
                self.supervisor.fail(Fault::Output);
            }
            Ok(plan) => self.told = plan,
        }
    }
}

#[cfg(test)]
mod tests;
