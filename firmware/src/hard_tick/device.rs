//! The hard tick: muscles, the controller of their joint, their stimulation, and supervision.

use crate::between::fault::Fault;
use crate::between::guarded::{Guarded, Sum};
use crate::between::limits::Limits;
use crate::between::link_queues::{Order, Outcome, Stimuli, TickEnds};
use crate::config::{CHANNELS, MUSCLES, TICK_US};
use crate::hard_tick::angle_sensor::{AngleSensor, HostSensor};
use crate::hard_tick::closed_loop::ClosedLoop;
use crate::hard_tick::controller::Controller;
use crate::hard_tick::deadline::Deadline;
use crate::hard_tick::placed_muscle::Demand;
use crate::hard_tick::safety::{AngleObserved, NotArmed, Observed, Requested};
use crate::link::{Readings, Report, RowOutputs, Traced};

/// Requests for current, with their age.
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

/// State of the hard tick, with a sensor of the joint's angle.
pub struct Device<'q, A = Option<HostSensor<'q>>> {
    controller: Controller<'q>,
    ends: TickEnds<'q>,
    deadline: Deadline,
    sensor: A,
    closed_loop: ClosedLoop,
    /// Drives: stimuli of channels without an electrode.
    drive: Aged<Stimuli>,
    /// Stimuli of the last row or of the controller, of channels with an electrode.
    demand: Aged<[Demand; MUSCLES]>,
    gain_is_valid: bool,
    readings: Readings,
    /// Age of the readings, µs.
    readings_age_us: u64,
    /// New readings in this tick.
    readings_are_new: bool,
    /// A row's checksum failed.
    row_lost: bool,
    was_armed: bool,
    /// The last tick was in time.
    in_time: bool,
    ticks: u32,
    rows: u32,
}

impl<'q> Device<'q> {
    /// Without muscles and readings; angles come from the host.
    pub fn new(controller: Controller<'q>, mut ends: TickEnds<'q>, deadline: Deadline) -> Self {
        let sensor = ends.angles.take();
        Self::with_sensor(controller, ends, deadline, sensor)
    }
}

