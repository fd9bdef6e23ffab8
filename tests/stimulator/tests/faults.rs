//! Every fault, injected into a stimulator that is giving pulses: how long until no current can
//! flow, what is latched, and what it takes to arm again.

use firmware::Stimulus;
use firmware::link::AngleReading;
use firmware::safety::{
    AngleObserved, CHANNELS, Fault, NotArmed, Observed, Requested, State, Supervisor,
};
use std::collections::HashSet;
use std::path::Path;
use stimulator_tests::bench::{Bench, LIMITS, stimulus};
use stimulator_tests::electrodes::SCALE;

/// A fault, how it is injected, and the most ticks it may take to see it.
struct Case {
    fault: Fault,
    how: &'static str,
    most_ms: u32,
    inject: fn(&mut Observed, &mut Requested, u32),
}

macro_rules! case {
    ($fault:ident, $how:literal, $most_ms:expr, |$o:pat_param, $r:pat_param, $t:pat_param| $do:expr) => {
        Case { fault: Fault::$fault, how: $how, most_ms: $most_ms, inject: |$o, $r, $t| $do }
    };
}

fn cases() -> Vec<Case> {
    vec![
        case!(Amplitude, "50.001 mA requested", 1, |_, r, _| r.stimuli[1] = Some(stimulus(50_001))),
        case!(Width, "501 µs requested", 1, |_, r, _| r.stimuli[1] =
            Some(Stimulus { width_us: 501, ..stimulus(1000) })),
        case!(Frequency, "100.1 pps requested", 1, |_, r, _| r.stimuli[1] =
            Some(Stimulus { frequency_tenths_pps: 1001, ..stimulus(1000) })),
        case!(Charge, "50 mA for 401 µs requested", 1, |_, r, _| r.stimuli[1] =
            Some(Stimulus { width_us: 401, frequency_tenths_pps: 10, ..stimulus(50_000) })),
        case!(RootMeanSquare, "11.2 mA r.m.s. requested", 1, |_, r, _| r.stimuli[1] =
            Some(Stimulus {
                width_us: 250,
                frequency_tenths_pps: 1000,
                recovery: 1,
                ..stimulus(50_000)
            })),
        case!(Session, "the last 4 s of a session of 5 s", 4_000, |_, _, _| ()),
        case!(Silence, "the host is silent", 101, |o, _, _| o.host_heard = false),
        case!(ElectrodeShort, "99 Ω at channel 1", 1, |o, _, _| o.impedance_ohm[1] = Some(99)),
        case!(ElectrodeOpen, "5,001 Ω at channel 0", 1, |o, _, _| o.impedance_ohm[0] = Some(5001)),
        case!(Supply, "2.999 V of supply", 1, |o, _, _| o.supply_mv = 2999),
        case!(SensorMissing, "no reading of the path", 1, |o, _, _| o.path_um = None),
        case!(SensorRange, "the path slowly reaches 49.999 mm", 111, |o, _, t| o.path_um =
            Some((160_000 - 1000 * t as i32).max(49_999))),
        case!(SensorJump, "the path jumps by 1.01 mm each tick", 1, |o, _, t| o.path_um =
            Some(160_000 + if t.is_multiple_of(2) { 1010 } else { 0 })),
        case!(SensorStuck, "the path stays at 160.001 mm", 2_002, |o, _, _| o.path_um =
            Some(160_001)),
        case!(SensorMissing, "no angle of the joint", 32, |o, _, t| o.angle = read_once(t)),
        case!(SensorRange, "slowly 176 mrad beyond the joint", 60, |o, _, t| {
            o.angle = reading(t, (1_000_000 + 20_000 * t as i32).min(2_176_000));
        }),
        case!(SensorJump, "angles jump by 51 mrad", 2, |o, _, t| o.angle =
            reading(t, 1_000_000 + if t.is_multiple_of(2) { 51_000 } else { 0 })),
        case!(SensorStuck, "the angle stays", 2_002, |o, _, t| o.angle = reading(t, 1_000_000)),
        case!(SensorTime, "stamps gain 31 ms", 2, |o, _, t| {
            o.angle = reading(32 * t, 1_000_000 + (t % 3) as i32);
        }),
        case!(Deadline, "a late tick", 1, |o, _, _| o.in_time = false),
        case!(Watchdog, "a restart by the watchdog", 1, |_, _, _| ()),
        case!(Checksum, "a flipped bit in the state", 1, |o, _, _| o.memory_is_intact = false),
        case!(Output, "the output stage does not answer", 1, |o, _, _| o.output_answers = false),
        case!(Request, "19 µs of width, below the shortest phase", 1, |_, r, _| r.stimuli[1] =
            Some(Stimulus { width_us: 19, ..stimulus(1000) })),
        case!(Request, "a row with infinite activation", 1, |_, r, _| r.is_finite = false),
        case!(Stopped, "stopped by the host", 1, |_, _, _| ()),
        case!(StaleRow, "rows stop coming", 52, |_, r, t| r.row_age_us = u64::from(1000 * t)),
        case!(StaleDrive, "the host does not repeat its drive", 1_002, |_, r, t| r.drive_age_us =
            u64::from(1000 * t)),
        case!(StaleTarget, "targets stop", 102, |_, r, t| r.target_age_us = u64::from(1000 * t)),
        case!(Gain, "a gain out of range", 1, |_, r, _| r.gain_is_valid = false),
    ]
}

