//! The angle between readings, and the target between targets.

use super::{ClosedLoop, Run};
use crate::between::guarded::Guarded;
use crate::between::motion::{AngleReading, Target};
use crate::config::TICK_US;
use crate::hard_tick::placed_controller::tests::elbow;

impl ClosedLoop {
    /// What memory may lose of target and course.
    pub(crate) fn corrupt_target(&mut self) {
        self.target.as_mut().expect("a target").corrupt(|target| target.torque = 1.0);
    }

    /// See above.
    pub(crate) fn corrupt_course(&mut self) {
        self.course.as_mut().expect("a course").corrupt(|course| course.speed = 1.0);
    }
}

const PERIOD_US: u32 = 10 * TICK_US;
const MOST_MRAD_S: u32 = 20_000;

fn reading(time_us: u32, angle_urad: i32) -> AngleReading {
    AngleReading { time_us, angle_urad }
}

#[test]
fn the_angle_goes_on_for_two_periods_and_then_stays() {
    let mut closed_loop = ClosedLoop::new();
    assert_eq!(closed_loop.angle(), None);
    // A clock that wraps around between the two.
    closed_loop.take(reading(u32::MAX - 3, 1_000_000), PERIOD_US, MOST_MRAD_S);
    assert_eq!(closed_loop.angle(), Some(1.0), "one reading has no speed");
    closed_loop.age();
    assert_eq!(closed_loop.angle(), Some(1.0));
    closed_loop.take(reading(PERIOD_US - 4, 1_010_000), PERIOD_US, MOST_MRAD_S);
    for tick in 0..60 {
        let expected = 1.01 + 0.01 * f64::from(tick.min(20)) / 10.0;
        let angle = f64::from(closed_loop.angle().expect("an angle"));
        assert!((angle - expected).abs() < 1e-6, "{tick}: {angle} for {expected}");
        closed_loop.age();
    }
}

/// Readings of before arming may jump: an angle goes on as fast as a joint can, and no faster.
#[test]
fn a_jump_is_not_followed_faster_than_the_joint_moves() {
    for (from_urad, to_urad, sign) in [(0, 1_000_000, 1.0), (i32::MAX, 1_000_000, -1.0)] {
        let mut closed_loop = ClosedLoop::new();
        closed_loop.take(reading(0, from_urad), PERIOD_US, MOST_MRAD_S);
        closed_loop.take(reading(PERIOD_US, to_urad), PERIOD_US, MOST_MRAD_S);
        (0..PERIOD_US / TICK_US).for_each(|_| closed_loop.age());
        let expected = 1.0 + sign * 20.0 * PERIOD_US as f32 * 1e-6;
        let angle = closed_loop.angle().expect("an angle");
        assert!((angle - expected).abs() < 1e-6, "{angle} for {expected}");
    }
}

/// Stamps that are equal, too close, go back, or are far apart, tell no speed.
#[test]
fn stamps_that_tell_no_speed_are_not_followed() {
    for time_us in [5_000, 4_999, 5_001, 5_000 + PERIOD_US / 2 - 1, 5_000 + 4 * PERIOD_US + 1] {
        let mut closed_loop = ClosedLoop::new();
        closed_loop.take(reading(5_000, 1_000_000), PERIOD_US, MOST_MRAD_S);
        closed_loop.take(reading(time_us, 1_010_000), PERIOD_US, MOST_MRAD_S);
        closed_loop.age();
        assert_eq!(closed_loop.angle(), Some(1.01), "{time_us}");
    }
    // The closest and the farthest that do.
    for us in [PERIOD_US / 2, 4 * PERIOD_US] {
        let mut closed_loop = ClosedLoop::new();
        closed_loop.take(reading(5_000, 1_000_000), PERIOD_US, MOST_MRAD_S);
        closed_loop.take(reading(5_000 + us, 1_010_000), PERIOD_US, MOST_MRAD_S);
        closed_loop.age();
        assert!(closed_loop.angle() > Some(1.01), "{us}");
    }
}

