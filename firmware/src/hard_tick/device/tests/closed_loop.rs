//! A controller in the tick, with a sensor of the board: its pulses, and what ends them.

use super::super::{Demand, Device};
use crate::between::fault::Fault;
use crate::between::guarded::Guarded;
use crate::between::limits::Limits;
use crate::between::link_queues::{LinkEnds, LinkQueues, Order, Outcome};
use crate::between::motion::{AngleReading, Target};
use crate::between::permission::Permission;
use crate::between::plan::{Plan, PlanQueue};
use crate::between::stimulus::Scale;
use crate::config::{CHANNELS, TICK_US};
use crate::hard_tick::angle_sensor::AngleSensor;
use crate::hard_tick::controller::Controller;
use crate::hard_tick::deadline::Deadline;
use crate::hard_tick::placed_controller::tests::elbow;
use crate::hard_tick::safety::State;
use crate::link::Readings;
use heapless::spsc::Consumer;
use std::boxed::Box;

const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };

/// A sensor of the board that reads every second tick.
#[derive(Default)]
struct Local {
    ticks: u32,
    is_gone: bool,
    loses_bits: bool,
}

impl AngleSensor for Local {
    fn read(&mut self) -> Option<Guarded<AngleReading>> {
        self.ticks += 1;
        let noise = (self.ticks % 3) as i32;
        let reading = AngleReading { time_us: self.ticks * TICK_US, angle_urad: 1_000_000 + noise };
        let mut reading = Guarded::new(reading);
        if self.loses_bits {
            reading.corrupt(|reading| reading.angle_urad ^= 1 << 16);
        }
        (!self.is_gone && self.ticks.is_multiple_of(2)).then_some(reading)
    }
}

struct Bench {
    device: Device<'static, Local>,
    ends: LinkEnds<'static>,
    permission: &'static Permission,
    plans: Consumer<'static, Guarded<Plan<CHANNELS>>>,
    ticks: u32,
}

impl Bench {
    /// Armed, with an elbow's controller.
    fn armed() -> Self {
        let queue: &'static mut PlanQueue = Box::leak(Box::default());
        let permission: &'static Permission = Box::leak(Box::default());
        let link_queues: &'static mut LinkQueues = Box::leak(Box::default());
        let (give, plans) = queue.split();
        let (tick, ends) = link_queues.split(Box::leak(Box::default()));
        let limits = Limits::SURFACE.within_scale(&SCALE);
        let controller = Controller::new(limits, TICK_US, Fault::Boot, SCALE, give, permission);
        let controller = controller.expect("valid limits");
        let deadline = Deadline::new(TICK_US, 1);
        let device = Device::with_sensor(controller, tick, deadline, Local::default());
        let mut bench = Self { device, ends, permission, plans, ticks: 0 };
        let bank = bench.ends.spare.take().expect("a bank");
        bank.controller = Some(elbow());
        bench.order(Order::Control(bank));
        bench.tick();
        bench.order(Order::Acknowledge(Fault::Boot));
        bench.order(Order::Arm);
        assert_eq!(bench.state(), State::Armed);
        bench
    }

    /// The same, with pulses in its plan.
    fn running() -> Self {
        let mut bench = Self::armed();
        bench.aim(1.6);
        (0..80).for_each(|_| assert!(bench.tick()));
        assert!(bench.stimulates());
        bench
    }

    fn state(&self) -> State {
        self.device.controller.state()
    }

    fn stimulates(&self) -> bool {
        let demands = self.device.demand.value.get().expect("demands");
        demands.iter().any(|demand| matches!(demand, Demand::Pulses(..)))
    }

    fn aim(&mut self, angle: f32) {
        let target = Target { angle, ..Target::default() };
        self.order(Order::Target(Guarded::new(target)));
    }

    fn order(&mut self, order: Order) {
        assert!(self.ends.orders.enqueue(order).is_ok());
        self.tick();
        let outcome = self.ends.outcomes.dequeue();
        assert!(matches!(outcome, Some(Outcome::Done | Outcome::Took(_))), "{outcome:?}");
    }

    /// Of a host that is heard and tells supply and path.
    fn tick(&mut self) -> bool {
        self.ticks += 1;
        self.permission.set_heard();
        self.device.readings = Readings {
            supply_mv: 3700,
            path_um: Some(160_000 + (self.ticks % 2) as i32),
            ..Readings::default()
        };
        self.device.readings_age_us = 0;
        let armed = self.device.tick(0);
        while self.plans.dequeue().is_some() {}
        armed
    }