/// A joint of -1 to 2 rad whose angle is read in every tick.
fn reading(tick: u32, angle_urad: i32) -> Option<AngleObserved> {
    let reading = AngleReading { time_us: 1000 * tick, angle_urad };
    Some(AngleObserved {
        reading: Some(reading),
        range_urad: (-1_000_000, 2_000_000),
        period_us: 1_000,
    })
}

/// The same, read once and not again.
fn read_once(tick: u32) -> Option<AngleObserved> {
    let observed = reading(tick, 1_000_000)?;
    Some(AngleObserved { reading: observed.reading.filter(|_| tick == 0), ..observed })
}

/// Over once they are latched.
const OVER: [Fault; 2] = [Fault::Watchdog, Fault::Stopped];

/// A row of the table.
fn row(case: &Case) -> String {
    let mut bench = Bench::running();
    bench.inject(case.inject);
    match case.fault {
        Fault::Watchdog => bench = Bench::new(Fault::Watchdog),
        // Between two ticks, as the link does.
        Fault::Stopped => bench.controller.fail(Fault::Stopped),
        _ => (),
    }
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
        Ok(()) if OVER.contains(&case.fault) => "allowed",
        Ok(()) => {
            // A request is looked at once it could be put out.
            assert!(!bench.flows(1), "{:?}: current from a request that is a fault", case.fault);
            assert_eq!(bench.controller.state(), State::Latched(case.fault));
            "latches again"
        }
        Err(other) => panic!("{other:?}"),
    };

    // With the cause gone, in two steps, and from nothing.
    if again != "allowed" {
        bench.inject_nothing();
        assert!(!bench.flows(700), "it does not go on by itself");
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
    assert_eq!((tested.len(), tested.contains(&Fault::Boot)), (25, false));
    let mut table = String::from(
        "| fault | injected | ticks until neutral | arming while it lasts |\n|---|---|---:|---|\n",
    );
    cases.iter().for_each(|case| table.push_str(&row(case)));

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../firmware/README.md");
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
    let mut bench = Bench::new(Fault::Boot);
    assert_eq!(bench.controller.state(), State::Latched(Fault::Boot));
    assert_eq!(bench.controller.arm(), Err(NotArmed::NotAcknowledged));
    assert!(!bench.flows(1000));
    // Armed before anything was seen: nothing says that all is well.
    let mut bench = Bench::new(Fault::Boot);
    bench.controller.acknowledge(Fault::Boot).expect("its name");
    assert_eq!(bench.controller.arm(), Err(NotArmed::StillThere(Fault::Boot)));
}

#[test]
fn an_acknowledgement_lasts_ten_seconds() {
    let mut bench = Bench::new(Fault::Boot);
    bench.tick();
    bench.controller.acknowledge(Fault::Boot).expect("its name");
    assert!(!bench.flows(10_001));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Boot));
    assert_eq!(bench.controller.arm(), Err(NotArmed::NotAcknowledged));
}