/// So does a reading that came long after the one before, whatever its stamp.
#[test]
fn a_reading_after_a_pause_has_no_speed() {
    for (ticks, is_followed) in
        [(4 * PERIOD_US / TICK_US, true), (4 * PERIOD_US / TICK_US + 1, false)]
    {
        let mut closed_loop = ClosedLoop::new();
        closed_loop.take(reading(5_000, 1_000_000), PERIOD_US, MOST_MRAD_S);
        (0..ticks).for_each(|_| closed_loop.age());
        closed_loop.take(reading(5_000 + PERIOD_US, 1_001_000), PERIOD_US, MOST_MRAD_S);
        closed_loop.age();
        assert_eq!(closed_loop.angle() != Some(1.001), is_followed, "{ticks}");
    }
}

/// Of a sinusoid of 1 Hz at 100 readings per second, prediction leaves a tenth of what holding
/// does.
#[test]
fn a_prediction_is_nearer_than_the_last_reading() {
    let angle = |us: u32| 1.2 + 0.5 * (core::f64::consts::TAU * f64::from(us) * 1e-6).sin();
    let mut closed_loop = ClosedLoop::new();
    let (mut held, mut predicted) = (0.0_f64, 0.0_f64);
    let mut last = angle(0);
    for us in (0..2_000_000).step_by(TICK_US as usize) {
        if us % PERIOD_US == 0 {
            last = angle(us);
            closed_loop.take(reading(us, (last * 1e6) as i32), PERIOD_US, MOST_MRAD_S);
        }
        if us >= 2 * PERIOD_US {
            let error = f64::from(closed_loop.angle().expect("an angle")) - angle(us);
            (held, predicted) = (held.max((last - angle(us)).abs()), predicted.max(error.abs()));
        }
        closed_loop.age();
    }
    assert!(predicted < 0.1 * held, "{predicted} and {held} rad");
}

#[test]
fn targets_go_on_at_their_velocity_and_expire() {
    let mut closed_loop = ClosedLoop::new();
    let aimed = Guarded::new(Target { angle: 1.0, velocity: 2.0, ..Target::default() });
    closed_loop.aim(aimed);
    closed_loop.age();
    assert_eq!(closed_loop.target_age_us(), 0, "nothing follows it yet");
    closed_loop.aim(aimed);
    closed_loop.take(reading(0, 1_000_000), PERIOD_US, MOST_MRAD_S);
    let mut placed = elbow();
    closed_loop.follow(&mut placed).expect("both");
    assert_eq!(closed_loop.run, Run::Ticks);
    (0..10).for_each(|_| closed_loop.age());
    let us = u64::from(10 * TICK_US);
    assert_eq!(closed_loop.target_age_us(), us);
    let target = Target { angle: 1.0, velocity: 2.0, acceleration: 3.0, torque: 4.0 };
    let after = Target { angle: 1.0 + 2.0 * (us as f32 * 1e-6), ..target };
    assert_eq!(target.after(us), after);
    closed_loop.expire(us);
    assert!(closed_loop.follow(&mut placed).is_some());
    closed_loop.age();
    closed_loop.expire(us);
    assert!(closed_loop.follow(&mut placed).is_none());
    assert_eq!(closed_loop.target_age_us(), 0, "none is followed any more");
}

#[test]
fn a_bit_that_is_lost_of_target_or_reading_is_seen() {
    let mut closed_loop = ClosedLoop::new();
    assert!(closed_loop.is_intact());
    closed_loop.aim(Guarded::new(Target::default()));
    closed_loop.take(reading(0, 1_000_000), PERIOD_US, MOST_MRAD_S);
    assert!(closed_loop.is_intact());
    let mut placed = elbow();
    let mut lost = closed_loop.clone();
    lost.corrupt_target();
    assert!(!lost.is_intact() && lost.follow(&mut placed).is_none());
    closed_loop.corrupt_course();
    assert!(!closed_loop.is_intact() && closed_loop.follow(&mut placed).is_none());
}
