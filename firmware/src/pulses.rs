//! The half of the stimulator that the pulse timer drives, above everything else.

use crate::gate::Gate;
use crate::guarded::Guarded;
use crate::output::OutputStage;
use crate::plan::Plan;
use crate::safety::CHANNELS;
use crate::schedule::{Schedule, Step};
use crate::shared::Taker;
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;
use heapless::spsc::Consumer;

#[cfg(test)]
mod tests;

/// Puts pulses out, as long as the tick keeps allowing it.
pub struct Pulses<'q, D, P> {
    stage: OutputStage<D, P, CHANNELS>,
    schedule: Schedule<CHANNELS>,
    plans: Taker<'q, Guarded<Plan<CHANNELS>>>,
    gate: &'q Gate,
    /// For how long a tick's permission holds, µs.
    patience_us: u32,
    /// The most time since the last one, µs.
    age_us: u32,
    /// A pulse is being put out.
    pulsing: bool,
    /// How long the step lasts, or lasted, that the timer's last interrupt began, µs.
    lasted_us: u32,
    /// What the timer's next interrupt begins.
    next: Step,
    /// For how long electrodes of a pulse that was cut short stay connected to each other, µs; none if there are
    /// no such.
    discharge_us: Option<u32>,
}

/// So long: ten time constants of 1 µF and 2 kΩ.
const DISCHARGE_US: u32 = 20_000;

/// Ticks that a permission holds for: each tick gives one, but for one that hangs.
const PATIENCE_TICKS: u32 = 2;

impl<'q, D: SpiDevice, P: OutputPin> Pulses<'q, D, P> {
    /// How long the first step lasts, µs.
    pub const FIRST_US: u32 = Step::IDLE.duration_us;

    /// Takes over the output stage, in neutral, for a tick of so many µs.
    pub fn new(
        stage: OutputStage<D, P, CHANNELS>,
        plans: Consumer<'q, Guarded<Plan<CHANNELS>>>,
        gate: &'q Gate,
        tick_us: u32,
    ) -> Self {
        let patience_us = PATIENCE_TICKS * tick_us;
        let schedule = Schedule::new();
        Self {
            stage,
            schedule,
            plans: Taker(plans),
            gate,
            patience_us,
            age_us: 0,
            pulsing: false,
            lasted_us: Self::FIRST_US,
            next: Step::IDLE,
            discharge_us: None,
        }
    }

    /// The timer has run out and counts the next step already: puts that out, and returns how long the step
    /// *after* it lasts, µs. That goes into the timer's buffer, so that the hardware, not this function, says when
    /// a phase ends.
    ///
    /// Deadline: [`LEAST_PHASE_US`](crate::LEAST_PHASE_US).
    pub fn timer(&mut self) -> u32 {
        // A permission that is seen now came at any time of the step that has just ended.
        let before_us = if self.gate.take_renewed() { 0 } else { self.age_us };
        self.age_us = before_us.saturating_add(self.lasted_us);
        self.lasted_us = self.next.duration_us;
        // Before the step begins: one that would last for longer than the permission does not.
        let ends_us = self.age_us.saturating_add(self.next.duration_us);
        let is_overdue = ends_us > self.patience_us && !self.schedule.is_idle();
        if is_overdue {
            self.gate.set_late(true);
        }
        if is_overdue || !self.gate.is_open() {
            self.halt();
        }
        let step = self.next;
        self.pulsing = step.output.is_some();
        if self.stage.apply(&step).is_err() {
            self.fail();
        }
        self.flow_off(&step);
        // Plans are long to read, and to sum: not while a phase is being timed.
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

    /// Follows the plans that wait. What memory has changed puts nothing out.
    fn read_plans(&mut self) {
        while let Some(plan) = self.plans.dequeue() {
            self.schedule.follow(&plan);
            if !self.schedule.is_intact() {
                break;
            }
        }
        if !self.schedule.is_intact() {
            self.gate.set_plan_lost(true);
            self.halt();
        }
    }

    /// The tick has something to say that cannot wait.
    pub fn attend(&mut self) {
        if !self.gate.is_open() {
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
            self.gate.set_output_failed(self.stage.neutral().is_err());
        }
    }

    /// The timer ran out again before its interrupt was through: in a pulse, a phase does not last as long as it
    /// should. Between pulses it may.
    pub fn overran(&mut self) {
        if self.pulsing {
            self.gate.set_late(true);
            self.halt();
        }
    }

    fn fail(&mut self) {
        self.halt();
        self.gate.set_output_failed(true);
    }

    /// No current, and nothing comes after it.
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
        self.gate.set_output_failed(done.is_err());
    }
}
