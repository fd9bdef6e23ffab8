//! Every order in which pulse timer, tick and link interrupt each other around a fault, and around
//! the queues between tick and link: the firmware's own code, with a choice before each access to
//! what they share.
//!
//! Interrupts of the pulse timer come where they are chosen to, two more in the tick of a fault
//! than `VM_INTERRUPTS` says, or as many as it says anywhere from the fault until pulses flow
//! again: 1 where it is not set. A run leaves 7 KB behind, for what levels hand each other are
//! statics: with 2 there have to be 8 GB.

use firmware::link::{AngleReading, Answer, ControlUpload, Readings, Request, RowInputs};
use firmware::safety::{CHANNELS, Fault, State};
use firmware::{Limits, Stimulus};
use std::rc::Rc;
use stimulator_tests::device::LIMITS as BOARD;
use stimulator_tests::explorer::{choose, explore};
use stimulator_tests::host::{READINGS, STIMULUS};
use stimulator_tests::joint;
use stimulator_tests::levels::{Levels, TICK};

/// Amplitudes of before and after a fault come at once.
const LIMITS: Limits = Limits { rise_ua: 50_000, ..BOARD };
/// Counts of 10 mA and of 20 mA.
const BEFORE: u16 = 819;
const AFTER: u16 = 1638;
/// Where in a pulse, or before it, the tick of a fault may begin; a pulse and a bit; and from one
/// pulse to the next, µs.
const ALL_PLACES: u8 = 16;
const PULSE_US: u32 = 560;
const PERIOD_US: u32 = 10_070;

fn interrupts() -> u32 {
    std::env::var("VM_INTERRUPTS").ok().and_then(|text| text.parse().ok()).unwrap_or(1)
}

/// Places that are tried: all of them, if `VM_PLACES` does not say fewer.
fn places() -> u8 {
    let fewer = std::env::var("VM_PLACES").ok().and_then(|text| text.parse().ok());
    fewer.unwrap_or(ALL_PLACES).clamp(1, ALL_PLACES)
}

/// So many interleavings, or the share of them that the places are.
fn share(all: u64) -> u64 {
    all * u64::from(places()) / u64::from(ALL_PLACES)
}

fn drive(amplitude_ua: u32) -> Request {
    let frequency_tenths_pps = (10_000_000 / PERIOD_US) as u16;

    let stimulus = Stimulus { amplitude_ua, frequency_tenths_pps, ..STIMULUS };
    Request::Drive([Some(stimulus), None, None, None])
}

fn arm(levels: &Levels, fault: Fault) {
    for request in [Request::Readings(READINGS), Request::Acknowledge(fault), Request::Arm] {
        levels.ask(&request);
    }
}

/// Armed, with pulses of 10 mA on one channel. The next tick is due while a pulse flows, or one
/// begins in its time: which of it, is its place.
fn running(attends: bool, place: u8) -> Rc<Levels> {
    let levels = Levels::boot(LIMITS, attends);
    arm(&levels, Fault::Boot);
    levels.ask(&drive(10_000));
    let keeps_heard = || {
        levels.ask(&drive(10_000));
    };
    let until_pulse = || {
        levels.flowed();
        while levels.flowed().is_empty() {
            levels.step();
        }
        levels.timer_us()
    };
    // From pulse to pulse, a tick begins a bit earlier in it.
    for _ in 0..place {
        until_pulse();
        keeps_heard();
    }
    let next_us = until_pulse() + PERIOD_US;
    while levels.next_tick_us() + TICK <= next_us + PULSE_US {
        levels.pass(1);
    }
    levels
}

/// What makes a tick end everything.
#[derive(Clone, Copy, Debug)]
enum Source {
    Supply,
    Stop,
    LateTick,
    LatePulse,
    Output,
}

