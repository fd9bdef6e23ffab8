//! What memory loses between the link and the pulse timer, and how old a request may be.

mod closed_loop;

use super::{Aged, Device};
use crate::between::fault::Fault;
use crate::between::guarded::Guarded;
use crate::between::limits::Limits;
use crate::between::link_queues::{LinkEnds, LinkQueues, Order, Outcome};
use crate::between::permission::Permission;
use crate::between::plan::{Plan, PlanQueue};
use crate::between::stimulus::{Scale, Stimulus};
use crate::config::{CHANNELS, MUSCLES, TICK_US};
use crate::hard_tick::controller::Controller;
use crate::hard_tick::deadline::Deadline;
use crate::hard_tick::placed_muscle::{Demand, PlacedMuscle};
use crate::hard_tick::safety::State;
use crate::link::{Electrode, Mode, Readings, RowInputs, Upload};
use heapless::spsc::Consumer;
use std::boxed::Box;
use vm_nostd::{RecruitmentCurveParams, TimeStep};
use vm_nostd_cores::MUSCLE;

const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };

const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 10_000,
    width_us: 200,
    gap_us: 50,
    frequency_tenths_pps: 400,
    recovery: 1,
};

const UPLOAD: Upload = Upload {
    mode: Mode::Fes,
    muscle: MUSCLE,
    electrode: Some(Electrode {
        channel: 1,
        curve: RecruitmentCurveParams {
            threshold: 4e-3,
            saturation: 12e-3,
            chronaxie: 200e-6,
            slope: 2.0,
        },
        width_us: 200,
        gap_us: 40,
        recovery: 1,
    }),
};

const ROW: RowInputs =
    RowInputs { activation: 0.5, path_length: 0.16, stimulation_frequency: 40.0 };

/// A device in its tick, and the link's ends of its queues.
struct Bench {
    device: Device<'static>,
    ends: LinkEnds<'static>,
    permission: &'static Permission,
    plans: Consumer<'static, Guarded<Plan<CHANNELS>>>,
}

impl Bench {
    fn armed(limits: Limits) -> Self {
        let queue: &'static mut PlanQueue = Box::leak(Box::default());
        let permission: &'static Permission = Box::leak(Box::default());
        let link_queues: &'static mut LinkQueues = Box::leak(Box::default());
        let (give, plans) = queue.split();
        let (tick, ends) = link_queues.split(Box::leak(Box::default()));
        let controller = Controller::new(limits, TICK_US, Fault::Boot, SCALE, give, permission);
        let controller = controller.expect("valid limits");
        let device = Device::new(controller, tick, Deadline::new(TICK_US, 1));
        let mut bench = Self { device, ends, permission, plans };
        let muscle = PlacedMuscle::build(&UPLOAD, TimeStep::MILLISECOND).expect("a muscle");
        let bank = bench.ends.spare.take().expect("a bank");
        bank.muscles[0] = Some(muscle);
        bench.order(Order::Load(0, bank));
        bench.read();
        bench.order(Order::Acknowledge(Fault::Boot));
        bench.order(Order::Arm);
        assert_eq!(bench.state(), State::Armed);
        bench
    }

    fn state(&self) -> State {
        self.device.controller.state()
    }

    fn read(&mut self) {
        let impedance_ohm = [None; CHANNELS];
        let readings = Readings { impedance_ohm, supply_mv: 3700, path_um: Some(160_000) };
        self.order(Order::Readings(readings));
    }

    fn order(&mut self, order: Order) {
        assert!(self.ends.orders.enqueue(order).is_ok());
        self.tick();
        assert!(matches!(self.ends.outcomes.dequeue(), Some(Outcome::Done | Outcome::Took(_))));
    }

    /// Of a host that is heard, and takes its traces.
    fn tick(&mut self) -> bool {
        self.permission.set_heard();
        let armed = self.device.tick(0);
        while self.ends.traces.dequeue().is_some() {}
        while self.plans.dequeue().is_some() {}
        armed
    }

    fn row(&mut self, row: Guarded<[RowInputs; MUSCLES]>) {
        assert!(self.ends.rows.enqueue(row).is_ok());
    }
}

fn row() -> Guarded<[RowInputs; MUSCLES]> {
    Guarded::new([ROW, RowInputs::default()])
}

fn drive() -> Guarded<[Option<Stimulus>; CHANNELS]> {
    Guarded::new([Some(STIMULUS), None, None, None])
}

