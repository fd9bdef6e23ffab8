//! The half of the stimulator that the pulse timer drives, above everything else.

use crate::gate::Gate;
use crate::output::OutputStage;
use crate::plan::Plan;
use crate::safety::CHANNELS;
use crate::schedule::{Schedule, Step};
use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;
use heapless::spsc::Consumer;

/// Puts pulses out, as long as the tick keeps allowing it.
pub struct Pulses<'q, D, P> {
    stage: OutputStage<D, P, CHANNELS>,
    schedule: Schedule<CHANNELS>,
    plans: Consumer<'q, Plan<CHANNELS>>,
    gate: &'q Gate,
    /// For how long a plan holds, µs.
    patience_us: u32,
    /// Since the last plan, µs.
    age_us: u32,
    /// What the timer's next interrupt begins.
    next: Step,
}

/// Ticks that a plan holds for: the tick sends one each time, and one that does not end in time has sent none.
const PATIENCE_TICKS: u32 = 2;

impl<'q, D: SpiDevice, P: OutputPin> Pulses<'q, D, P> {
    /// How long the first step lasts, µs.
    pub const FIRST_US: u32 = Step::IDLE.duration_us;

    /// Takes over the output stage, in neutral, for a tick of so many µs.
    pub fn new(
        stage: OutputStage<D, P, CHANNELS>,
        plans: Consumer<'q, Plan<CHANNELS>>,
        gate: &'q Gate,
        tick_us: u32,
    ) -> Self {
        let patience_us = PATIENCE_TICKS * tick_us;
        let schedule = Schedule::new();
        Self { stage, schedule, plans, gate, patience_us, age_us: 0, next: Step::IDLE }
    }

    /// The timer has run out and counts the next step already: puts that out, and returns how long the step
    /// *after* it lasts, µs. That goes into the timer's buffer, so that the hardware, not this function, says when
    /// a phase ends.
    ///
    /// Deadline: [`LEAST_PHASE_US`](crate::LEAST_PHASE_US).
    pub fn timer(&mut self) -> u32 {
        let step = self.next;
        if self.stage.apply(&step).is_err() {
            self.fail();
        }
        self.age_us = self.age_us.saturating_add(step.duration_us);
        self.attend();
        if self.age_us > self.patience_us && !self.schedule.is_idle() {
            self.gate.set_late(true);
            self.halt();
        }
        self.next = self.schedule.advance();
        self.next.duration_us
    }

    /// The tick has something to say that cannot wait; also what the timer does after every step.
    pub fn attend(&mut self) {
        while let Some(plan) = self.plans.dequeue() {
            self.schedule.follow(&plan);
            self.age_us = 0;
        }
        // Shut after a plan: then it was shut later.
        if !self.gate.is_open() {
            self.halt();
        }
    }

    /// The timer ran out again before its interrupt was through: a phase has not lasted as long as it should.
    pub fn overran(&mut self) {
        self.gate.set_late(true);
        self.halt();
    }

    fn fail(&mut self) {
        self.halt();
        self.gate.set_output_failed(true);
    }

    /// Neutral, and nothing comes after it.
    fn halt(&mut self) {
        self.schedule.halt();
        self.next = Step::IDLE;
        self.gate.set_output_failed(self.stage.neutral().is_err());
    }
}
