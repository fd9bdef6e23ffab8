//! Limits at their boundary: what is equal to a limit is allowed, the next step is not.

use firmware::safety::{Fault, Observed, Requested, State};
use firmware::{Limits, Stimulus};
use stimulator_tests::bench::{Bench, LIMITS, stimulus};
use stimulator_tests::device::LIMITS as BOARD;

/// As much as a limit says is allowed; the next step is not.
#[test]
fn a_demand_that_is_equal_to_its_limit_is_allowed() {
    let base = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 50,
        frequency_tenths_pps: 500,
        recovery: 1,
    };
    // 10 mA for 200 us, both phases, 50 times a second: 1.414 mA r.m.s.
    let tight = Limits {
        amplitude_ua: 10_000,
        width_us: 200,
        frequency_tenths_pps: 500,
        charge_nc: 2_000,
        rms_ua: 1_415,
        ..BOARD
    };
    let state = |limits: Limits, stimulus: Stimulus| {
        let mut bench = Bench::with(limits, 1000, Fault::Boot);
        bench.inject(|_, r, _| *r = Requested::NOTHING);
        bench.tick();
        bench.arm(Fault::Boot);
        bench.inject(move |_, r, _| {
            *r = Requested { stimuli: [Some(stimulus), None, None, None], ..Requested::NOTHING };
        });
        bench.flows(100);
        (bench.controller.state(), bench.put_out.len())
    };
    let (allowed, pulses) = state(tight, base);
    assert_eq!(allowed, State::Armed);
    assert!(pulses >= 4, "{pulses}");
    // 10 mA for 200 us, both phases, 25 times a second: 1 mA r.m.s. to the last digit.
    let slow = Stimulus { frequency_tenths_pps: 250, ..base };
    assert_eq!(state(Limits { rms_ua: 1_000, ..tight }, slow).0, State::Armed);
    // A recharge phase that is four times weaker, and longer, adds a quarter: 0.79057 mA.
    let weak = Stimulus { recovery: 4, ..slow };
    assert_eq!(state(Limits { rms_ua: 791, ..tight }, weak).0, State::Armed);
    let (refused, _) = state(Limits { rms_ua: 790, ..tight }, weak);
    assert_eq!(refused, State::Latched(Fault::RootMeanSquare));
    for (limits, stimulus, fault) in [
        (tight, Stimulus { amplitude_ua: 10_001, ..base }, Fault::Amplitude),
        (tight, Stimulus { width_us: 201, ..base }, Fault::Width),
        (tight, Stimulus { frequency_tenths_pps: 501, ..base }, Fault::Frequency),
        (Limits { charge_nc: 1_999, ..tight }, base, Fault::Charge),
        (Limits { rms_ua: 1_414, ..tight }, base, Fault::RootMeanSquare),
    ] {
        assert_eq!(state(limits, stimulus), (State::Latched(fault), 0));
    }
}

/// The same for observations: both ends of each range are allowed.
#[test]
fn a_reading_that_is_equal_to_its_limit_is_right() {
    let state = |change: fn(&mut Observed)| {
        let mut bench = Bench::running();
        bench.inject(move |o, _, _| change(o));
        bench.flows(3);
        bench.controller.state()
    };
    let (least, most) = LIMITS.supply_mv;
    assert_eq!((least, most), (3000, 4300));
    assert_eq!(state(|o| o.supply_mv = 3000), State::Armed);
    assert_eq!(state(|o| o.supply_mv = 4300), State::Armed);
    assert_eq!(state(|o| o.supply_mv = 2999), State::Latched(Fault::Supply));
    assert_eq!(state(|o| o.supply_mv = 4301), State::Latched(Fault::Supply));
    assert_eq!(LIMITS.impedance_ohm, (100, 5000));
    assert_eq!(state(|o| o.impedance_ohm[0] = Some(100)), State::Armed);
    assert_eq!(state(|o| o.impedance_ohm[0] = Some(5000)), State::Armed);
    assert_eq!(state(|o| o.impedance_ohm[0] = Some(99)), State::Latched(Fault::ElectrodeShort));
    assert_eq!(state(|o| o.impedance_ohm[0] = Some(5001)), State::Latched(Fault::ElectrodeOpen));
    // An electrode that does not stimulate may be anything.
    assert_eq!(state(|o| o.impedance_ohm[3] = Some(1)), State::Armed);
    // 1,000 mm/s are 1,000 um in a tick.
    let jump = |by: i32| {
        let mut bench = Bench::running();
        let mut path = 160_000;
        bench.inject(|o, _, _| o.path_um = Some(160_000));
        bench.flows(3);
        bench.inject(move |o, _, _| {
            path += by;
            o.path_um = Some(path);
        });
        bench.flows(3);
        bench.controller.state()
    };
    assert_eq!(jump(1000), State::Armed);
    assert_eq!(jump(-1000), State::Armed);
    assert_eq!(jump(1001), State::Latched(Fault::SensorJump));
}

/// A stimulus of no amplitude is none: its electrode is not looked at, and neither session nor
/// sensor grow older.
#[test]
fn a_stimulus_of_no_amplitude_is_no_stimulation() {
    let mut bench = Bench::running();
    bench.inject(|o, r, _| {
        *r = Requested { stimuli: [Some(stimulus(0)); 4], ..Requested::NOTHING };
        o.impedance_ohm = [Some(9_000); 4];
        o.path_um = Some(160_000);
    });
    // Longer than a session, and than a sensor may stay the same.
    bench.flows(6_000);
    assert_eq!(bench.controller.state(), State::Armed);
    bench.inject(|o, _, _| o.path_um = Some(160_000));
    bench.flows(1_900);
    assert_eq!(bench.controller.state(), State::Armed);
}

/// Charge stimulates: a pulse that becomes four times wider begins with a quarter of the counts,
/// and rises from there.
#[test]
fn a_pulse_that_becomes_wider_becomes_weaker_first() {
    let mut bench = Bench::new(Fault::Boot);
    bench.tick();
    bench.arm(Fault::Boot);
    let asks = |bench: &mut Bench, width_us| {
        bench.inject(move |_, r, _| {
            let stimulus = Stimulus { width_us, ..stimulus(20_000) };
            *r = Requested { stimuli: [Some(stimulus), None, None, None], ..Requested::NOTHING };
        });
    };
    asks(&mut bench, 100);
    bench.flows(800);
    let counts = |bench: &Bench| bench.put_out.last().expect("pulses").counts;
    assert_eq!(counts(&bench), 1638);
    let before = bench.put_out.len();
    asks(&mut bench, 400);
    bench.flows(110);
    // 2 mA of 50 mA by 4095 counts are 163.
    let after: Vec<u16> = bench.put_out[before..].iter().map(|pulse| pulse.counts).collect();
    assert_eq!(after[..3], [1638 / 4 + 163, 1638 / 4 + 2 * 163, 1638 / 4 + 3 * 163]);
    // Narrower, it may stay as strong as it was.
    bench.flows(800);
    assert_eq!(counts(&bench), 1638);
    let before = bench.put_out.len();
    asks(&mut bench, 200);
    bench.flows(60);
    assert_eq!(bench.put_out[before].counts, 1638);
}