#[test]
fn a_row_that_lost_a_bit_while_it_waited_is_a_fault_and_moves_nothing() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    bench.row(row());
    assert!(bench.tick());
    let before = bench.device.ends.bank.muscles[0].as_ref().expect("a muscle").words();
    let mut lost = row();
    lost.corrupt(|inputs| inputs[0].stimulation_frequency = 80.0);
    bench.row(lost);
    assert!(!bench.tick());
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));
    assert_eq!(bench.device.ends.bank.muscles[0].as_ref().expect("a muscle").words(), before);
    // It is over with the row.
    bench.order(Order::Acknowledge(Fault::Checksum));
    bench.order(Order::Arm);
    assert_eq!(bench.state(), State::Armed);
}

#[test]
fn a_drive_that_lost_a_bit_on_its_way_or_where_it_is_kept_is_a_fault() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    let mut lost = drive();
    lost.corrupt(|stimuli| stimuli[0] = None);
    bench.order(Order::Drive(lost));
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));

    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    bench.order(Order::Drive(drive()));
    assert!(bench.tick());
    bench.device.drive.value.corrupt(|stimuli| stimuli[2] = Some(STIMULUS));
    assert!(!bench.tick());
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));
}

#[test]
fn what_rows_ask_for_that_lost_a_bit_is_a_fault() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    bench.row(row());
    assert!(bench.tick());
    bench.device.demand.value.corrupt(|demands| {
        assert!(matches!(demands[0], Demand::Pulses(1, _)), "{demands:?}");
        demands[0] = Demand::Pulses(0, STIMULUS);
    });
    assert!(!bench.tick());
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));
}

#[test]
fn a_scale_or_a_limit_that_lost_a_bit_is_a_fault() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    bench.order(Order::Drive(drive()));
    bench.device.controller.corrupt_scale();
    assert!(!bench.tick());
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));
}

