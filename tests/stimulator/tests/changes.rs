//! One test for each change that once went unnoticed. `tests/planted` has
//! the changes.

use firmware::link::{Electrode, Mode, Request, RowInputs, Upload};
use firmware::safety::{Fault, Observed, Requested, State};
use firmware::{Guarded, Limits, Plan, Schedule, Step, Stimulus};
use stimulator_tests::bench::{Bench, stimulus};
use stimulator_tests::client::ClientError;
use stimulator_tests::device::LIMITS as BOARD;
use stimulator_tests::electrodes::SCALE;
use stimulator_tests::host::{ELECTRODE, Host, READINGS, arm, booted, fes, report};

/// Armed, with a muscle whose electrode rows stimulate.
fn with_muscle() -> Host {
    let mut host = booted();
    let upload = Upload { electrode: Some(ELECTRODE), ..fes() };
    host.order(&Request::Upload { place: 0, upload }).expect("a muscle");
    host.order(&Request::Rest([Some(0.16), None])).expect("a path");
    arm(&mut host, Fault::Boot);
    host
}

/// Rows from a number on, as many as a message has.
fn rows(first: u32, activation: f32, stimulation_frequency: f32) -> Request {
    let row = RowInputs { activation, path_length: 0.16, stimulation_frequency };
    let rows = heapless::Vec::from_slice(&[[row, RowInputs::default()]; 8]).expect("room");
    Request::Rows { first, rows }
}

#[test]
fn what_rows_asked_for_is_forgotten_after_a_fault() {
    let mut host = with_muscle();
    host.order(&rows(0, 1.0, 80.0)).expect("room");
    (0..8).for_each(|_| host.line().tick());
    assert!(host.line().flowed() > 0);
    host.order(&Request::Stop).expect("a stop");
    // Before a row is too old.
    arm(&mut host, Fault::Stopped);
    host.line().flowed();
    (0..40).for_each(|_| host.line().tick());
    assert_eq!(report(&mut host).state, State::Armed);
    assert_eq!(host.line().flowed(), 0);
}

#[test]
fn no_activation_and_less_than_a_pulse_a_second_are_no_pulses() {
    for (activation, frequency) in [(0.0, 80.0), (-1.0, 80.0), (1.0, 0.9), (1.0, 0.0), (1.0, -5.0)]
    {
        let mut host = with_muscle();
        for first in (0..80).step_by(8) {
            host.order(&rows(first, activation, frequency)).expect("room");
            (0..8).for_each(|_| host.line().tick());
        }
        assert_eq!(host.line().flowed(), 0, "{activation} {frequency}");
        // And no fault.
        assert_eq!(report(&mut host).state, State::Armed, "{activation} {frequency}");
    }
    let mut host = with_muscle();
    host.order(&rows(0, 1.0, 1.0)).expect("room");
    (0..8).for_each(|_| host.line().tick());
    assert!(host.line().flowed() > 0, "one pulse a second");
}

#[test]
fn an_electrode_is_only_for_fes() {
    let mut host = booted();
    let electrode = Some(Electrode { channel: 1, ..ELECTRODE });
    let upload = Upload { mode: Mode::Continuous, electrode, ..fes() };
    let refused = host.order(&Request::Upload { place: 0, upload });
    let reason = "electrode: only for FES = 1: must be 0 to 0".to_owned();
    assert_eq!(refused, Err(ClientError::Refused { reason, no_room: false }));
    // A muscle without one is taken.
    let upload = Upload { mode: Mode::Continuous, ..fes() };
    host.order(&Request::Upload { place: 0, upload }).expect("a muscle");
}

