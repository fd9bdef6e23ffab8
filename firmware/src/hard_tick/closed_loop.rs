//! The joint's controller between its sensor and its electrodes.
//!
//! Between readings the angle goes on at the speed of the last two, for two periods of the sensor
//! at most, and stays then; between targets the wanted angle goes on at its velocity. How old
//! either may be is in [`Limits`](crate::Limits): older ones are faults.

use crate::between::guarded::{Guarded, Sum};
use crate::between::motion::{AngleReading, Target};
use crate::config::TICK_US;
use crate::hard_tick::angle_watch::closest_us;
use crate::hard_tick::placed_controller::{PlacedController, Stepped};
use vm_nostd::Checksum;

/// The last reading, and how fast the angle changed since the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Course {
    reading: AngleReading,
    /// rad/s.
    speed: f32,
    /// For how long it is followed, µs.
    most_us: u32,
}

impl Sum for Course {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { reading, speed, most_us } = self;
        reading.sum(checksum);
        checksum.add(speed.to_bits());
        checksum.add(*most_us);
    }
}

/// Periods of the sensor for which an angle is predicted.
const PREDICTED: u32 = 2;
/// Readings further apart than so many periods tell no speed.
const TELLING: u32 = 4;

/// What the controller's state belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Run {
    /// Nothing: the next step begins anew.
    No,
    /// Steps of every tick, while armed.
    Ticks,
    /// Steps that the host asked for one by one, while disarmed.
    Lockstep,
}

/// Targets and readings in force.
#[derive(Clone, Debug)]
pub(crate) struct ClosedLoop {
    target: Option<Guarded<Target>>,
    target_age_us: u64,
    course: Option<Guarded<Course>>,
    course_age_us: u64,
    run: Run,
}

impl ClosedLoop {
    /// Without target and readings.
    pub(crate) const fn new() -> Self {
        Self { target: None, target_age_us: 0, course: None, course_age_us: 0, run: Run::No }
    }

    /// A tick passes.
    pub(crate) fn age(&mut self) {
        for age_us in [&mut self.target_age_us, &mut self.course_age_us] {
            *age_us = age_us.saturating_add(TICK_US.into());
        }
    }

    /// A new target.
    pub(crate) fn aim(&mut self, target: Guarded<Target>) {
        (self.target, self.target_age_us) = (Some(target), 0);
    }

    /// A new reading, of a sensor of this period (µs), of a joint that is this fast at most
    /// (mrad/s).
    pub(crate) fn take(&mut self, reading: AngleReading, period_us: u32, most_mrad_s: u32) {
        // What came longer ago may have the stamp of another clock.
        let is_recent = self.course_age_us <= u64::from(TELLING * period_us);
        let before = self.course.as_ref().filter(|_| is_recent).and_then(Guarded::get);
        let speed = before.map_or(0.0, |before| speed(&before.reading, &reading, period_us));
        // Before arming, jumps are no fault: their speed must not be followed afterwards.
        let most = most_mrad_s as f32 * 1e-3;
        let speed = speed.max(-most).min(most);
        let most_us = PREDICTED * period_us;
        self.course = Some(Guarded::new(Course { reading, speed, most_us }));
        self.course_age_us = 0;
    }

    /// Ends what was wanted; the next step begins anew.
    pub(crate) fn forget(&mut self) {
        (self.target, self.run) = (None, Run::No);
    }

    /// Ends a target that is older than this, µs.
    pub(crate) fn expire(&mut self, most_us: u64) {
        if self.target_age_us > most_us {
            self.target = None;
        }
    }

    /// Whether the checksums of target and course are valid.
    pub(crate) fn is_intact(&self) -> bool {
        self.target.as_ref().is_none_or(|target| target.get().is_some())
            && self.course.as_ref().is_none_or(|course| course.get().is_some())
    }

    /// Age of the target that is followed, µs; 0 without one.
    pub(crate) fn target_age_us(&self) -> u64 {
        if self.run == Run::Ticks && self.target.is_some() { self.target_age_us } else { 0 }
    }

    /// The tick's step, towards the target in force by the angle in force; none without both.
    pub(crate) fn follow(&mut self, placed: &mut PlacedController) -> Option<Stepped> {
        let target = self.target.as_ref()?.get()?.after(self.target_age_us);
        let angle = self.angle()?;
        if self.run != Run::Ticks {
            placed.start(angle);
            self.run = Run::Ticks;
        }
        placed.step(&target, angle)
    }

    /// The angle of now, rad; none without a reading.
    fn angle(&self) -> Option<f32> {
        let course = self.course.as_ref()?.get()?;
        let us = self.course_age_us.min(course.most_us.into());
        Some(course.reading.angle() + course.speed * (us as f32 * 1e-6))
    }

    /// A step of the host's own, without a prediction.
    pub(crate) fn step(
        &mut self,
        placed: &mut PlacedController,
        target: &Target,
        reading: &AngleReading,
    ) -> Option<Stepped> {
        if self.run != Run::Lockstep {
            placed.start(reading.angle());
            self.run = Run::Lockstep;
        }
        placed.step(target, reading.angle())
    }
}

/// Speed from one reading to the next, rad/s; 0 if their stamps do not tell it.
fn speed(before: &AngleReading, reading: &AngleReading, period_us: u32) -> f32 {
    let us = reading.time_us.wrapping_sub(before.time_us);
    if us < closest_us(period_us) || us > TELLING * period_us {
        return 0.0;
    }
    // µrad/µs; a difference of angles that are within reason is exact.
    reading.angle_urad.wrapping_sub(before.angle_urad) as f32 / us as f32
}

#[cfg(test)]
mod tests;
