//! Queues between tick and link, and two banks of muscles. Neither waits for the other.

use crate::between::fault::Fault;
use crate::between::guarded::{Guarded, Sum};
use crate::between::motion::{AngleReading, Target};
use crate::between::shared::{Giver, Taker};
use crate::between::stimulus::Stimulus;
use crate::config::{CHANNELS, MUSCLES};
use crate::hard_tick::angle_sensor::HostSensor;
use crate::hard_tick::placed_controller::PlacedController;
use crate::hard_tick::placed_muscle::PlacedMuscle;
use crate::hard_tick::safety::NotArmed;
use crate::link::{Commanded, MOST_WORDS, Readings, Report, RowInputs, Traced};
use heapless::Vec;
use heapless::spsc::Queue;
use vm_nostd::Checksum;

/// Capacity of the queues of rows and of traces; a queue keeps one place free.
const WAITING: usize = 64;
/// The same of the queue of angles: newer ones are what the tick wants.
const WAITING_ANGLES: usize = 8;

/// Muscles of all places, and the controller of their joint. Tick and link exchange two banks: a
/// muscle is too large for a queue and for the stack.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bank {
    pub(crate) muscles: [Option<PlacedMuscle>; MUSCLES],
    pub(crate) controller: Option<PlacedController>,
}

impl Bank {
    /// Without muscles.
    pub(crate) const fn new() -> Self {
        Self { muscles: [const { None }; MUSCLES], controller: None }
    }
}

/// An order from link to tick.
#[derive(Debug)]
pub(crate) enum Order {
    /// Load the muscle of a place, and the controller, from a bank.
    Load(usize, &'static mut Bank),
    /// Load the controller from a bank, or none.
    Control(&'static mut Bank),
    /// Replace all muscles by those at rest in a bank; rows count from 0.
    Rest(&'static mut Bank),
    Drive(Guarded<Stimuli>),
    Target(Guarded<Target>),
    /// Step the controller once, while disarmed.
    Step(Target, AngleReading),
    Readings(Readings),
    Acknowledge(Fault),
    Arm,
    Stop,
    Report,
    Words(usize),
}

/// Answer of the tick: one outcome per order.
#[derive(Debug)]
pub(crate) enum Outcome {
    Done,
    /// Done; returns the bank that the tick does not need.
    Took(&'static mut Bank),
    NotArmed(NotArmed),
    Report(Report),
    Words(Vec<u32, MOST_WORDS>),
    Stepped(Commanded),
    Empty,
}

/// Inputs of each muscle in a tick.
pub(crate) type Row = [RowInputs; MUSCLES];

/// Stimulus of each channel.
pub(crate) type Stimuli = [Option<Stimulus>; CHANNELS];

impl Sum for RowInputs {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { activation, path_length, stimulation_frequency } = *self;
        let words = [activation, path_length, stimulation_frequency].map(f32::to_bits);
        words.into_iter().for_each(|word| checksum.add(word));
    }
}

/// All queues between tick and link.
pub struct LinkQueues {
    orders: Queue<Order, 2>,
    outcomes: Queue<Outcome, 2>,
    rows: Queue<Guarded<Row>, WAITING>,
    traces: Queue<Traced, WAITING>,
    angles: Queue<Guarded<AngleReading>, WAITING_ANGLES>,
}

/// Memory of the tick's bank and the spare one: large, never moved.
pub struct Banks {
    bank: Bank,
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
        Self { bank: Bank::new(), spare: Bank::new() }
    }
}

impl Default for LinkQueues {
    fn default() -> Self {
        Self::new()
    }
}

impl LinkQueues {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            orders: Queue::new(),
            outcomes: Queue::new(),
            rows: Queue::new(),
            traces: Queue::new(),
            angles: Queue::new(),
        }
    }

    /// Splits into the tick's ends and the link's.
    pub fn split(&mut self, banks: &'static mut Banks) -> (TickEnds<'_>, LinkEnds<'_>) {
        let (give_order, take_order) = self.orders.split();
        let (give_outcome, take_outcome) = self.outcomes.split();
        let (give_row, take_row) = self.rows.split();
        let (give_trace, take_trace) = self.traces.split();
        let (give_angle, take_angle) = self.angles.split();
        (
            TickEnds {
                orders: Taker(take_order),
                outcomes: Giver(give_outcome),
                rows: Taker(take_row),
                traces: Giver(give_trace),
                bank: &mut banks.bank,
                angles: Some(HostSensor(Taker(take_angle))),
            },
            LinkEnds {
                orders: Giver(give_order),
                outcomes: Taker(take_outcome),
                rows: Giver(give_row),
                traces: Taker(take_trace),
                angles: Giver(give_angle),
                spare: Some(&mut banks.spare),
            },
        )
    }
}

/// The tick's ends of [`LinkQueues`].
pub struct TickEnds<'q> {
    pub(crate) orders: Taker<'q, Order>,
    pub(crate) outcomes: Giver<'q, Outcome>,
    pub(crate) rows: Taker<'q, Guarded<Row>>,
    pub(crate) traces: Giver<'q, Traced>,
    pub(crate) bank: &'static mut Bank,
    /// The host as sensor of the joint's angle, until the tick takes it or has another.
    pub(crate) angles: Option<HostSensor<'q>>,
}

/// The link's ends of [`LinkQueues`].
pub struct LinkEnds<'q> {
    pub(crate) orders: Giver<'q, Order>,
    pub(crate) outcomes: Taker<'q, Outcome>,
    pub(crate) rows: Giver<'q, Guarded<Row>>,
    pub(crate) traces: Taker<'q, Traced>,
    pub(crate) angles: Giver<'q, Guarded<AngleReading>>,
    /// The spare bank; none while the tick has it.
    pub(crate) spare: Option<&'static mut Bank>,
}