/// A stimulator at 100 pps whose tick does not come any more, at any time of its period.
#[test]
fn a_permission_holds_for_two_ticks_and_no_longer() {
    let mut latest = 0;
    for after in 0..50 {
        let mut bench = Bench::new(Fault::Boot);
        bench.inject(|_, r, _| {
            let stimulus = Stimulus { frequency_tenths_pps: 1000, ..stimulus(5_000) };
            let stimuli = [Some(stimulus), Some(stimulus), Some(stimulus), Some(stimulus)];
            *r = Requested { stimuli, ..Requested::NOTHING };
        });
        bench.tick();
        bench.arm(Fault::Boot);
        bench.flows(100 + after);
        let last = bench.tick * 1000;
        bench.hangs = true;
        bench.flows(10);
        // The last tick began a ms before.
        let begun = bench.put_out.last().expect("pulses").at_us.saturating_sub(last - 1000);
        assert!(begun <= 2_000 + 500, "a pulse {begun} us after the last tick");
        latest = latest.max(begun);
    }
    assert!(latest > 1_200, "{latest} us");
}

/// Electrodes of a pulse that was cut short: connected for 20 ms, then off.
#[test]
fn a_discharge_lasts_for_twenty_milliseconds_and_ends() {
    let mut bench = Bench::running();
    bench.until_current();
    bench.controller.fail(Fault::Stopped);
    bench.electrodes.borrow_mut().words = 0;
    bench.pulses.attend();
    let cut_us = bench.timer;
    let connected = |bench: &Bench| bench.electrodes.borrow().channels.contains(&true);
    while bench.timer < cut_us + 60_000 && connected(&bench) {
        assert_eq!(bench.flowing(), 0);
        if bench.timer >= bench.tick * 1000 {
            bench.control();
        }
        bench.run_out();
    }
    let lasted_us = bench.timer - cut_us;
    assert!((19_500..=20_750).contains(&lasted_us), "{lasted_us} us");
}

#[test]
fn a_fault_of_a_moment_between_the_two_steps_of_arming_is_not_missed() {
    let after = |change: fn(&mut Observed)| {
        let mut bench = Bench::new(Fault::Boot);
        bench.tick();
        bench.controller.acknowledge(Fault::Boot).expect("its name");
        bench.inject(move |o, _, tick| {
            if tick == 0 {
                change(o);
            }
        });
        bench.flows(5);
        bench.controller.state()
    };
    assert_eq!(after(|o| o.memory_is_intact = false), State::Latched(Fault::Checksum));
    assert_eq!(after(|o| o.in_time = false), State::Latched(Fault::Deadline));
    assert_eq!(after(|o| o.output_answers = false), State::Latched(Fault::Output));
    // A fault that persists is detected when arming.
    let supply = after(|o| o.supply_mv = 0);
    assert!(matches!(supply, State::Acknowledged { fault: Fault::Boot, .. }), "{supply:?}");
}

/// The converter misses one word of a pulse, and takes the next.
#[test]
fn one_word_that_the_converter_does_not_take_is_reported() {
    for word in 0..6 {
        let mut bench = Bench::running();
        bench.until_current();
        (0..word).for_each(|_| bench.run_out());
        bench.electrodes.borrow_mut().missed_words = 1;
        bench.flows(30);
        assert_eq!(bench.electrodes.borrow().missed_words, 0);
        assert_eq!(bench.controller.state(), State::Latched(Fault::Output), "word {word}");
    }
}

/// Bytes that the line has lost are a frame that is broken, whatever comes after them.
#[test]
fn bytes_that_were_lost_break_the_frame_they_belong_to() {
    let mut host = booted();
    let broken = report(&mut host).frames.broken;
    let (session, sequence) = host.session();
    let frame = firmware::link::encode(session, sequence, &Request::Readings(READINGS));
    let frame = frame.expect("a frame");
    host.send_raw(&frame[..5]);
    host.line().tick();
    host.line().lose();
    host.send_raw(&frame[5..]);
    (0..5).for_each(|_| host.line().tick());
    host.listen();
    assert_eq!(report(&mut host).frames.broken, broken + 1);
}

/// A sensor that has moved in a pause works.
#[test]
fn a_sensor_that_moves_in_a_pause_is_not_stuck() {
    let mut bench = Bench::running();
    bench.inject(|o, _, _| o.path_um = Some(160_000));
    bench.flows(1_500);
    bench.inject(|o, r, _| {
        *r = Requested::NOTHING;
        o.path_um = Some(160_001);
    });
    bench.flows(2);
    bench.inject(|o, _, _| o.path_um = Some(160_001));
    bench.flows(1_500);
    assert_eq!(bench.controller.state(), State::Armed);
    bench.flows(600);
    assert_eq!(bench.controller.state(), State::Latched(Fault::SensorStuck));
}

