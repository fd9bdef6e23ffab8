//! Every fault, injected into a stimulator that is giving pulses: how long until no current can flow, what is
//! latched, and what it takes to arm again.

use firmware::safety::{CHANNELS, Fault, Limits, NotArmed, Observed, State};
use firmware::{Controller, Stimulus};
use std::collections::HashSet;
use std::path::Path;
use system_tests::electrodes::{Converter, Pin, SCALE, Shared, stage};

type Request = [Option<Stimulus>; CHANNELS];

/// A tick, µs.
const TICK: u32 = 1000;

/// A controller on fakes, and the time.
struct Bench {
    controller: Controller<Converter, Pin>,
    electrodes: Shared,
    tick: u32,
    /// When the pulse timer runs out, µs.
    timer: u32,
    /// What observation and request are changed by, if a fault is injected.
    inject: Option<fn(&mut Observed, &mut Request, u32)>,
    injected: u32,
}

fn stimulus(amplitude_ua: u32) -> Stimulus {
    Stimulus { amplitude_ua, width_us: 200, gap_us: 50, frequency_tenths_pps: 400, recovery: 1 }
}

/// Long sessions cost time.
const LIMITS: Limits = Limits { session_ms: 5_000, ..Limits::SURFACE };

impl Bench {
    fn new() -> Self {
        let (stage, electrodes) = stage();
        let controller = Controller::new(LIMITS, SCALE, stage);
        Self { controller, electrodes, tick: 0, timer: 0, inject: None, injected: 0 }
    }

    /// A tick, and all that the timer does until the next one. True if current can flow at any time after the
    /// tick itself.
    fn tick(&mut self) -> bool {
        self.counts() > 0
    }

    /// The same: the most counts while a way for the current is open.
    fn counts(&mut self) -> u16 {
        let mut observed = Observed {
            host_heard: self.tick.is_multiple_of(20),
            impedance_ohm: [Some(900), Some(1100), None, None],
            supply_mv: 3700,
            // With the noise that a sensor has.
            path_um: Some(160_000 + (self.tick % 3) as i32),
            in_time: true,
            restarted_by_watchdog: false,
            checksums: [0x1234_5678; 2],
            output_answers: true,
        };
        let mut request = [Some(stimulus(20_000)), Some(stimulus(20_000)), None, None];
        if let Some(inject) = self.inject {
            inject(&mut observed, &mut request, self.tick - self.injected);
        }
        self.controller.tick(&observed, &request);
        self.tick += 1;
        let mut most = self.flowing();
        while self.timer < self.tick * TICK {
            self.timer += self.controller.timer();
            most = most.max(self.flowing());
        }
        most
    }

    fn flowing(&self) -> u16 {
        let electrodes = self.electrodes.borrow();
        assert!(electrodes.problems.is_empty(), "{:?}", electrodes.problems);
        if electrodes.cathodic || electrodes.anodic { electrodes.counts } else { 0 }
    }

    /// Whether any of so many ticks lets current flow.
    fn flows(&mut self, ticks: u32) -> bool {
        (0..ticks).fold(false, |flows, _| self.tick() | flows)
    }

    fn arm(&mut self, fault: Fault) {
        self.controller.acknowledge(fault).expect("the fault that is latched");
        self.tick();
        self.controller.arm().expect("nothing is wrong");
    }

    /// Giving pulses of full amplitude.
    fn running() -> Self {
        let mut bench = Self::new();
        bench.tick();
        bench.arm(Fault::Boot);
        assert!(bench.flows(1000));
        bench
    }
}

/// A fault, how it is injected, and the most ticks it may take to see it.
struct Case {
    fault: Fault,
    how: &'static str,
    most_ms: u32,
    inject: fn(&mut Observed, &mut Request, u32),
}

macro_rules! case {
    ($fault:ident, $how:literal, $most_ms:expr, |$o:pat_param, $r:pat_param, $t:pat_param| $do:expr) => {
        Case { fault: Fault::$fault, how: $how, most_ms: $most_ms, inject: |$o, $r, $t| $do }
    };
}