#[test]
fn amplitudes_rise_by_no_more_per_pulse_than_they_may_and_fall_at_once() {
    let mut bench = Bench::new(Fault::Boot);
    bench.tick();
    bench.arm(Fault::Boot);
    let (mut before, mut pulses) = (0_u32, 0);
    for _ in 0..1000 {
        let counts = u32::from(bench.counts());
        if counts > 0 && counts != before {
            // 2 mA a pulse at 40 pps, and two channels with their own.
            let step = (f64::from(counts) - f64::from(before)) * 50_000.0 / 4095.0;
            assert!(step <= 2_000.0, "{step} µA");
            (before, pulses) = (counts, pulses + 1);
        }
    }
    assert!(pulses > 5 && before == 20_000 * 4095 / 50_000, "{pulses} steps to {before} counts");
    // Down in one step, and up again slowly.
    bench.inject(|_, r, _| r.stimuli = [Some(stimulus(500)), None, None, None]);
    // A pulse that has begun ends as it is.
    bench.tick();
    assert!((0..100).all(|_| bench.counts() <= 41));
    bench.inject_nothing();
    assert!((0..25).all(|_| bench.counts() <= 41 + 4095 * 2 / 50));
}

/// An output stage that breaks in the middle of a pulse, between ticks.
#[test]
fn an_output_that_stops_answering_is_seen_by_the_next_step() {
    for break_it in [0, 1] {
        let mut bench = Bench::running();
        bench.until_current();
        {
            let mut electrodes = bench.electrodes.borrow_mut();
            electrodes.broken_converter = break_it == 0;
            electrodes.broken_pins = break_it == 1;
        }
        // Nothing that could still be put in neutral is left as it was; the next tick latches. Pins
        // are spoken to where they turn, which is the third step: what is left of the phase, gap,
        // turning.
        for _ in 0..3 {
            bench.run_out();
        }
        let electrodes = bench.electrodes.borrow();
        let bridge = electrodes.cathodic || electrodes.anodic;
        assert!(electrodes.counts == 0 || !bridge, "a way for the current is left");
        drop(electrodes);
        bench.tick();
        assert_eq!(bench.controller.state(), State::Latched(Fault::Output));
        // It stays off while it is broken, and can be armed when it answers.
        bench.controller.acknowledge(Fault::Output).expect("its name");
        bench.tick();
        assert_eq!(bench.controller.arm(), Err(NotArmed::StillThere(Fault::Output)));
        bench.electrodes.borrow_mut().broken_converter = false;
        bench.electrodes.borrow_mut().broken_pins = false;
        bench.tick();
        bench.arm(Fault::Output);
        assert!(bench.flows(100));
    }
}

/// A tick that never ends sends no plans; the pulse timer does not need it to stop.
#[test]
fn a_tick_that_hangs_ends_in_neutral_within_two_ticks() {
    let mut bench = Bench::running();
    bench.until_current();
    bench.hangs = true;
    bench.flows(2);
    assert_eq!(bench.flowing(), 0);
    assert!(!bench.flows(1000));
    // When it comes back, it latches what has happened, and can be armed again.
    bench.hangs = false;
    assert!(!bench.flows(10));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Deadline));
    bench.arm(Fault::Deadline);
    assert!(bench.flows(100));
}

/// A timer whose interrupt was too late has put out a phase of another length.
#[test]
fn a_pulse_timer_that_overruns_is_a_fault() {
    let mut bench = Bench::running();
    bench.until_current();
    bench.electrodes.borrow_mut().words = 0;
    bench.pulses.overran();
    assert_eq!(bench.flowing(), 0);
    assert!(!bench.flows(10));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Deadline));
}

