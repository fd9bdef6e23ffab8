//! The speed of the path, from the times between its readings.

use firmware::Limits;
use firmware::link::{Readings, Request};
use firmware::safety::{Fault, Observed, State};
use stimulator_tests::bench::{Bench, LIMITS};
use stimulator_tests::client::Client;
use stimulator_tests::device::{InProcess, LIMITS as BOARD, Memory};
use stimulator_tests::host::{Host, READINGS, arm, report};

/// Armed, with ticks of 1 ms.
fn armed(limits: Limits) -> Host {
    let mut host = Client::new(InProcess::boot_with(Memory::new(), limits));
    host.greet().expect("a greeting");
    arm(&mut host, Fault::Boot);
    host
}

/// What comes of readings so many ticks apart, whose path grows by so many µm.
fn after(limits: Limits, ticks: u32, by_um: i32) -> State {
    let mut host = armed(limits);
    (0..ticks).for_each(|_| host.line().tick());
    let mut path_um = 160_000;
    for _ in 0..8 {
        path_um += by_um;
        let before = host.line().ticks();
        host.order(&Request::Readings(Readings { path_um: Some(path_um), ..READINGS }))
            .expect("readings");
        let took = host.line().ticks() - before;
        (took..ticks).for_each(|_| host.line().tick());
        assert_eq!(host.line().ticks() - before, ticks);
    }
    report(&mut host).state
}

/// 1 m/s are 29 mm from reading to reading where these are 29 ms apart.
#[test]
fn a_path_may_move_at_its_speed_from_reading_to_reading() {
    assert_eq!(BOARD.path_speed_mm_s, 1_000);
    for (ticks, by_um) in [(29, 2_000), (29, 29_000), (29, -2_000), (5, 5_000), (3, -3_000)] {
        assert_eq!(after(BOARD, ticks, by_um), State::Armed, "{by_um} um every {ticks} ms");
    }
    for (ticks, by_um) in [(29, 29_001), (29, -29_001), (5, 5_001), (3, -3_001)] {
        let state = after(Limits { path_um: (-400_000, 500_000), ..BOARD }, ticks, by_um);
        assert_eq!(state, State::Latched(Fault::SensorJump), "{by_um} um every {ticks} ms");
    }
}

/// What no sensor says for a while may be elsewhere when it says something again; a number that is
/// repeated is news.
#[test]
fn the_time_between_readings_begins_with_the_last_number() {
    let say = |host: &mut Host, path_um| {
        host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
    };
    let mut host = armed(BOARD);
    (0..20).for_each(|_| host.line().tick());
    // The same as before, 20 ms later.
    say(&mut host, Some(160_000));
    say(&mut host, Some(170_000));
    assert_eq!(report(&mut host).state, State::Latched(Fault::SensorJump));
    // A number, none for 50 ms, and one 45 mm from there.
    let mut host = armed(BOARD);
    say(&mut host, Some(160_001));
    say(&mut host, None);
    (0..50).for_each(|_| host.line().tick());
    host.order(&Request::Acknowledge(Fault::SensorMissing)).expect("its name");
    say(&mut host, Some(205_000));
    host.order(&Request::Arm).expect("nothing is wrong");
    assert_eq!(report(&mut host).state, State::Armed);
}

/// By readings of every tick, and ticks of every length: as far as the speed says, but a µm at
/// least.
#[test]
fn the_least_speed_is_no_speed_of_nothing() {
    for tick_us in [500, 1000, 2000] {
        let state = |speed: u32, by_um: i32, every: i32| {
            let limits = Limits { path_speed_mm_s: speed, ..LIMITS };
            let mut bench = Bench::with(limits, tick_us, Fault::Boot);
            let path = move |o: &mut Observed, tick: u32| {
                o.path_um = Some(160_000 + tick as i32 / every * by_um);
            };
            bench.inject(move |o, _, _| path(o, 0));
            bench.tick();
            bench.arm(Fault::Boot);
            bench.inject(move |o, _, tick| path(o, tick));
            bench.flows(40);
            bench.controller.state()
        };
        let jump = State::Latched(Fault::SensorJump);
        // A µm is the least that a reading can tell.
        let most_um = (tick_us as i32 / 1000).max(1);
        assert_eq!(state(1, most_um, 1), State::Armed, "1 mm/s at {tick_us} us");
        assert_eq!(state(1, -most_um, 1), State::Armed, "1 mm/s at {tick_us} us");
        assert_eq!(state(1, most_um + 1, 1), jump, "1 mm/s at {tick_us} us");
        // 3 mm/s: one and a half µm in half a ms.
        let most_um = 3 * tick_us as i32 / 1000;
        assert_eq!(state(3, most_um, 1), State::Armed, "3 mm/s at {tick_us} us");
        assert_eq!(state(3, most_um + 1, 1), jump, "3 mm/s at {tick_us} us");
        // Of readings that come each tick, none is old: a step is a jump however long nothing
        // moved.
        assert_eq!(state(3, most_um + 1, 20), jump, "3 mm/s at {tick_us} us");
        assert_eq!(state(u32::MAX, 1_000, 1), State::Armed);
    }
}