/// Rows are old 51 ticks after the last one, drives 1,001; whoever arms later is not given them.
#[test]
fn requests_grow_old_armed_or_not() {
    let limits = Limits { readings_ms: 5_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let limits = Limits { stuck_ms: 100_000, ..limits };
    let ticks = |bench: &mut Bench| (0..10_000).take_while(|_| bench.tick()).count();

    let mut bench = Bench::armed(limits);
    bench.row(row());
    assert_eq!(ticks(&mut bench), 51);
    assert_eq!(bench.state(), State::Latched(Fault::StaleRow));
    bench.read();
    bench.order(Order::Acknowledge(Fault::StaleRow));
    // Played while nothing is armed, and too old when something is.
    bench.row(row());
    (0..52).for_each(|_| {
        bench.tick();
    });
    bench.order(Order::Arm);
    assert!(bench.tick());
    assert_eq!(bench.device.demand.value, Aged::new(super::NO_DEMAND).value);

    let mut bench = Bench::armed(limits);
    bench.order(Order::Drive(drive()));
    assert_eq!(ticks(&mut bench), 1_000);
    assert_eq!(bench.state(), State::Latched(Fault::StaleDrive));
    bench.read();
    bench.order(Order::Drive(drive()));
    bench.order(Order::Acknowledge(Fault::StaleDrive));
    (0..1_000).for_each(|_| {
        bench.tick();
    });
    bench.order(Order::Arm);
    assert!(bench.tick());
    assert_eq!(bench.device.drive.value, Aged::new(super::NO_STIMULI).value);
}

/// A row whose traces have no room waits; its stimulus of before does not go on for it.
#[test]
fn traces_that_are_not_taken_end_in_neutral() {
    let limits = Limits { stuck_ms: 100_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let mut bench = Bench::armed(limits);
    let mut armed = 0;
    for _ in 0..200 {
        let _maybe_full = bench.ends.rows.enqueue(row());
        bench.permission.set_heard();
        armed += u32::from(bench.device.tick(0));
        while bench.plans.dequeue().is_some() {}
    }
    // 63 rows have room for their traces.
    assert_eq!(armed, 63 + 50);
    assert_eq!(bench.state(), State::Latched(Fault::StaleRow));
}

/// An activation or a frequency that no sensor gives is a fault, and not the most there is.
#[test]
fn rows_that_are_no_finite_numbers_are_a_fault_and_no_stimulus() {
    for value in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        for inputs in [
            RowInputs { activation: value, ..ROW },
            RowInputs { stimulation_frequency: value, ..ROW },
        ] {
            let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
            bench.row(row());
            assert!(bench.tick());
            bench.row(Guarded::new([inputs, RowInputs::default()]));
            assert!(!bench.tick(), "{inputs:?}");
            assert_eq!(bench.state(), State::Latched(Fault::Request));
        }
    }
}

/// What is asked for while nothing is armed is kept for whoever arms until it is older than its
/// limit, to the tick.
#[test]
fn requests_of_before_arming_are_kept_until_they_are_too_old() {
    let limits = Limits { readings_ms: 5_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let limits = Limits { stuck_ms: 100_000, ..limits };
    let stopped = || {
        let mut bench = Bench::armed(limits);
        bench.order(Order::Stop);
        bench.read();
        bench.order(Order::Acknowledge(Fault::Stopped));
        bench
    };
    let armed_after = |bench: &mut Bench, ticks| {
        (0..ticks).for_each(|_| {
            bench.tick();
        });
        bench.order(Order::Arm);
        assert_eq!(bench.state(), State::Armed);
    };
    for (ticks, kept) in [(0, true), (500, true), (999, true), (1_000, false), (1_500, false)] {
        let mut bench = stopped();
        bench.order(Order::Drive(drive()));
        armed_after(&mut bench, ticks);
        assert_eq!(bench.device.drive.value == drive(), kept, "a drive after {ticks} ticks");
    }
    for (ticks, kept) in [(0, true), (25, true), (49, true), (50, false), (200, false)] {
        let mut bench = stopped();
        bench.row(row());
        bench.tick();
        armed_after(&mut bench, ticks);
        let nothing = Aged::new(super::NO_DEMAND).value;
        assert_eq!(bench.device.demand.value != nothing, kept, "a row after {ticks} ticks");
    }
}

/// A muscle that has lost a bit is a fault, whatever else is right.
#[test]
fn a_muscle_that_lost_a_bit_is_a_fault() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    assert!(bench.tick());
    bench.device.ends.bank.muscles[0].as_mut().expect("a muscle").flip_checksum_bit();
    assert!(!bench.tick());
    assert_eq!(bench.state(), State::Latched(Fault::Checksum));
}

/// Pulses of nothing need nobody to ask for them again.
#[test]
fn a_drive_of_no_current_does_not_grow_old() {
    let limits = Limits { readings_ms: 5_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let mut bench = Bench::armed(limits);
    let stimuli = [Some(Stimulus { amplitude_ua: 0, ..STIMULUS }), None, None, None];
    bench.order(Order::Drive(Guarded::new(stimuli)));
    assert!((0..2_000).all(|_| bench.tick()));
}

/// Nor those of a row.
#[test]
fn a_row_of_no_current_does_not_grow_old() {
    let limits = Limits { readings_ms: 5_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let mut bench = Bench::armed(limits);
    let none = Stimulus { amplitude_ua: 0, ..STIMULUS };
    bench.device.demand = Aged::new([Demand::Pulses(1, none), Demand::Nothing]);
    assert!((0..2_000).all(|_| bench.tick()));
}

/// A stop ends current; muscles that only compute go on with their rows.
#[test]
fn a_stop_while_nothing_is_armed_drops_no_row() {
    let mut bench = Bench::armed(Limits::SURFACE.within_scale(&SCALE));
    bench.order(Order::Stop);
    (0..10).for_each(|_| bench.row(row()));
    bench.order(Order::Stop);
    let before = bench.device.rows;
    (0..20).for_each(|_| {
        bench.tick();
    });
    assert_eq!(bench.device.rows - before, 9);
    assert_eq!(bench.state(), State::Latched(Fault::Stopped));
}

/// A host is there as long as it is heard, and no longer than its limit after that.
#[test]
fn a_host_that_is_not_heard_is_a_fault() {
    let limits = Limits { readings_ms: 5_000, ..Limits::SURFACE.within_scale(&SCALE) };
    let mut bench = Bench::armed(limits);
    (0..99).for_each(|_| {
        assert!(bench.device.tick(0));
    });
    assert!(bench.tick());
    let ticks = (0..1_000).take_while(|_| bench.device.tick(0)).count();
    assert_eq!(ticks, 100);
    assert_eq!(bench.state(), State::Latched(Fault::Silence));
}
