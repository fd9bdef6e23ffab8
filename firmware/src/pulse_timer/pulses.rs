//! The pulse timer's half of the stimulator, at the highest priority.

use crate::between::guarded::Guarded;
use crate::between::permission::Permission;
use crate::between::plan::Plan;
use crate::between::shared::Taker;
use crate::between::step::Step;
use crate::config::CHANNELS;
use crate::pulse_timer::output::OutputStage;
use crate::pulse_timer::schedule::Schedule;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;
use heapless::spsc::Consumer;

#[cfg(test)]
mod tests;

/// Outputs pulses while the tick permits it.
pub struct Pulses<'q, D, P> {
    stage: OutputStage<D, P, CHANNELS>,
    schedule: Schedule<CHANNELS>,
    plans: Taker<'q, Guarded<Plan<CHANNELS>>>,
    permission: &'q Permission,
    /// Duration of a tick's permission, µs.
    permission_us: u32,
    /// Longest possible time since the last permission, µs.
    age_us: u32,
    /// A pulse is running.
    pulsing: bool,
    /// Duration of the current step, µs.
    lasted_us: u32,
    /// Step of the timer's next interrupt.
    next: Step,
    /// Remaining discharge of a pulse that was cut short, µs; none without one.
    discharge_us: Option<u32>,
}

/// Duration of a discharge: ten time constants of 1 µF and 2 kΩ.
const DISCHARGE_US: u32 = 20_000;

/// Duration of a permission in ticks; each tick renews it.
const PERMISSION_TICKS: u32 = 2;

impl<'q, D: SpiDevice, P: OutputPin> Pulses<'q, D, P> {
    /// Duration of the first step, µs.
    pub const FIRST_US: u32 = Step::IDLE.duration_us;

    /// Takes over the output stage, in neutral, for a tick time in µs.
    pub fn new(
        stage: OutputStage<D, P, CHANNELS>,
        plans: Consumer<'q, Guarded<Plan<CHANNELS>>>,
        permission: &'q Permission,
        tick_us: u32,
    ) -> Self {
        let permission_us = PERMISSION_TICKS * tick_us;
        let schedule = Schedule::new();
        Self {
            stage,
            schedule,
            plans: Taker(plans),
            permission,
            permission_us,
            age_us: 0,
            pulsing: false,
            lasted_us: Self::FIRST_US,
            next: Step::IDLE,
            discharge_us: None,
        }
    }

    /// The timer has expired and already counts the next step: outputs that step and returns the
    /// duration of the step *after* it, µs, for the timer's buffer. The hardware, not this
    /// function, ends a phase.
    ///
    /// Deadline: [`LEAST_PHASE_US`](crate::LEAST_PHASE_US).
    pub fn timer(&mut self) -> u32 {
        // The permission may have come at any time in the step that has just ended.
        let before_us = if self.permission.take_renewed() { 0 } else { self.age_us };
        self.age_us = before_us.saturating_add(self.lasted_us);
        self.lasted_us = self.next.duration_us;
        // A step that would outlast the permission does not begin.
        let ends_us = self.age_us.saturating_add(self.next.duration_us);
        let is_overdue = ends_us > self.permission_us && !self.schedule.is_idle();
        if is_overdue {
            self.permission.set_late(true);
        }
        if is_overdue || !self.permission.is_open() {
            self.halt();
        }
        let step = self.next;
        self.pulsing = step.output.is_some();
        if self.stage.apply(&step).is_err() {
            self.fail();
        }
        self.flow_off(&step);
        // Reading and checking plans takes long: not while a phase is being timed.
        if step.output.is_none() {
            self.read_plans();
        }
        // The charge of a pulse that was cut short flows off before another pulse begins.
        self.next = match self.discharge_us {
            Some(_) => self.schedule.wait(),
            None => self.schedule.advance(),
        };
        self.next.duration_us
    }

    /// Takes over waiting plans. A plan whose checksum fails outputs nothing.
    fn read_plans(&mut self) {
        while let Some(plan) = self.plans.dequeue() {
            self.schedule.follow(&plan);
            if !self.schedule.is_intact() {
                break;
            }
        }
        if !self.schedule.is_intact() {
            self.permission.set_plan_lost(true);
            self.halt();
        }
    }

    /// Urgent interrupt of the tick.
    pub fn attend(&mut self) {
        if !self.permission.is_open() {
            self.halt();
        }
    }

    /// Ends a discharge when its time is over.
    fn flow_off(&mut self, step: &Step) {
        let Some(left_us) = self.discharge_us else { return };
        let left_us = left_us.saturating_sub(step.duration_us);
        if left_us > 0 {
            self.discharge_us = Some(left_us);
        } else {
            self.discharge_us = None;
            self.permission.set_output_failed(self.stage.neutral().is_err());
        }
    }

    /// The timer expired again before its interrupt had finished: a phase of a pulse is too long.
    /// Between pulses that is allowed.
    pub fn overran(&mut self) {
        if self.pulsing {
            self.permission.set_late(true);
            self.halt();
        }
    }

    fn fail(&mut self) {
        self.halt();
        self.permission.set_output_failed(true);
    }

    /// No current, and no further pulse.
    fn halt(&mut self) {
        self.schedule.halt();
        // The timer counts what it was told, whatever is put out.
        self.next.output = None;
        while self.plans.dequeue().is_some() {}
        if self.stage.is_connected() {
            self.discharge_us = Some(DISCHARGE_US);
        }
        let done = match self.discharge_us {
            Some(_) => self.stage.discharge(),
            None => self.stage.neutral(),
        };
        self.permission.set_output_failed(done.is_err());
    }
}