impl<'q, A: AngleSensor> Device<'q, A> {
    /// The same with a sensor of the board. Angles of the host are then refused for want of room.
    pub fn with_sensor(
        controller: Controller<'q>,
        ends: TickEnds<'q>,
        deadline: Deadline,
        sensor: A,
    ) -> Self {
        Self {
            controller,
            ends,
            deadline,
            sensor,
            closed_loop: ClosedLoop::new(),
            drive: Aged::new(NO_STIMULI),
            demand: Aged::new(NO_DEMAND),
            gain_is_valid: true,
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

    /// A tick that began `since_due` counts of its timer after it was due. Returns false if no
    /// current may flow: the pulse timer's interrupt must be triggered first.
    ///
    /// Bounded, without waiting. Deadline, including [`finish`](Self::finish): the next tick.
    #[must_use]
    pub fn tick(&mut self, since_due: u32) -> bool {
        self.deadline.begin(since_due);
        self.ticks = self.ticks.wrapping_add(1);
        for age_us in [&mut self.drive.age_us, &mut self.demand.age_us, &mut self.readings_age_us] {
            *age_us = age_us.saturating_add(TICK_US.into());
        }
        self.closed_loop.age();
        self.obey();
        let mut memory_is_intact = true;
        for placed in self.ends.bank.muscles.iter_mut().flatten() {
            memory_is_intact &= placed.check();
        }
        self.advance();
        let angle = self.control(&mut memory_is_intact);
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
            // Too old: missing.
            path_um: self.readings.path_um.filter(|_| self.readings_age_us <= readings_us),
            path_is_new: core::mem::take(&mut self.readings_are_new),
            angle,
            in_time: self.in_time,
            memory_is_intact,
            // The controller latches it.
            output_answers: true,
        };
        let armed = self.controller.tick(&observed, &requested.unwrap_or(Requested::NOTHING));
        self.ended(armed);
        armed
    }

    /// Discards requests that expire while disarmed, so that arming does not start old ones.
    fn expire(&mut self, limits: &Limits) {
        if self.drive.age_us > u64::from(limits.drives_ms) * 1000 {
            self.drive = Aged::new(NO_STIMULI);
        }
        if self.demand.age_us > u64::from(limits.rows_ms) * 1000 {
            self.demand = Aged::new(NO_DEMAND);
        }
        self.closed_loop.expire(u64::from(limits.targets_ms) * 1000);
    }

    /// Discards requests if it was armed and is no longer.
    fn ended(&mut self, armed: bool) {
        if core::mem::replace(&mut self.was_armed, armed) && !armed {
            self.forget();
        }
    }

    /// Stimuli of all channels; none if a checksum failed.
    fn requested(&self) -> Option<Requested> {
        let drive = self.drive.value.get()?;
        let demands = self.demand.value.get()?;
        let mut requested = Requested {
            stimuli: *drive,
            target_age_us: self.closed_loop.target_age_us(),
            gain_is_valid: self.gain_is_valid,
            ..Requested::NOTHING
        };
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
                    // Drives never have a channel of an electrode.
                    *requested.stimuli.get_mut(channel)? = Some(stimulus);
                }
                Demand::NotFinite => requested.is_finite = false,
            }
        }
        Some(requested)
    }

    /// Discards requests and waiting rows after a fault: arming must not resume them. Discarded
    /// rows are missing among the traces.
    fn forget(&mut self) {
        self.forget_requests();
        while self.ends.rows.dequeue().is_some() {
            self.rows = self.rows.wrapping_add(1);
        }
    }

    fn forget_requests(&mut self) {
        self.drive = Aged::new(NO_STIMULI);
        self.demand = Aged::new(NO_DEMAND);
        self.closed_loop.forget();
        self.gain_is_valid = true;
    }

    /// The tick ends, `since_due` counts of its timer after it was due, or after the next tick was
    /// due if so. Returns false if no current may flow, as [`tick`](Self::tick).
    #[must_use]
    pub fn finish(&mut self, since_due: u32, next_is_due: bool) -> bool {
        self.in_time = self.deadline.end(since_due, next_is_due);
        if !self.in_time {
            self.controller.fail(Fault::Deadline);
            self.ended(false);
        }
        self.in_time
    }

    /// Executes the link's order, if there is one.
    fn obey(&mut self) {
        // Without room for its outcome an order waits; the link takes an outcome before it gives an
        // order.
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
                    (self.ends.bank.muscles.get_mut(place), bank.muscles.get(place))
                {
                    *muscle = loaded;
                }
                // A controller of the muscle before is none of this one.
                self.ends.bank.controller = bank.controller;
                // Electrodes may have changed channels.
                self.forget_requests();
                Outcome::Took(bank)
            }
            Order::Control(bank) => {
                self.ends.bank.controller = bank.controller;
                self.forget();
                Outcome::Took(bank)
            }
            Order::Rest(bank) => {
                let before = core::mem::replace(&mut self.ends.bank, bank);
                self.rows = 0;
                // Waiting rows belong to the time before.
                while self.ends.rows.dequeue().is_some() {}
                self.demand = Aged::new(NO_DEMAND);
                self.closed_loop.forget();
                Outcome::Took(before)
            }
            Order::Drive(stimuli) => {
                self.drive = Aged::of(stimuli);
                Outcome::Done
            }
            Order::Target(target) => {
                self.closed_loop.aim(target);
                Outcome::Done
            }
            Order::Step(target, reading) => {
                // Armed, the tick steps it.
                let placed = self.ends.bank.controller.as_mut().filter(|_| !self.was_armed);
                let stepped =
                    placed.and_then(|placed| self.closed_loop.step(placed, &target, &reading));
                stepped.map_or(Outcome::Empty, |stepped| Outcome::Stepped(stepped.command))
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
                // Rows are discarded at the tick's end if it was armed; unarmed muscles continue.
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
                // The link reports it.
                frames: Default::default(),
            }),
            Order::Words(place) => match self.ends.bank.muscles.get(place) {
                Some(Some(placed)) => Outcome::Words(placed.words()),
                _ => Outcome::Empty,
            },
        }
    }

    /// Reads the joint's sensor and, while armed, steps the controller, if there is one. What
    /// supervision has to know of the sensor.
    fn control(&mut self, is_intact: &mut bool) -> Option<AngleObserved> {
        let read = self.sensor.read();
        let placed = self.ends.bank.controller.as_mut()?;
        *is_intact &= placed.check();
        let (range_urad, period_us) = placed.sensor();
        let reading = read.as_ref().and_then(|read| read.get().copied());
        *is_intact &= read.is_some() == reading.is_some();
        if let Some(reading) = reading {
            // Damaged limits end in neutral in this tick; until then the angle is held.
            let most_mrad_s = self.controller.limits().map_or(0, |l| l.angle_speed_mrad_s);
            self.closed_loop.take(reading, period_us, most_mrad_s);
        }
        *is_intact &= self.closed_loop.is_intact();
        if self.was_armed
            && let Some(stepped) = self.closed_loop.follow(placed)
        {
            self.demand = Aged::new(stepped.demands);
            self.gain_is_valid = stepped.gain_is_valid;
        }
        Some(AngleObserved { reading, range_urad, period_us })
    }

    /// Steps the muscles by the next row, if there is one and room for its outputs. A row whose
    /// checksum fails steps nothing.
    fn advance(&mut self) {
        if !self.ends.traces.ready() {
            return;
        }
        let Some(row) = self.ends.rows.dequeue() else { return };
        let mut outputs = [RowOutputs::default(); MUSCLES];
        let mut demands = NO_DEMAND;
        self.row_lost = row.get().is_none();
        let inputs = row.get().into_iter().flatten();
        let places =
            self.ends.bank.muscles.iter_mut().zip(inputs).zip(&mut outputs).zip(&mut demands);
        for (((muscle, inputs), output), demand) in places {
            let Some(placed) = muscle else { continue };
            *output = placed.step(inputs);
            *demand = placed.demand(inputs);
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
