//! Angles that come later than they may, or contradict each other: whatever they say, they end in
//! neutral.

use firmware::Limits;
use firmware::link::{AngleReading, Readings, Request};
use firmware::safety::{Fault, State};
use stimulator_tests::device::LIMITS;
use stimulator_tests::host::{READINGS, arm};
use stimulator_tests::joint::{Elbow, hold};

/// A tick more than an angle may be old.
const TOO_OLD: u32 = LIMITS.angle_ms + 1;

/// While pulses flow, angles come every so many ticks, with these stamps (µs) and angles (µrad);
/// everything else is supplied. What comes of it.
fn every(limits: Limits, ticks: u32, angle: fn(u32) -> (u32, i32)) -> State {
    let mut elbow = Elbow::armed(limits, 1.6);
    elbow.pass(50);
    assert!(elbow.host.line().flowed() > 0);
    // The first goes on with those before.
    (0..9).for_each(|_| elbow.host.line().tick());
    let mut reading = elbow.reading();
    for index in 0..40 {
        let begun = elbow.host.line().ticks();
        elbow.host.order(&Request::Angle(reading)).expect("room");
        elbow.host.order(&Request::Target(hold(1.6))).expect("a target");
        let path_um = Some(160_000 + (index % 2) as i32);
        elbow.host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("told");
        while elbow.host.line().ticks() < begun + ticks {
            elbow.host.line().tick();
        }
        assert_eq!(elbow.host.line().ticks(), begun + ticks);
        let (time_us, angle_urad) = angle(index);
        reading = AngleReading { time_us, angle_urad };
    }
    elbow.state()
}

/// An angle that comes in the very tick in which the one before is too old is as late as one that
/// comes after it: no way round the limits of jumps, time stamps and angles that are stuck.
#[test]
fn an_angle_that_comes_a_tick_too_late_is_no_way_round_the_others_limits() {
    let missing = State::Latched(Fault::SensorMissing);
    let jumps = |index: u32| (index * TOO_OLD * 1000, 200_000 + (index % 2) as i32 * 2_000_000);
    let stamps = |index: u32| (u32::MAX - index * 77, 1_000_000 + index as i32);
    let stuck = |index: u32| (index * TOO_OLD * 1000, 1_000_000);
    for angle in [jumps as fn(u32) -> (u32, i32), stamps, stuck] {
        let limits = Limits { stuck_ms: 500, ..LIMITS };
        assert_eq!(every(limits, TOO_OLD, angle), missing);
    }
}

/// Once it is missing, the next angle begins a series, and can be armed with.
#[test]
fn after_angles_that_were_missing_a_series_begins() {
    let mut elbow = Elbow::armed(LIMITS, 1.6);
    elbow.pass(20);
    elbow.reads = false;
    elbow.pass(4);
    (elbow.reads, elbow.angle_urad) = (true, 2_000_000);
    elbow.read();
    arm(&mut elbow.host, Fault::SensorMissing);
    elbow.pass(10);
    assert_eq!(elbow.state(), State::Armed);
}