    /// The fault that a tick sees.
    fn seen(mut self, within: u32) -> Option<Fault> {
        let ticks = (0..within).take_while(|_| self.tick()).count();
        match self.state() {
            State::Latched(fault) => {
                assert!(!self.stimulates(), "{fault:?} after {ticks} ticks");
                Some(fault)
            }
            _ => None,
        }
    }
}

#[test]
fn a_sensor_of_the_board_closes_the_loop() {
    assert_eq!(Bench::running().seen(15), None);
    // A target that is not repeated: in force for 100 ms.
    assert_eq!(Bench::running().seen(21), Some(Fault::StaleTarget));
    let mut bench = Bench::running();
    bench.device.sensor.is_gone = true;
    bench.aim(1.6);
    assert_eq!(bench.seen(32), Some(Fault::SensorMissing));
}

#[test]
fn a_bit_that_the_loop_loses_is_a_fault_in_its_tick() {
    let changes: [fn(&mut Bench); 6] = [
        |bench| bench.device.closed_loop.corrupt_target(),
        |bench| bench.device.closed_loop.corrupt_course(),
        |bench| bench.device.ends.bank.controller.as_mut().expect("one").flip_checksum_bit(0),
        |bench| bench.device.ends.bank.controller.as_mut().expect("one").flip_checksum_bit(1),
        |bench| bench.device.ends.bank.controller.as_mut().expect("one").flip_checksum_bit(2),
        |bench| {
            if bench.device.sensor.ticks.is_multiple_of(2) {
                bench.tick();
            }
            bench.device.sensor.loses_bits = true;
        },
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut bench = Bench::running();
        // A course is replaced with the next reading: none comes in this tick.
        if bench.device.sensor.ticks.is_multiple_of(2) == (index != 1) {
            bench.tick();
        }
        change(&mut bench);
        assert_eq!(bench.seen(1), Some(Fault::Checksum), "change {index}");
    }
}

#[test]
fn a_gain_out_of_its_range_is_a_fault() {
    let bench = Bench::running();
    bench.device.ends.bank.controller.as_mut().expect("a controller").refuse_gains();
    assert_eq!(bench.seen(1), Some(Fault::Gain));
}

/// What was wanted before a fault is not what whoever arms next wants; nor is its state.
#[test]
fn an_arming_begins_anew() {
    let mut bench = Bench::running();
    bench.order(Order::Stop);
    bench.order(Order::Acknowledge(Fault::Stopped));
    bench.order(Order::Arm);
    (0..50).for_each(|_| assert!(bench.tick()));
    assert!(!bench.stimulates());
    bench.aim(1.6);
    bench.tick();
    let demands = *bench.device.demand.value.get().expect("demands");
    let mut fresh = Bench::armed();
    fresh.aim(1.6);
    fresh.tick();
    assert_eq!(*fresh.device.demand.value.get().expect("demands"), demands);
}

/// A target is given before arming: in force for its time, and no other.
#[test]
fn a_target_outlasts_arming() {
    let mut bench = Bench::armed();
    bench.order(Order::Stop);
    bench.order(Order::Acknowledge(Fault::Stopped));
    bench.aim(1.6);
    (0..20).for_each(|_| assert!(!bench.tick()));
    bench.order(Order::Arm);
    (0..60).for_each(|_| assert!(bench.tick()));
    assert!(bench.stimulates());
}

/// A tick steps no controller for the host while it is armed.
#[test]
fn steps_are_for_the_disarmed() {
    let mut bench = Bench::armed();
    let step = Order::Step(Target::default(), AngleReading::default());
    assert!(bench.ends.orders.enqueue(step).is_ok());
    bench.tick();
    assert!(matches!(bench.ends.outcomes.dequeue(), Some(Outcome::Empty)));
    bench.order(Order::Stop);
    let step = Order::Step(Target::default(), AngleReading::default());
    assert!(bench.ends.orders.enqueue(step).is_ok());
    bench.tick();
    assert!(matches!(bench.ends.outcomes.dequeue(), Some(Outcome::Stepped(_))));
    assert!(!bench.stimulates());
}