fn cases() -> Vec<Case> {
    vec![
        case!(Amplitude, "100.001 mA asked for", 1, |_, r, _| r[1] = Some(stimulus(100_001))),
        case!(Width, "501 µs asked for", 1, |_, r, _| r[1] =
            Some(Stimulus { width_us: 501, ..stimulus(1000) })),
        case!(Frequency, "100.1 pps asked for", 1, |_, r, _| r[1] =
            Some(Stimulus { frequency_tenths_pps: 1001, ..stimulus(1000) })),
        case!(Charge, "100 mA for 401 µs asked for", 1, |_, r, _| r[1] =
            Some(Stimulus { width_us: 401, frequency_tenths_pps: 10, ..stimulus(100_000) })),
        case!(RootMeanSquare, "25 mA r.m.s. asked for", 1, |_, r, _| r[1] = Some(Stimulus {
            width_us: 500,
            frequency_tenths_pps: 1000,
            recovery: 1,
            ..stimulus(79_000)
        })),
        case!(Session, "5 s of stimulation, 1 s of which had gone", 4_000, |_, _, _| ()),
        case!(Silence, "the host is not heard of", 101, |o, _, _| o.host_heard = false),
        case!(ElectrodeShort, "99 Ω at channel 1", 1, |o, _, _| o.impedance_ohm[1] = Some(99)),
        case!(ElectrodeOpen, "5,001 Ω at channel 0", 1, |o, _, _| o.impedance_ohm[0] = Some(5001)),
        case!(Supply, "2.999 V of supply", 1, |o, _, _| o.supply_mv = 2999),
        case!(SensorMissing, "no number for the path", 1, |o, _, _| o.path_um = None),
        case!(SensorRange, "49.999 mm of path, reached slowly", 111, |o, _, t| o.path_um =
            Some((160_000 - 1000 * t as i32).max(49_999))),
        case!(SensorJump, "the path jumps by 1.01 mm each tick", 1, |o, _, t| o.path_um =
            Some(160_000 + if t.is_multiple_of(2) { 1010 } else { 0 })),
        case!(SensorStuck, "the path stays at 160.001 mm", 2_002, |o, _, _| o.path_um =
            Some(160_001)),
        case!(Deadline, "a tick that was late", 1, |o, _, _| o.in_time = false),
        case!(Watchdog, "a restart by the watchdog", 1, |o, _, _| o.restarted_by_watchdog = true),
        case!(Checksum, "one bit of the state", 1, |o, _, _| o.checksums[0] ^= 1 << 17),
        case!(Output, "the output stage does not answer", 1, |o, _, _| o.output_answers = false),
        case!(Request, "9 µs of width, which the stimulator cannot do", 1, |_, r, _| r[1] =
            Some(Stimulus { width_us: 9, ..stimulus(1000) })),
    ]
}

/// A row of the table.
fn row(case: &Case) -> String {
    let mut bench = Bench::running();
    bench.inject = Some(case.inject);
    bench.injected = bench.tick;
    let mut took = 0;
    loop {
        let flows = bench.tick();
        took += 1;
        if bench.controller.state() != State::Armed {
            assert!(!flows, "{:?}: current in the tick that saw it", case.fault);
            break;
        }
        assert!(took <= case.most_ms, "{:?} was not seen for {took} ms", case.fault);
    }
    assert_eq!(bench.controller.state(), State::Latched(case.fault), "{}", case.how);
    assert!(!bench.flows(500), "{:?}: current while it is latched", case.fault);

    // Not by another name, not in one step, and not while it lasts.
    let other = if case.fault == Fault::Supply { Fault::Boot } else { Fault::Supply };
    assert_eq!(bench.controller.acknowledge(other), Err(NotArmed::OtherFault));
    assert_eq!(bench.controller.arm(), Err(NotArmed::NotAcknowledged));
    bench.controller.acknowledge(case.fault).expect("its name");
    assert!(!bench.flows(10));
    let again = match bench.controller.arm() {
        Err(NotArmed::StillThere(fault)) => {
            assert_eq!(fault, case.fault);
            "refused"
        }
        Ok(()) if case.fault == Fault::Session => "a new session",
        Ok(()) => {
            // A request is looked at once it could be put out.
            assert!(!bench.flows(1), "{:?}: current from a request that is a fault", case.fault);
            assert_eq!(bench.controller.state(), State::Latched(case.fault));
            "latches again"
        }
        Err(other) => panic!("{other:?}"),
    };

    // With the cause gone, in two steps, and from nothing.
    if again != "a new session" {
        bench.inject = None;
        assert!(!bench.flows(150), "it does not go on by itself");
        bench.arm(case.fault);
    }
    // 2 mA with the first pulse.
    assert!((0..25).all(|_| bench.counts() <= 4095 * 2 / 50), "amplitudes begin at nothing");
    assert!(bench.flows(100), "{:?}: armed again", case.fault);
    assert_eq!(bench.controller.state(), State::Armed);
    format!("| {:?} | {} | {took} | {again} |\n", case.fault, case.how)
}

