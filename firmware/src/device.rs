//! What the hard tick does: a bank of muscles, what stimulates them, and supervision.

use crate::controller::Controller;
use crate::deadline::Deadline;
use crate::driven::{Demand, Driven};
use crate::guarded::{Guarded, Sum};
use crate::limits::{LONGEST_TICK_US, Limits, SHORTEST_TICK_US};
use crate::link::{MOST_WORDS, Readings, Report, RowInputs, RowOutputs, Traced};
use crate::safety::{CHANNELS, Fault, NotArmed, Observed, Requested};
use crate::shared::{Giver, Taker};
use crate::stimulus::Stimulus;
use heapless::Vec;
use heapless::spsc::Queue;
use vm_nostd::Checksum;

/// Time between ticks of the firmware, µs: 500 to 2,000. 1,000, or what `VM_TICK_US` says when it is built; what is
/// no such number does not build.
pub const TICK_US: u32 = match option_env!("VM_TICK_US") {
    None => 1000,
    Some(text) => match u32::from_str_radix(text, 10) {
        Ok(tick_us) => tick_us,
        Err(_) => panic!("VM_TICK_US: must be a whole number"),
    },
};
const _: () = assert!(
    TICK_US >= SHORTEST_TICK_US && TICK_US <= LONGEST_TICK_US,
    "VM_TICK_US: must be 500 to 2000"
);

/// Muscles of a device.
pub const MUSCLES: usize = 2;
/// Fibre types of each muscle.
pub const TYPES: usize = 2;

/// Places for rows that wait for their tick, and for their outputs; a queue keeps one of them free.
const WAITING: usize = 64;

/// The muscles of all places. There are two that tick and link give each other, for a muscle is too large for a queue,
/// and for the stack.
pub(crate) type Bank = [Option<Driven>; MUSCLES];

/// What the link asks of the tick.
#[derive(Debug)]
pub(crate) enum Order {
    /// A place's muscle, of a bank that has it there.
    Load(usize, &'static mut Bank),
    /// All muscles of places that have one, at rest; rows count from 0.
    Rest(&'static mut Bank),
    Drive(Guarded<Stimuli>),
    Readings(Readings),
    Acknowledge(Fault),
    Arm,
    Stop,
    Report,
    Words(usize),
}

/// What the tick answers: one outcome for each order.
#[derive(Debug)]
pub(crate) enum Outcome {
    Done,
    /// The same, with a bank that the tick does not need.
    Took(&'static mut Bank),
    NotArmed(NotArmed),
    Report(Report),
    Words(Vec<u32, MOST_WORDS>),
    Empty,
}

/// Inputs of each muscle in a tick.
pub(crate) type Row = [RowInputs; MUSCLES];

/// What is asked of each channel.
pub(crate) type Stimuli = [Option<Stimulus>; CHANNELS];

impl Sum for RowInputs {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { activation, path_length, stimulation_frequency } = *self;
        let words = [activation, path_length, stimulation_frequency].map(f32::to_bits);
        words.into_iter().for_each(|word| checksum.add(word));
    }
}

/// Everything that goes between tick and link; neither ever waits for the other.
pub struct Lines {
    orders: Queue<Order, 2>,
    outcomes: Queue<Outcome, 2>,
    rows: Queue<Guarded<Row>, WAITING>,
    traces: Queue<Traced, WAITING>,
}

/// Room for the muscles of the tick, and for those that the link gives it next: large, and never moved.
pub struct Banks {
    muscles: Bank,
    spare: Bank,
}

impl Default for Banks {
    fn default() -> Self {
        Self::new()
    }
}

impl Banks {
    /// Without muscles.
    pub const fn new() -> Self {
        Self { muscles: [const { None }; MUSCLES], spare: [const { None }; MUSCLES] }
    }
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

    /// The tick's ends and the link's, which give each other two banks of muscles.
    pub fn split(&mut self, banks: &'static mut Banks) -> (TickEnds<'_>, LinkEnds<'_>) {
        let (give_order, take_order) = self.orders.split();
        let (give_outcome, take_outcome) = self.outcomes.split();
        let (give_row, take_row) = self.rows.split();
        let (give_trace, take_trace) = self.traces.split();
        (
            TickEnds {
                orders: Taker(take_order),
                outcomes: Giver(give_outcome),
                rows: Taker(take_row),
                traces: Giver(give_trace),
                muscles: &mut banks.muscles,
            },
            LinkEnds {
                orders: Giver(give_order),
                outcomes: Taker(take_outcome),
                rows: Giver(give_row),
                traces: Taker(take_trace),
                spare: Some(&mut banks.spare),
            },
        )
    }
}

/// The tick's ends of [`Lines`].
pub struct TickEnds<'q> {
    orders: Taker<'q, Order>,
    outcomes: Giver<'q, Outcome>,
    rows: Taker<'q, Guarded<Row>>,
    traces: Giver<'q, Traced>,
    muscles: &'static mut Bank,
}

/// The link's ends of [`Lines`].
pub struct LinkEnds<'q> {
    pub(crate) orders: Giver<'q, Order>,
    pub(crate) outcomes: Taker<'q, Outcome>,
    pub(crate) rows: Giver<'q, Guarded<Row>>,
    pub(crate) traces: Taker<'q, Traced>,
    /// None while the tick has it.
    pub(crate) spare: Option<&'static mut Bank>,
}