/// A pulse that becomes wider becomes weaker first: its charge rises by no more per pulse than an
/// amplitude's may.
#[test]
fn a_wider_pulse_is_no_way_round_the_rise() {
    let mut bench = Bench::running();
    let (mut before, mut width) = (0_u32, 20_u16);
    for tick in 0..600 {
        if tick == 300 {
            width = 400;
        }
        bench.inject(move |_, r, _| {
            r.stimuli = [Some(Stimulus { width_us: width, ..stimulus(20_000) }), None, None, None];
        });
        let charge = u32::from(bench.counts()) * u32::from(width);
        if charge > 0 {
            // 2 mA for 400 µs in counts, and what rounding adds.
            assert!(charge <= before + (2 * 4095 / 50 + 2) * 400, "{charge} after {before}");
            before = charge;
        }
    }
    assert!(before >= 19 * 4095 / 50 * 400, "{before}");
}

/// Pauses of stimulation do not make a stuck sensor work.
#[test]
fn a_sensor_that_is_stuck_is_seen_in_spite_of_pauses() {
    let mut bench = Bench::running();
    bench.inject(|o, r, tick| {
        o.path_um = Some(160_001);
        if tick % 1000 < 500 {
            r.stimuli = [None; CHANNELS];
        }
    });
    let ticks = (0..10_000).take_while(|_| {
        bench.tick();
        bench.controller.state() == State::Armed
    });
    // More than two seconds of stimulation, every other half second, each with the 25 ms after its
    // last pulse.
    let ticks = ticks.count();
    assert!((3_900..=3_902).contains(&ticks), "{ticks}");
    assert_eq!(bench.controller.state(), State::Latched(Fault::SensorStuck));
}

/// Limits in time are times, whatever the tick rate.
#[test]
fn limits_are_the_same_times_at_every_tick_rate() {
    let observed = |host_heard, path_um| Observed {
        host_heard,
        impedance_ohm: [None; CHANNELS],
        supply_mv: 3700,
        path_um: Some(path_um),
        path_is_new: true,
        angle: None,
        in_time: true,
        memory_is_intact: true,
        output_answers: true,
    };
    for tick_us in [500, 1000, 2000] {
        let armed = || {
            let mut supervisor =
                Supervisor::new(LIMITS, tick_us, &SCALE, Fault::Boot).expect("valid limits");
            supervisor.tick(&observed(true, 160_000), &Requested::NOTHING);
            supervisor.acknowledge(Fault::Boot).expect("its name");
            supervisor.arm().expect("nothing is wrong");
            supervisor
        };
        let until =
            |supervisor: &mut Supervisor, mut input: Box<dyn FnMut(i32) -> Observed>, request| {
                let mut ticks = 0;
                while supervisor.state() == State::Armed {
                    supervisor.tick(&input(ticks), &request);
                    ticks += 1;
                    assert!(ticks < 20_000, "for ever");
                }
                (supervisor.state(), ticks as u32 * tick_us / 1000)
            };
        let off = Requested::NOTHING;
        let on = Requested { stimuli: [Some(stimulus(1000)), None, None, None], ..off };
        let noisy = move |tick: i32| observed(true, 160_000 + tick % 2);
        let silence =
            until(&mut armed(), Box::new(move |tick| observed(false, 160_000 + tick % 2)), off);
        assert_eq!(silence.0, State::Latched(Fault::Silence));
        assert!((100..=102).contains(&silence.1), "{silence:?} at {tick_us}");
        let session = until(&mut armed(), Box::new(noisy), on);
        assert_eq!(session.0, State::Latched(Fault::Session));
        assert!((5000..=5002).contains(&session.1), "{session:?} at {tick_us}");
        let stuck = until(&mut armed(), Box::new(move |_| observed(true, 160_000)), on);
        assert_eq!(stuck.0, State::Latched(Fault::SensorStuck));
        assert!((2000..=2004).contains(&stuck.1), "{stuck:?} at {tick_us}");
        // 1 m/s, and a µm a tick more.
        let tick = tick_us as i32;
        let mut supervisor = armed();
        supervisor.tick(&observed(true, 160_000 + tick), &off);
        assert_eq!(supervisor.state(), State::Armed);
        supervisor.tick(&observed(true, 160_000 + 2 * tick + 1), &off);
        assert_eq!(supervisor.state(), State::Latched(Fault::SensorJump));
    }
}