#[test]
fn every_fault_ends_in_neutral_and_is_in_the_table() {
    let cases = cases();
    let tested: HashSet<Fault> = cases.iter().map(|case| case.fault).collect();
    // All but the one that everything starts with.
    assert_eq!((tested.len(), tested.contains(&Fault::Boot)), (19, false));
    let mut table = String::from(
        "| fault | injected | ticks until neutral | arming while it lasts |\n|---|---|---:|---|\n",
    );
    cases.iter().for_each(|case| table.push_str(&row(case)));

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/README.md");
    let text = std::fs::read_to_string(&path).expect("the firmware's README");
    let (before, rest) = text.split_once("<!-- faults -->").expect("a place for the table");
    let (_, after) = rest.split_once("<!-- end of faults -->").expect("a place for the table");
    let written = format!("{before}<!-- faults -->\n\n{table}\n<!-- end of faults -->{after}");
    if std::env::var_os("VM_WRITE").is_some() {
        std::fs::write(&path, &written).expect("the firmware's README");
    } else {
        assert!(text == written, "the table is another one:\n{table}");
    }
}

#[test]
fn everything_is_off_at_boot() {
    let mut bench = Bench::new();
    assert_eq!(bench.controller.state(), State::Latched(Fault::Boot));
    assert_eq!(bench.controller.arm(), Err(NotArmed::NotAcknowledged));
    assert!(!bench.flows(1000));
    // Armed before anything was seen: nothing says that all is well.
    let mut bench = Bench::new();
    bench.controller.acknowledge(Fault::Boot).expect("its name");
    assert_eq!(bench.controller.arm(), Err(NotArmed::StillThere(Fault::Boot)));
}

#[test]
fn an_acknowledgement_lasts_ten_seconds() {
    let mut bench = Bench::new();
    bench.tick();
    bench.controller.acknowledge(Fault::Boot).expect("its name");
    assert!(!bench.flows(10_001));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Boot));
    assert_eq!(bench.controller.arm(), Err(NotArmed::NotAcknowledged));
}

#[test]
fn amplitudes_rise_by_no_more_per_pulse_than_they_may_and_fall_at_once() {
    let mut bench = Bench::new();
    bench.tick();
    bench.arm(Fault::Boot);
    let (mut before, mut pulses) = (0_u32, 0);
    for _ in 0..1000 {
        let counts = u32::from(bench.counts());
        if counts > 0 && counts != before {
            // 2 mA a pulse at 40 pps, and two channels with their own.
            let step = (f64::from(counts) - f64::from(before)) * 50_000.0 / 4095.0;
            assert!(step <= 2_000.0 + 13.0, "{step} µA");
            (before, pulses) = (counts, pulses + 1);
        }
    }
    assert!(pulses > 5 && before == 20_000 * 4095 / 50_000, "{pulses} steps to {before} counts");
    // Down in one step, and up again slowly.
    bench.inject = Some(|_, r, _| *r = [Some(stimulus(500)), None, None, None]);
    bench.injected = bench.tick;
    // A pulse that has begun ends as it is.
    bench.tick();
    assert!((0..100).all(|_| bench.counts() <= 41));
    bench.inject = None;
    assert!((0..25).all(|_| bench.counts() <= 41 + 4095 * 2 / 50));
}

/// An output stage that breaks in the middle of a pulse, between ticks.
#[test]
fn an_output_that_stops_answering_is_seen_by_the_next_step() {
    for break_it in [0, 1] {
        let mut bench = Bench::running();
        while bench.electrodes.borrow().counts == 0 {
            bench.timer += bench.controller.timer();
        }
        {
            let mut electrodes = bench.electrodes.borrow_mut();
            electrodes.broken_converter = break_it == 0;
            electrodes.broken_pins = break_it == 1;
        }
        let began = bench.timer;
        while bench.controller.state() == State::Armed {
            assert!(bench.timer - began < 1000, "not seen within a phase");
            bench.timer += bench.controller.timer();
        }
        assert_eq!(bench.controller.state(), State::Latched(Fault::Output));
        let electrodes = bench.electrodes.borrow();
        let bridge = electrodes.cathodic || electrodes.anodic;
        assert!(electrodes.counts == 0 || !bridge, "a way for the current is left");
        drop(electrodes);
        // It stays off while it is broken, and can be armed when it answers.
        bench.controller.acknowledge(Fault::Output).expect("its name");
        bench.tick();
        assert_eq!(bench.controller.arm(), Err(NotArmed::StillThere(Fault::Output)));
        bench.electrodes.borrow_mut().broken_converter = false;
        bench.electrodes.borrow_mut().broken_pins = false;
        bench.arm(Fault::Output);
        assert!(bench.flows(100));
    }
}
