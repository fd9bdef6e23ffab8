//! Limits are exact over their whole type, which no test could wait for: time is set just before
//! and just after.

use super::{CHANNELS, Fault, NotArmed, Observed, Requested, State, Supervisor, micros};
use crate::between::limits::Limits;
use crate::between::stimulus::{Scale, Stimulus};
use proptest::prelude::*;

const SCALE: Scale = Scale { full_scale_ua: 100_000, full_scale_counts: 4095 };

const STIMULUS: Stimulus = Stimulus {
    amplitude_ua: 1_000,
    width_us: 200,
    gap_us: 50,
    frequency_tenths_pps: 400,
    recovery: 1,
};

const REQUESTED: Requested =
    Requested { stimuli: [Some(STIMULUS), None, None, None], ..Requested::NOTHING };

fn observed(path_um: i32) -> Observed {
    Observed {
        host_heard: true,
        impedance_ohm: [None; CHANNELS],
        supply_mv: 3700,
        path_um: Some(path_um),
        path_is_new: true,
        angle: None,
        in_time: true,
        memory_is_intact: true,
        output_answers: true,
    }
}

fn armed(limits: Limits, tick_us: u32) -> Supervisor {
    let mut supervisor =
        Supervisor::new(limits, tick_us, &SCALE, Fault::Boot).expect("valid limits");
    supervisor.tick(&observed(160_000), &Requested::NOTHING);
    supervisor.acknowledge(Fault::Boot).expect("its name");
    supervisor.arm().expect("nothing is wrong");
    supervisor
}

/// Every limit in ms, and more often those where µs of 32 bits would end.
fn limit_ms() -> impl Strategy<Value = u32> {
    prop_oneof![2..=u32::MAX, 4_294_966..4_294_970_u32, 4_319_999..4_320_002_u32, Just(u32::MAX)]
}

proptest! {
    #[test]
    fn a_session_ends_when_it_is_over_and_not_before(session_ms in limit_ms(), tick_us in 500..=2000_u32) {
        let stuck_ms = 2;
        let mut supervisor = armed(Limits { session_ms, stuck_ms, ..Limits::SURFACE }, tick_us);
        let most_us = micros(session_ms);
        supervisor.session_us = most_us - 1;
        prop_assert!(supervisor.tick(&observed(160_001), &REQUESTED));
        // That tick was the session's last.
        prop_assert!(!supervisor.tick(&observed(160_000), &REQUESTED));
        prop_assert_eq!(supervisor.state(), State::Latched(Fault::Session));
        // And only a rest begins another one.
        supervisor.acknowledge(Fault::Session).expect("its name");
        supervisor.tick(&observed(160_001), &Requested::NOTHING);
        prop_assert_eq!(supervisor.arm(), Err(NotArmed::StillThere(Fault::Session)));
    }

    #[test]
    fn a_rest_is_as_long_as_its_limit(rest_ms in limit_ms(), tick_us in 500..=2000_u32) {
        let mut supervisor = armed(Limits { rest_ms, ..Limits::SURFACE }, tick_us);
        supervisor.session_us = 1;
        supervisor.rest_us = micros(rest_ms).saturating_sub(2 * u64::from(tick_us));
        if supervisor.rest_us > 0 {
            supervisor.tick(&observed(160_001), &Requested::NOTHING);
            prop_assert_eq!(supervisor.session_us, 1);
        }
        supervisor.rest_us = micros(rest_ms) - 1;
        supervisor.tick(&observed(160_000), &Requested::NOTHING);
        prop_assert_eq!(supervisor.session_us, 0);
    }

    #[test]
    fn a_host_is_silent_when_it_is_over_its_limit_and_not_before(
        silence_ms in limit_ms(),
        tick_us in 500..=2000_u32,
    ) {
        let mut supervisor = armed(Limits { silence_ms, ..Limits::SURFACE }, tick_us);
        let silent = Observed { host_heard: false, ..observed(160_001) };
        supervisor.silence_us = micros(silence_ms) - u64::from(tick_us);
        prop_assert!(supervisor.tick(&silent, &Requested::NOTHING));
        prop_assert!(!supervisor.tick(&silent, &Requested::NOTHING));
        prop_assert_eq!(supervisor.state(), State::Latched(Fault::Silence));
    }

    #[test]
    fn a_sensor_is_stuck_when_it_is_over_its_limit_and_not_before(
        stuck_ms in limit_ms(),
        tick_us in 500..=2000_u32,
    ) {
        let limits = Limits { stuck_ms, session_ms: u32::MAX, ..Limits::SURFACE };
        let mut supervisor = armed(limits, tick_us);
        supervisor.stuck_us = micros(stuck_ms) - u64::from(tick_us);
        prop_assert!(supervisor.tick(&observed(160_000), &REQUESTED));
        prop_assert!(!supervisor.tick(&observed(160_000), &REQUESTED));
        prop_assert_eq!(supervisor.state(), State::Latched(Fault::SensorStuck));
    }

    #[test]
    fn requests_are_too_old_when_they_are_over_their_limits_and_not_before(
        rows_ms in limit_ms(),
        drives_ms in limit_ms(),
        targets_ms in limit_ms(),
    ) {
        let limits = Limits { rows_ms, drives_ms, targets_ms, ..Limits::SURFACE };
        let mut supervisor = armed(limits, 1000);
        let oldest = Requested {
            row_age_us: micros(rows_ms),
            drive_age_us: micros(drives_ms),
            target_age_us: micros(targets_ms),
            ..REQUESTED
        };
        prop_assert!(supervisor.tick(&observed(160_001), &oldest));
        let [mut row, mut drive, mut target] = [oldest; 3];
        row.row_age_us += 1;
        drive.drive_age_us += 1;
        target.target_age_us += 1;
        for (requested, fault) in
            [(row, Fault::StaleRow), (drive, Fault::StaleDrive), (target, Fault::StaleTarget)]
        {
            let mut supervisor = supervisor.clone();
            prop_assert!(!supervisor.tick(&observed(160_000), &requested));
            prop_assert_eq!(supervisor.state(), State::Latched(fault));
        }
    }
}