/// A fault from a source, at any step of the pulse timer, and everything until pulses of another
/// amplitude flow.
///
/// So many interrupts of the pulse timer come where they are chosen to in the tick of the fault, or
/// else anywhere.
fn fault_and_again(
    source: Source,
    (in_tick, anywhere): (u32, u32),
    attends: bool,
) -> Result<(), String> {
    // A planted bug is found at some of them.
    let levels = running(attends, choose(if attends { places() } else { ALL_PLACES }));
    if let Some(problem) = levels.problem() {
        return Err(problem);
    }
    match source {
        Source::Supply => levels.send(&Request::Readings(Readings { supply_mv: 1, ..READINGS })),
        Source::Stop => levels.send(&Request::Stop),
        _ => (),
    }
    levels.explore(in_tick + anywhere, 0);
    let fault = match source {
        Source::Supply => Fault::Supply,
        Source::Stop => Fault::Stopped,
        Source::LateTick => {
            levels.next_is_late();
            Fault::Deadline
        }
        Source::LatePulse => {
            levels.overrun();
            Fault::Deadline
        }
        Source::Output => {
            levels.electrodes.borrow_mut().broken_converter = true;
            Fault::Output
        }
    };
    levels.tick();
    if anywhere == 0 {
        levels.explore(0, 0);
    }
    levels.pass(1);
    if matches!(source, Source::Output) {
        // The pulse timer may not have spoken to it before the next pulse.
        levels.pass(10);
        levels.electrodes.borrow_mut().broken_converter = false;
    }
    levels.poll();
    levels.answers.borrow_mut().clear();
    levels.flowed();
    levels.pass(1);
    let Answer::Report(report) = levels.ask(&Request::Report) else {
        return Err("no report".to_owned());
    };
    // Between pulses, one that is late is none.
    let latched = report.state == State::Latched(fault);
    if !latched && !matches!(source, Source::LatePulse) {
        return Err(format!("{:?}, not {fault:?}", report.state));
    }
    if !latched {
        return levels.problem().map_or(Ok(()), Err);
    }
    if !levels.flowed().is_empty() {
        return Err("current after the fault".to_owned());
    }
    arm(&levels, fault);
    levels.pass(3);
    if !levels.flowed().is_empty() {
        return Err("pulses that nobody has asked for since".to_owned());
    }
    levels.ask(&drive(20_000));
    levels.explore(0, 0);
    // A period, and what it takes to begin.
    // A pulse that the stop has cut short is discharged first.
    levels.pass(35);
    let flowed = levels.flowed();
    if !flowed.contains(&AFTER) || flowed.contains(&BEFORE) {
        return Err(format!("{flowed:?} after it was armed again"));
    }
    levels.problem().map_or(Ok(()), Err)
}

const SOURCES: [Source; 5] =
    [Source::Supply, Source::Stop, Source::LateTick, Source::LatePulse, Source::Output];

#[test]
fn whatever_interrupts_whatever_a_fault_ends_all_current_and_all_plans() {
    let mut all = 0;
    for source in SOURCES {
        for which in [(interrupts() + 2, 0), (0, interrupts())] {
            let runs = explore(|| fault_and_again(source, which, true));
            let runs = runs.unwrap_or_else(|problem| panic!("{source:?}, {which:?}: {problem}"));
            println!("{source:?}, {which:?} in its tick or anywhere: {runs} interleavings");
            all += runs;
        }
    }
    println!("{all} interleavings of a fault");
    assert!(all > share(5_000));
}

/// A drive of before the second step of arming, the same as before the stop or another one: it
/// flows, whatever interrupts the tick that arms.
fn armed_with_a_drive(pulse_interrupts: u32) -> Result<(), String> {
    let levels = running(true, choose(places()));
    let no_supply = Request::Readings(Readings { supply_mv: 1, ..READINGS });
    let stops = [(Request::Stop, Fault::Stopped), (no_supply, Fault::Supply)];
    let (stop, fault) = &stops[usize::from(choose(2))];
    levels.ask(stop);
    levels.ask(&Request::Readings(READINGS));
    levels.ask(&Request::Acknowledge(*fault));
    let (amplitude_ua, counts) = [(10_000, BEFORE), (20_000, AFTER)][usize::from(choose(2))];
    levels.ask(&drive(amplitude_ua));
    levels.flowed();
    levels.send(&Request::Arm);
    levels.explore(pulse_interrupts, 0);
    levels.pass(2);
    levels.explore(0, 0);
    // A pulse that the stop has cut short is discharged first.
    levels.pass(35);
    let flowed = levels.flowed();
    if !flowed.contains(&counts) || flowed.iter().any(|other| *other != counts) {
        return Err(format!("{flowed:?}, not {counts}"));
    }
    levels.problem().map_or(Ok(()), Err)
}

#[test]
fn whatever_interrupts_the_tick_that_arms_what_was_asked_for_flows() {
    let runs = explore(|| armed_with_a_drive(interrupts() + 1)).expect("pulses");
    println!("{runs} interleavings of arming");
    assert!(runs > share(500));
}

/// The explorer finds what there is to find.
#[test]
fn a_tick_that_does_not_call_for_the_pulse_timer_is_found() {
    let found = explore(|| fault_and_again(Source::Stop, (0, 1), false));
    let problem = found.expect_err("current goes on");
    assert!(problem.contains("current that no tick allows"), "{problem}");
}

