//! Plausibility of the joint's angle and of its time stamps, in integers.

use crate::between::fault::Fault;
use crate::between::limits::Limits;
use crate::between::motion::AngleReading;

/// The sensor of a loaded controller in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AngleObserved {
    /// The reading that is new in this tick, if any.
    pub reading: Option<AngleReading>,
    /// Range of the joint, µrad.
    pub range_urad: (i32, i32),
    /// Stated period of the readings, µs.
    pub period_us: u32,
}

/// A change of this much is noise at any speed, µrad: about 3 degrees.
const NOISE_URAD: u64 = 50_000;
/// Clocks may differ by one in this many.
const CLOCKS_DIFFER: i64 = 1000;

/// Stamps that are closer than this contradict a period, µs.
pub(crate) const fn closest_us(period_us: u32) -> u32 {
    period_us / 2
}

/// Watches readings.
#[derive(Clone, Debug, Default)]
pub(crate) struct AngleWatch {
    last: Option<AngleReading>,
    /// Time since it came.
    age_us: u64,
    /// How much later than by their stamps readings have come since the first of a series.
    late_us: i64,
    /// Stimulation with a constant reading.
    stuck_us: u64,
}

impl AngleWatch {
    /// First fault in a tick; none without a controller.
    pub(crate) fn wrong(
        &mut self,
        limits: &Limits,
        tick_us: u32,
        observed: Option<&AngleObserved>,
        stimulates: bool,
    ) -> Option<Fault> {
        let Some(observed) = observed else {
            *self = Self::default();
            return None;
        };
        let most_age_us = u64::from(limits.angle_ms) * 1000;
        self.age_us = self.age_us.saturating_add(tick_us.into());
        // The next reading begins a series. One that comes in this very tick is late, too.
        let is_too_old = self.age_us > most_age_us && self.last.take().is_some();
        let before = self.last;
        let mut wrong = None;
        if let Some(reading) = observed.reading {
            match before {
                Some(before) => wrong = self.wrong_after(limits, observed, before, reading),
                None => self.late_us = 0,
            }
            self.last = Some(reading);
            self.age_us = 0;
        }
        let Some(AngleReading { angle_urad, .. }) = self.last else {
            return Some(Fault::SensorMissing);
        };
        let moved = before.is_none_or(|before| before.angle_urad != angle_urad);
        // Pauses of stimulation neither count nor reset it.
        if moved {
            self.stuck_us = 0;
        } else if stimulates {
            self.stuck_us = self.stuck_us.saturating_add(tick_us.into());
        }
        let (least, most) = observed.range_urad;
        // Limits of at most 6.3 rad: no overflow.
        let beyond = limits.angle_beyond_mrad.cast_signed().saturating_mul(1000);
        if !(least.saturating_sub(beyond)..=most.saturating_add(beyond)).contains(&angle_urad) {
            Some(Fault::SensorRange)
        } else if is_too_old {
            Some(Fault::SensorMissing)
        } else if wrong.is_some() {
            wrong
        } else if self.stuck_us > u64::from(limits.stuck_ms) * 1000 {
            Some(Fault::SensorStuck)
        } else {
            None
        }
    }

    /// A reading against the one before.
    fn wrong_after(
        &mut self,
        limits: &Limits,
        observed: &AngleObserved,
        before: AngleReading,
        reading: AngleReading,
    ) -> Option<Fault> {
        let stamped_us = reading.time_us.wrapping_sub(before.time_us);
        // At most the greatest age.
        let passed_us = i64::try_from(self.age_us).unwrap_or(i64::MAX);
        let late_us = self.late_us.saturating_add(passed_us).saturating_sub(stamped_us.into());
        // Clocks that differ add up to nothing.
        let forgotten_us = passed_us / CLOCKS_DIFFER;
        self.late_us = late_us - late_us.clamp(-forgotten_us, forgotten_us);
        let most_us = u64::from(limits.angle_ms) * 1000;
        // Backwards is far ahead.
        if stamped_us < closest_us(observed.period_us) || self.late_us.unsigned_abs() > most_us {
            // What follows is a series of its own.
            self.late_us = 0;
            return Some(Fault::SensorTime);
        }
        // mrad/s times µs is nrad.
        let most_urad =
            u64::from(limits.angle_speed_mrad_s).saturating_mul(stamped_us.into()) / 1000;
        let moved_urad = u64::from(reading.angle_urad.abs_diff(before.angle_urad));
        (moved_urad > most_urad.max(NOISE_URAD)).then_some(Fault::SensorJump)
    }
}

#[cfg(test)]
mod tests;
