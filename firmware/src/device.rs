//! What the hard tick does: a bank of muscles, what stimulates them, and supervision.

use crate::controller::Controller;
use crate::deadline::Deadline;
use crate::driven::Driven;
use crate::link::{MOST_WORDS, Readings, Report, RowInputs, RowOutputs, Traced};
use crate::safety::{CHANNELS, Fault, NotArmed, Observed};
use crate::stimulus::Stimulus;
use heapless::Vec;
use heapless::spsc::{Consumer, Producer, Queue};

/// Time between ticks of the firmware, µs: 500 to 2,000. 1,000, or what `VM_TICK_US` says when it is built; what is
/// no such number does not build.
pub const TICK_US: u32 = match option_env!("VM_TICK_US") {
    None => 1000,
    Some(text) => match u32::from_str_radix(text, 10) {
        Ok(tick_us) => tick_us,
        Err(_) => panic!("VM_TICK_US: must be a whole number"),
    },
};
const _: () = assert!(TICK_US >= 500 && TICK_US <= 2000, "VM_TICK_US: must be 500 to 2000");

/// Muscles of a device.
pub const MUSCLES: usize = 2;
/// Fibre types of each muscle.
pub const TYPES: usize = 2;

/// Rows that can wait for their tick, and their outputs for the link.
const WAITING: usize = 64;

/// What the link asks of the tick.
#[derive(Clone, Debug)]
// A muscle is copied into the tick's place at once; nothing here is boxed.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Order {
    /// A muscle for a place.
    Load(usize, Driven),
    /// All muscles of places that have one, at rest; rows count from 0.
    Rest([Option<Driven>; MUSCLES]),
    Drive([Option<Stimulus>; CHANNELS]),
    Readings(Readings),
    Acknowledge(Fault),
    Arm,
    Stop,
    Report,
    Words(usize),
}

/// What the tick answers: one outcome for each order.
#[derive(Clone, Debug)]
pub(crate) enum Outcome {
    Done,
    NotArmed(NotArmed),
    Report(Report),
    Words(Vec<u32, MOST_WORDS>),
    Empty,
}

/// Inputs of each muscle in a tick.
pub(crate) type Row = [RowInputs; MUSCLES];

/// Everything that goes between tick and link; neither ever waits for the other.
pub struct Lines {
    orders: Queue<Order, 2>,
    outcomes: Queue<Outcome, 2>,
    rows: Queue<Row, WAITING>,
    traces: Queue<Traced, WAITING>,
}

impl Default for Lines {
    fn default() -> Self {
        Self::new()
    }
}

impl Lines {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            orders: Queue::new(),
            outcomes: Queue::new(),
            rows: Queue::new(),
            traces: Queue::new(),
        }
    }

    /// The tick's ends and the link's.
    pub fn split(&mut self) -> (TickEnds<'_>, LinkEnds<'_>) {
        let (give_order, take_order) = self.orders.split();
        let (give_outcome, take_outcome) = self.outcomes.split();
        let (give_row, take_row) = self.rows.split();
        let (give_trace, take_trace) = self.traces.split();
        (
            TickEnds {
                orders: take_order,
                outcomes: give_outcome,
                rows: take_row,
                traces: give_trace,
            },
            LinkEnds {
                orders: give_order,
                outcomes: take_outcome,
                rows: give_row,
                traces: take_trace,
            },
        )
    }
}

/// The tick's ends of [`Lines`].
pub struct TickEnds<'q> {
    orders: Consumer<'q, Order>,
    outcomes: Producer<'q, Outcome>,
    rows: Consumer<'q, Row>,
    traces: Producer<'q, Traced>,
}

/// The link's ends of [`Lines`].
pub struct LinkEnds<'q> {
    pub(crate) orders: Producer<'q, Order>,
    pub(crate) outcomes: Consumer<'q, Outcome>,
    pub(crate) rows: Producer<'q, Row>,
    pub(crate) traces: Consumer<'q, Traced>,
}

/// All that the hard tick owns.
pub struct Device<'q> {
    controller: Controller<'q>,
    ends: TickEnds<'q>,
    deadline: Deadline,
    muscles: [Option<Driven>; MUSCLES],
    /// What was asked for by itself.
    driven: [Option<Stimulus>; CHANNELS],
    /// What the last row asks for, of channels that electrodes of muscles have.
    by_rows: [Option<(usize, Option<Stimulus>)>; MUSCLES],
    readings: Readings,
    /// How long ago these came, µs.
    readings_age_us: u32,
    was_armed: bool,
    /// The last tick was in time.
    in_time: bool,
    ticks: u32,
    rows: u32,
}

impl<'q> Device<'q> {
    /// Without muscles, and without readings of any sensor.
    pub fn new(controller: Controller<'q>, ends: TickEnds<'q>, deadline: Deadline) -> Self {
        Self {
            controller,
            ends,
            deadline,
            muscles: [const { None }; MUSCLES],
            driven: [None; CHANNELS],
            by_rows: [None; MUSCLES],
            readings: Readings::default(),
            readings_age_us: 0,
            was_armed: false,
            in_time: true,
            ticks: 0,
            rows: 0,
        }
    }