/// Requests, rows and traces, with ticks between any two accesses of the link, and a pulse timer
/// between any two of those.
fn orders_and_rows(pulse_interrupts: u32, tick_interrupts: u32) -> Result<(), String> {
    let levels = running(true, 0);
    let rows = |first| Request::Rows {
        first,
        rows: heapless::Vec::from_slice(&[[RowInputs::default(); 2]; 2]).expect("room"),
    };
    levels.explore(pulse_interrupts, tick_interrupts);
    let requests =
        [rows(0), Request::Drive([None; CHANNELS]), rows(2), drive(20_000), Request::Report];
    let mut sent = Vec::new();
    for request in &requests {
        for _ in 0..3 {
            levels.poll();
            if levels.is_ready() {
                break;
            }
            levels.pass(1);
        }
        if !levels.is_ready() {
            return Err(format!("not ready for {request:?}"));
        }
        levels.send(request);
        sent.push(request);
    }
    levels.explore(0, 0);
    for _ in 0..10 {
        levels.pass(1);
        levels.poll();
    }
    let answers = levels.answers.take();
    let first = answers.first().map_or(0, |first| first.0);
    let in_order = answers.iter().zip(first..).all(|((to, _), due)| *to == due);
    if answers.len() != requests.len() || !in_order {
        return Err(format!("answers {answers:?}"));
    }
    let traced: Vec<u32> = levels.traces.borrow().iter().map(|traced| traced.row).collect();
    if traced != [0, 1, 2, 3] {
        return Err(format!("rows {traced:?}"));
    }
    levels.flowed();
    // A pulse that the stop has cut short is discharged first.
    levels.pass(35);
    let flowed = levels.flowed();
    if !flowed.contains(&AFTER) || flowed.contains(&BEFORE) {
        return Err(format!("{flowed:?} of the last drive"));
    }
    levels.problem().map_or(Ok(()), Err)
}

#[test]
fn whatever_interrupts_whatever_no_order_outcome_row_or_trace_is_lost_or_doubled() {
    let ticks = interrupts() + 1;
    let one = explore(|| orders_and_rows(1, interrupts())).expect("nothing lost");
    let many = explore(|| orders_and_rows(0, ticks)).expect("nothing lost");
    println!(
        "{one} interleavings of queues with a tick less and a pulse, {many} with {ticks} ticks"
    );
    assert!(one + many > 50);
}

/// The sensor's period, the most that is noise of a joint that does not move, and its share of an
/// angle.
const ANGLES_US: u32 = 1000;
const NOISE_URAD: i32 = 50_000;
const STEP_URAD: i32 = NOISE_URAD / 10;
/// More than can wait.
const ANGLES: u32 = 10;

/// Angles of a controlled joint, with ticks between any two accesses of the link. The tick takes
/// the newest of those that wait: one that comes twice, or after a newer one, contradicts its time
/// stamp; and the one that comes after all is as far from the last as noise may be, so that it is a
/// jump from any before the last.
fn angles(ticks: u32, left_out: Option<u32>) -> Result<(), String> {
    let levels = Levels::boot(Limits { angle_speed_mrad_s: 1, ..LIMITS }, true);
    for (place, upload) in (0..).zip(joint::muscles()) {
        levels.ask(&Request::Upload { place, upload });
    }
    let control = ControlUpload { sensor_period_us: ANGLES_US, ..joint::control() };
    levels.ask(&Request::Control(Some(control)));
    let first_us = levels.next_tick_us();
    let angle = |index: u32, angle_urad| {
        Request::Angle(AngleReading { time_us: first_us + index * ANGLES_US, angle_urad })
    };
    levels.ask(&angle(0, 0));
    arm(&levels, Fault::Boot);
    levels.explore(0, ticks);
    for index in (1..ANGLES).filter(|index| Some(*index) != left_out) {
        // What was refused for want of room is sent again after a tick.
        for _ in 0..2 {
            levels.answers.take();
            levels.send(&angle(index, index as i32 * STEP_URAD));
            levels.poll();
            if !levels.refused_for_room.take() {
                break;
            }
            levels.pass(1);
        }
        match levels.answers.take()[..] {
            [(_, Answer::Done)] => (),
            ref others => return Err(format!("angle {index} is answered by {others:?}")),
        }
    }
    levels.explore(0, 0);
    levels.pass(1);
    levels.ask(&angle(ANGLES, (ANGLES - 1) as i32 * STEP_URAD + NOISE_URAD));
    levels.pass(1);
    let Answer::Report(report) = levels.ask(&Request::Report) else {
        return Err("no report".to_owned());
    };
    match (levels.problem(), report.state) {
        (Some(problem), _) => Err(problem),
        (None, State::Armed) => Ok(()),
        (None, other) => Err(format!("{other:?}")),
    }
}

#[test]
fn whatever_interrupts_whatever_the_newest_angle_arrives_once_and_in_order() {
    let runs = explore(|| angles(interrupts() + 1, None)).expect("the newest angle");
    println!("{runs} interleavings of the queue of angles");
    assert!(runs > if interrupts() == 0 { 40 } else { 500 });
    // The loss of the newest is found; those before it are not missed.
    let found = explore(|| angles(0, Some(ANGLES - 1))).expect_err("an angle is missing");
    assert!(found.contains("Latched(SensorJump)"), "{found}");
    assert_eq!(explore(|| angles(0, Some(ANGLES - 2))), Ok(1));
}
