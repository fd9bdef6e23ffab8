//! Readings at their limits, and past them.

use super::{AngleObserved, AngleWatch};
use crate::between::fault::Fault;
use crate::between::limits::Limits;
use crate::between::motion::AngleReading;

const LIMITS: Limits = Limits::SURFACE;

/// A joint of 0 to 2 rad, ticks of 1 ms, and readings every 10 ms as their stamps say.
#[derive(Default)]
struct Bench {
    watch: AngleWatch,
    us: u32,
}

impl Bench {
    fn tick(&mut self, reading: Option<AngleReading>, stimulates: bool) -> Option<Fault> {
        self.us += 1000;
        let observed = AngleObserved { reading, range_urad: (0, 2_000_000), period_us: 10_000 };
        self.watch.wrong(&LIMITS, 1000, Some(&observed), stimulates)
    }

    /// A reading after so many ticks; the first fault until then.
    fn after(&mut self, ticks: u32, stamped_us: u32, angle_urad: i32) -> Option<Fault> {
        let waited = (1..ticks).find_map(|_| self.tick(None, true));
        let time_us = self.watch.last.map_or(0, |last| last.time_us).wrapping_add(stamped_us);
        waited.or_else(|| self.tick(Some(AngleReading { time_us, angle_urad }), true))
    }

    /// With a reading of 1 rad.
    fn begun() -> Self {
        let mut bench = Self::default();
        assert_eq!(bench.tick(None, false), Some(Fault::SensorMissing));
        assert_eq!(bench.after(1, 4_000_000_000, 1_000_000), None);
        bench
    }
}

#[test]
fn without_a_controller_no_angle_is_missing() {
    let mut watch = AngleWatch::default();
    assert_eq!(watch.wrong(&LIMITS, 1000, None, true), None);
    // A controller that is loaded later has read nothing yet.
    let mut bench = Bench::begun();
    assert_eq!(bench.watch.wrong(&LIMITS, 1000, None, true), None);
    assert_eq!(bench.tick(None, false), Some(Fault::SensorMissing));
}

#[test]
fn a_reading_is_in_force_for_its_limit_and_no_longer() {
    let mut bench = Bench::begun();
    assert!((0..30).all(|_| bench.tick(None, true).is_none()));
    assert_eq!(bench.tick(None, true), Some(Fault::SensorMissing));
    // The next one begins a series: it may be anywhere.
    assert_eq!(bench.after(1, 7, 1_900_000), None);
}

#[test]
fn a_reading_of_the_tick_in_which_the_last_is_too_old_is_late_and_begins_a_series() {
    let mut bench = Bench::begun();
    assert_eq!(bench.after(30, 30_000, 1_100_000), None);
    assert_eq!(bench.after(31, 7, 1_900_000), Some(Fault::SensorMissing));
    assert_eq!(bench.after(10, 10_000, 1_900_000), None);
}

#[test]
fn angles_end_a_bit_beyond_the_joints_range() {
    for (angle_urad, wrong) in
        [(-175_000, false), (-175_001, true), (2_175_000, false), (2_175_001, true)]
    {
        let mut bench = Bench::default();
        let fault = bench.after(1, 0, angle_urad);
        assert_eq!(fault, wrong.then_some(Fault::SensorRange), "{angle_urad}");
    }
    assert_eq!(Bench::default().after(1, 0, i32::MAX), Some(Fault::SensorRange));
    assert_eq!(Bench::default().after(1, 0, i32::MIN), Some(Fault::SensorRange));
}

/// 20 rad/s by the stamps, or 50 mrad.
#[test]
fn a_joint_may_move_at_its_speed() {
    for (ticks, by, wrong) in [
        (10, 200_000, false),
        (10, 200_001, true),
        (10, -200_001, true),
        (5, 100_000, false),
        (5, 100_001, true),
    ] {
        let fault = Bench::begun().after(ticks, ticks * 1000, 1_000_000 + by);
        assert_eq!(fault, wrong.then_some(Fault::SensorJump), "{by} in {ticks} ms");
    }
    let jump = |by| {
        let mut watch = Bench::begun();
        let reading = AngleReading { time_us: 4_000_001_000, angle_urad: 1_000_000 + by };
        let observed =
            AngleObserved { reading: Some(reading), range_urad: (0, 2_000_000), period_us: 1_000 };
        watch.watch.wrong(&LIMITS, 1000, Some(&observed), true)
    };
    assert_eq!((jump(50_000), jump(50_001)), (None, Some(Fault::SensorJump)));
}

/// Not sooner than half a period after the last by the stamps, and nowhere near backwards.
#[test]
fn stamps_come_no_faster_than_stated() {
    let time = Some(Fault::SensorTime);
    let after = |stamped_us: u32| Bench::begun().after(10, stamped_us, 1_000_001);
    assert_eq!((after(5_000), after(4_999), after(0)), (None, time, time));
    assert_eq!(after(0_u32.wrapping_sub(10_000)), time);
    assert_eq!(after(u32::MAX / 2), time);
    // Clocks wrap around.
    let mut bench = Bench::begun();
    assert!((0..40_000).all(|n| bench.after(10, 10_000, 1_000_000 + n % 2).is_none()));
}

/// Later or earlier than they say by 30 ms in all; what clocks differ by one in a thousand does not
/// add up.
#[test]
fn readings_come_about_when_their_stamps_say() {
    let shifted = |by_us: i32, times: u32| {
        let mut bench = Bench::begun();
        (0..times).find_map(|n| {
            let stamped_us = 10_000_u32.wrapping_add_signed(by_us);
            bench.after(10, stamped_us, 1_000_000 + (n % 2) as i32)
        })
    };
    let time = Some(Fault::SensorTime);
    assert_eq!((shifted(30_010, 1), shifted(30_011, 1)), (None, time));
    assert_eq!((shifted(10, 20_000), shifted(-10, 20_000)), (None, None));
    // 1 µs in 10 ms beyond that is 30 ms in 5 minutes.
    assert_eq!((shifted(11, 29_000), shifted(11, 31_000)), (None, time));
    assert_eq!((shifted(-11, 29_000), shifted(-11, 31_000)), (None, time));
    // After it is seen, a series of its own begins.
    let mut bench = Bench::begun();
    assert_eq!(bench.after(10, 50_000, 1_000_001), time);
    assert_eq!(bench.after(10, 10_000, 1_000_000), None);
}

#[test]
fn an_angle_is_stuck_when_it_is_over_its_limit_and_not_before() {
    let mut bench = Bench::begun();
    for _ in 0..200 {
        assert_eq!(bench.after(10, 10_000, 1_000_000), None);
    }
    let fault = bench.tick(None, true);
    assert_eq!(fault, Some(Fault::SensorStuck));
    // Pauses of stimulation neither count nor reset it.
    let mut bench = Bench::begun();
    for _ in 0..199 {
        assert_eq!(bench.after(10, 10_000, 1_000_000), None);
    }
    assert!((0..10).all(|_| bench.tick(None, false).is_none()));
    assert_eq!(bench.after(10, 20_000, 1_000_000), None);
    assert_eq!(bench.tick(None, true), Some(Fault::SensorStuck));
    // Any other angle resets it.
    assert_eq!(bench.tick(None, true), Some(Fault::SensorStuck));
    let time_us = bench.watch.last.expect("one").time_us.wrapping_add(5_000);
    let reading = AngleReading { time_us, angle_urad: 1_000_001 };
    assert_eq!(bench.tick(Some(reading), true), None);
    assert_eq!(bench.watch.stuck_us, 0);
}