    /// A tick, which began so many counts of its timer after it was due. False where current must not flow: the
    /// pulse timer's interrupt is to be called for before anything else is done.
    ///
    /// Bounded and free of waiting. Deadline: the next tick, for what [`finish`](Self::finish) says included.
    #[must_use]
    pub fn tick(&mut self, since_due: u32) -> bool {
        self.deadline.begin(since_due);
        self.ticks = self.ticks.wrapping_add(1);
        self.obey();
        let mut memory_is_intact = true;
        for driven in self.muscles.iter_mut().flatten() {
            memory_is_intact &= driven.check();
        }
        self.advance();
        self.readings_age_us = self.readings_age_us.saturating_add(TICK_US);
        let readings_us = self.controller.limits().readings_ms.saturating_mul(1000);
        let observed = Observed {
            host_heard: self.controller.take_heard(),
            impedance_ohm: self.readings.impedance_ohm,
            supply_mv: self.readings.supply_mv,
            // Old news is none.
            path_um: self.readings.path_um.filter(|_| self.readings_age_us <= readings_us),
            in_time: self.in_time,
            memory_is_intact,
            // The controller knows.
            output_answers: true,
        };
        let armed = self.controller.tick(&observed, &self.requested());
        self.ended(armed);
        armed
    }

    /// Forgets, if it was armed and is not any more.
    fn ended(&mut self, armed: bool) {
        if core::mem::replace(&mut self.was_armed, armed) && !armed {
            self.forget();
        }
    }

    /// What is asked for of all channels.
    fn requested(&self) -> [Option<Stimulus>; CHANNELS] {
        let mut requested = self.driven;
        for &(channel, stimulus) in self.by_rows.iter().flatten() {
            if let Some(place) = requested.get_mut(channel) {
                *place = stimulus;
            }
        }
        requested
    }

    /// What was asked for before a fault is not what whoever arms next asks for. Rows that waited are gone, and
    /// missing among the traces by their numbers.
    fn forget(&mut self) {
        self.driven = [None; CHANNELS];
        self.by_rows = [None; MUSCLES];
        while self.ends.rows.dequeue().is_some() {
            self.rows = self.rows.wrapping_add(1);
        }
    }

    /// The tick ends, so many counts of its timer after it was due or, if that is so, after the next one was.
    /// False where current must not flow, as with [`tick`](Self::tick).
    #[must_use]
    pub fn finish(&mut self, since_due: u32, next_is_due: bool) -> bool {
        self.in_time = self.deadline.end(since_due, next_is_due);
        if !self.in_time {
            self.controller.fail(Fault::Deadline);
            self.ended(false);
        }
        self.in_time
    }

    /// Does what the link asked for last, if anything.
    fn obey(&mut self) {
        // With no room for its outcome, an order waits; the link takes one before it gives another.
        if self.ends.outcomes.ready()
            && let Some(order) = self.ends.orders.dequeue()
        {
            let outcome = self.outcome(order);
            let _there_is_room = self.ends.outcomes.enqueue(outcome);
        }
    }

    fn outcome(&mut self, order: Order) -> Outcome {
        match order {
            Order::Load(place, driven) => {
                if let Some(muscle) = self.muscles.get_mut(place) {
                    *muscle = Some(driven);
                }
                self.by_rows = [None; MUSCLES];
                Outcome::Done
            }
            Order::Rest(muscles) => {
                self.muscles = muscles;
                self.rows = 0;
                // What waited belongs to the time before.
                while self.ends.rows.dequeue().is_some() {}
                self.by_rows = [None; MUSCLES];
                Outcome::Done
            }
            Order::Drive(stimuli) => {
                self.driven = stimuli;
                Outcome::Done
            }
            Order::Readings(readings) => {
                self.readings = readings;
                self.readings_age_us = 0;
                Outcome::Done
            }
            Order::Acknowledge(fault) => armed(self.controller.acknowledge(fault)),
            Order::Arm => armed(self.controller.arm()),
            Order::Stop => {
                self.controller.fail(Fault::Stopped);
                self.forget();
                Outcome::Done
            }
            Order::Report => Outcome::Report(Report {
                state: self.controller.state(),
                wrong: self.controller.wrong(),
                ticks: self.ticks,
                rows: self.rows,
                longest_us: self.deadline.longest_us(),
                late: self.deadline.late(),
                // The link knows.
                frames: Default::default(),
            }),
            Order::Words(place) => match self.muscles.get(place) {
                Some(Some(driven)) => Outcome::Words(driven.words()),
                _ => Outcome::Empty,
            },
        }
    }

    /// Steps the muscles by the next row, if there is one and its outputs can be taken.
    fn advance(&mut self) {
        if !self.ends.traces.ready() {
            return;
        }
        let Some(row) = self.ends.rows.dequeue() else { return };
        let mut outputs = [RowOutputs::default(); MUSCLES];
        let places = self.muscles.iter_mut().zip(&row).zip(&mut outputs).zip(&mut self.by_rows);
        for (((muscle, inputs), output), by_row) in places {
            let Some(driven) = muscle else { continue };
            *output = driven.step(inputs);
            *by_row = driven.stimulus(inputs);
        }
        let _there_is_room = self.ends.traces.enqueue(Traced { row: self.rows, outputs });
        self.rows = self.rows.wrapping_add(1);
    }
}

fn armed(result: Result<(), NotArmed>) -> Outcome {
    result.map_or_else(Outcome::NotArmed, |()| Outcome::Done)
}