/// What asks for current, and how long ago it came.
#[derive(Clone, Copy, Debug)]
struct Aged<T> {
    value: Guarded<T>,
    age_us: u64,
}

impl<T: Sum> Aged<T> {
    fn new(value: T) -> Self {
        Self::of(Guarded::new(value))
    }

    fn of(value: Guarded<T>) -> Self {
        Self { value, age_us: 0 }
    }
}

const NO_STIMULI: Stimuli = [None; CHANNELS];
const NO_DEMAND: [Demand; MUSCLES] = [Demand::Nothing; MUSCLES];

/// All that the hard tick owns.
pub struct Device<'q> {
    controller: Controller<'q>,
    ends: TickEnds<'q>,
    deadline: Deadline,
    /// What was asked for by itself, of channels that no electrode of a muscle has.
    drive: Aged<Stimuli>,
    /// What the last row asks for, of channels that electrodes of muscles have.
    demand: Aged<[Demand; MUSCLES]>,
    readings: Readings,
    /// How long ago these came, µs.
    readings_age_us: u64,
    /// They came for this tick.
    readings_are_new: bool,
    /// A row was not what the link had put into its queue.
    row_lost: bool,
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
            drive: Aged::new(NO_STIMULI),
            demand: Aged::new(NO_DEMAND),
            readings: Readings::default(),
            readings_age_us: 0,
            readings_are_new: false,
            row_lost: false,
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
        for age_us in [&mut self.drive.age_us, &mut self.demand.age_us, &mut self.readings_age_us] {
            *age_us = age_us.saturating_add(TICK_US.into());
        }
        self.obey();
        let mut memory_is_intact = true;
        for driven in self.ends.muscles.iter_mut().flatten() {
            memory_is_intact &= driven.check();
        }
        self.advance();
        let limits = self.controller.limits().copied();
        if let Some(limits) = &limits
            && !self.was_armed
        {
            self.expire(limits);
        }
        let readings_us = limits.map_or(0, |limits| u64::from(limits.readings_ms) * 1000);
        let requested = self.requested();
        memory_is_intact &= requested.is_some() && !core::mem::take(&mut self.row_lost);
        let observed = Observed {
            host_heard: self.controller.take_heard(),
            impedance_ohm: self.readings.impedance_ohm,
            supply_mv: self.readings.supply_mv,
            // Old news is none.
            path_um: self.readings.path_um.filter(|_| self.readings_age_us <= readings_us),
            path_is_new: core::mem::take(&mut self.readings_are_new),
            in_time: self.in_time,
            memory_is_intact,
            // The controller knows.
            output_answers: true,
        };
        let armed = self.controller.tick(&observed, &requested.unwrap_or(Requested::NOTHING));
        self.ended(armed);
        armed
    }

    /// Forgets what was asked for while nothing could be put out, once it is as old as the limits allow: whoever
    /// arms is not given what somebody asked for long ago.
    fn expire(&mut self, limits: &Limits) {
        if self.drive.age_us > u64::from(limits.drives_ms) * 1000 {
            self.drive = Aged::new(NO_STIMULI);
        }
        if self.demand.age_us > u64::from(limits.rows_ms) * 1000 {
            self.demand = Aged::new(NO_DEMAND);
        }
    }

    /// Forgets, if it was armed and is not any more.
    fn ended(&mut self, armed: bool) {
        if core::mem::replace(&mut self.was_armed, armed) && !armed {
            self.forget();
        }
    }

    /// What is asked of all channels; none if memory has lost a bit of it.
    fn requested(&self) -> Option<Requested> {
        let drive = self.drive.value.get()?;
        let demands = self.demand.value.get()?;
        let mut requested = Requested { stimuli: *drive, ..Requested::NOTHING };
        if drive.iter().flatten().any(|stimulus| stimulus.amplitude_ua > 0) {
            requested.drive_age_us = self.drive.age_us;
        }
        for demand in demands {
            match *demand {
                Demand::Nothing => (),
                Demand::Pulses(channel, stimulus) => {
                    if stimulus.amplitude_ua > 0 {
                        requested.row_age_us = self.demand.age_us;
                    }
                    // No drive has a channel of an electrode.
                    *requested.stimuli.get_mut(channel)? = Some(stimulus);
                }
                Demand::NotFinite => requested.is_finite = false,
            }
        }
        Some(requested)
    }

    /// What was asked for before a fault is not what whoever arms next asks for. Rows that waited are gone, and
    /// missing among the traces by their numbers.
    fn forget(&mut self) {
        self.forget_requests();
        while self.ends.rows.dequeue().is_some() {
            self.rows = self.rows.wrapping_add(1);
        }
    }

    fn forget_requests(&mut self) {
        self.drive = Aged::new(NO_STIMULI);
        self.demand = Aged::new(NO_DEMAND);
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
            Order::Load(place, bank) => {
                if let (Some(muscle), Some(&loaded)) =
                    (self.ends.muscles.get_mut(place), bank.get(place))
                {
                    *muscle = loaded;
                }
                // Electrodes may have other channels now.
                self.forget_requests();
                Outcome::Took(bank)
            }
            Order::Rest(bank) => {
                let before = core::mem::replace(&mut self.ends.muscles, bank);
                self.rows = 0;
                // What waited belongs to the time before.
                while self.ends.rows.dequeue().is_some() {}
                self.demand = Aged::new(NO_DEMAND);
                Outcome::Took(before)
            }
            Order::Drive(stimuli) => {
                self.drive = Aged::of(stimuli);
                Outcome::Done
            }
            Order::Readings(readings) => {
                self.readings = readings;
                self.readings_age_us = 0;
                self.readings_are_new = true;
                Outcome::Done
            }
            Order::Acknowledge(fault) => armed(self.controller.acknowledge(fault)),
            Order::Arm => armed(self.controller.arm()),
            Order::Stop => {
                self.controller.fail(Fault::Stopped);
                // Rows are forgotten at the tick's end if it was armed: muscles that only compute go on.
                self.forget_requests();
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
            Order::Words(place) => match self.ends.muscles.get(place) {
                Some(Some(driven)) => Outcome::Words(driven.words()),
                _ => Outcome::Empty,
            },
        }
    }

    /// Steps the muscles by the next row, if there is one and its outputs can be taken. A row of which memory has
    /// lost a bit steps nothing.
    fn advance(&mut self) {
        if !self.ends.traces.ready() {
            return;
        }
        let Some(row) = self.ends.rows.dequeue() else { return };
        let mut outputs = [RowOutputs::default(); MUSCLES];
        let mut demands = NO_DEMAND;
        self.row_lost = row.get().is_none();
        let inputs = row.get().into_iter().flatten();
        let places = self.ends.muscles.iter_mut().zip(inputs).zip(&mut outputs).zip(&mut demands);
        for (((muscle, inputs), output), demand) in places {
            let Some(driven) = muscle else { continue };
            *output = driven.step(inputs);
            *demand = driven.demand(inputs);
        }
        self.demand = Aged::new(demands);
        let _there_is_room = self.ends.traces.enqueue(Traced { row: self.rows, outputs });
        self.rows = self.rows.wrapping_add(1);
    }
}

fn armed(result: Result<(), NotArmed>) -> Outcome {
    result.map_or_else(Outcome::NotArmed, |()| Outcome::Done)
}

#[cfg(test)]
mod tests;