#[test]
fn what_is_wrong_is_told_before_anybody_arms() {
    let mut bench = Bench::new(Fault::Boot);
    bench.tick();
    assert_eq!(bench.controller.wrong(), None);
    bench.inject(|o, _, _| o.supply_mv = 0);
    bench.tick();
    assert_eq!(bench.controller.wrong(), Some(Fault::Supply));
    assert_eq!(bench.controller.state(), State::Latched(Fault::Boot));
}

/// A tick that hung for 5 ms is a fault even where no pulse was due.
#[test]
fn a_tick_that_hung_between_pulses_is_a_fault() {
    let mut bench = Bench::running();
    let pulses = bench.put_out.len();
    while bench.put_out.len() < pulses + 2 {
        bench.tick();
    }
    // Both channels have had theirs: 20 ms without one follow.
    bench.tick();
    bench.hangs = true;
    bench.flows(5);
    bench.hangs = false;
    assert_eq!(bench.put_out.len(), pulses + 2);
    bench.tick();
    assert_eq!(bench.controller.state(), State::Latched(Fault::Deadline));
    // Without a plan there is nothing to be late for.
    let mut bench = Bench::new(Fault::Boot);
    bench.inject(|_, r, _| *r = Requested::NOTHING);
    bench.tick();
    bench.arm(Fault::Boot);
    bench.flows(5);
    bench.hangs = true;
    bench.flows(5);
    bench.hangs = false;
    bench.flows(2);
    assert_eq!(bench.controller.state(), State::Armed);
}

/// Between two pulses that are due there is a step without current, for plans to be read; and a
/// phase that is a bit longer than the longest step leaves no piece that is shorter than the
/// shortest.
#[test]
fn steps_of_two_pulses_that_are_due_at_once() {
    for width_us in [100, 125, 126, 135, 144, 145, 146, 250, 251, 270, 271, 1000] {
        let one = Stimulus { width_us, frequency_tenths_pps: 100, ..stimulus(5_000) };
        let limits = Limits { rise_ua: 50_000, ..BOARD };
        let plan = Plan::<4>::new(&[Some(one), Some(one), None, None], &SCALE, &limits);
        let mut schedule = Schedule::<4>::new();
        schedule.follow(&Guarded::new(plan.expect("a plan")));
        let steps: Vec<Step> = std::iter::repeat_with(|| schedule.advance()).take(60).collect();
        let pieces = |channel: usize, counts: bool| -> Vec<u32> {
            let of = |step: &&Step| {
                step.output.is_some_and(|(at, phase)| at == channel && (phase.counts > 0) == counts)
            };
            steps.iter().filter(of).map(|step| step.duration_us).collect()
        };
        let width = u32::from(width_us);
        for channel in [0, 1] {
            // Both phases: each in one piece, or in several, of which the last is as long as the
            // shortest phase.
            let phase = match width {
                ..=125 => vec![width],
                126..=145 => vec![width - 20, 20],
                146..=250 => vec![125, width - 125],
                251..=270 => vec![125, width - 145, 20],
                271 => vec![125, 125, 21],
                _ => vec![125; 8],
            };
            assert_eq!(pieces(channel, true), [phase.clone(), phase].concat(), "{width_us}");
            assert_eq!(pieces(channel, false), [20, 30, 20, 20], "{width_us}");
        }
        let last = steps.iter().rposition(|step| step.output.is_some_and(|(at, _)| at == 0));
        let next = steps.iter().position(|step| step.output.is_some_and(|(at, _)| at == 1));
        let (last, next) = (last.expect("a pulse"), next.expect("another"));
        let between: Vec<Step> = steps[last + 1..next].to_vec();
        assert_eq!(between, [Step { output: None, duration_us: 20 }]);
    }
}