#[test]
fn a_bit_that_memory_has_lost_of_a_limit_is_a_fault() {
    let mut supervisor = armed(Limits::SURFACE, 1000);
    supervisor.limits.corrupt(|limits| limits.amplitude_ua ^= 1 << 20);
    assert!(supervisor.limits().is_none());
    assert!(!supervisor.tick(&observed(160_001), &REQUESTED));
    assert_eq!(supervisor.state(), State::Latched(Fault::Checksum));
    supervisor.acknowledge(Fault::Checksum).expect("its name");
    supervisor.tick(&observed(160_000), &Requested::NOTHING);
    assert_eq!(supervisor.arm(), Err(NotArmed::StillThere(Fault::Checksum)));
}

/// A path that is another one was read, whatever is said of it.
#[test]
fn a_path_that_has_changed_is_new() {
    let mut supervisor = armed(Limits::SURFACE, 1000);
    let unsaid = |path_um| Observed { path_is_new: false, ..observed(path_um) };
    for tick in 1..=20 {
        assert!(supervisor.tick(&unsaid(160_000 + 1_000 * tick), &Requested::NOTHING));
    }
    assert!(!supervisor.tick(&unsaid(180_000 + 1_001), &Requested::NOTHING));
    assert_eq!(supervisor.state(), State::Latched(Fault::SensorJump));
    // One that is not new is as old as the last that was.
    let mut supervisor = armed(Limits::SURFACE, 1000);
    for _ in 0..20 {
        assert!(supervisor.tick(&unsaid(160_000), &Requested::NOTHING));
    }
    assert!(supervisor.tick(&observed(160_000 + 21_000), &Requested::NOTHING));
    assert!(!supervisor.tick(&observed(160_000 + 22_001), &Requested::NOTHING));
}

/// A sensor that moves in a pause of stimulation is not stuck.
#[test]
fn a_movement_in_a_pause_is_a_movement() {
    let limits = Limits { stuck_ms: 1_000, ..Limits::SURFACE };
    let mut supervisor = armed(limits, 1000);
    for _ in 0..3 {
        for _ in 0..900 {
            assert!(supervisor.tick(&observed(160_000), &REQUESTED));
        }
        // The train is over after 25 ms, and then it moves.
        for tick in 0..40 {
            let path_um = 160_000 + i32::from(tick == 35);
            assert!(supervisor.tick(&observed(path_um), &Requested::NOTHING));
        }
    }
}
