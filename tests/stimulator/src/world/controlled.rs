//! A world whose device controls a joint: targets stimulate, and angles may be wrong.

use super::{BOUNDS, ELECTRODE, OF_ROWS, World};
use crate::joint;
use firmware::Stimulus;
use firmware::link::{AngleReading, ControlUpload, Electrode, Modulation, Request, Upload};

/// Channels of a controller's muscles, and the most that it may ask of either.
const OF_TARGETS: [usize; 2] = [2, OF_ROWS];
pub(super) const AT_MOST: Stimulus = Stimulus {
    amplitude_ua: 20_000,
    width_us: ELECTRODE.width_us,
    gap_us: ELECTRODE.gap_us,
    frequency_tenths_pps: 400,
    recovery: ELECTRODE.recovery,
};

impl World {
    /// Greeted, with an elbow's controller, whose targets stimulate.
    pub fn controlled() -> Self {
        let mut world = Self::greeted(&OF_TARGETS);
        for (place, upload) in (0..).zip(joint::muscles()) {
            let channel = OF_TARGETS[usize::from(place)] as u8;
            let upload = Upload { electrode: Some(Electrode { channel, ..ELECTRODE }), ..upload };
            world.ask(Request::Upload { place, upload });
        }
        let modulation = [Modulation::Amplitude { most_ua: AT_MOST.amplitude_ua }; 2];
        world.ask(Request::Control(Some(ControlUpload { modulation, ..joint::control() })));
        world.is_controlled = true;
        world
    }

    /// What the tick makes of the newest angle: one that is definitely wrong ends everything.
    pub(super) fn take_angle(&mut self) {
        let Some(reading) = self.angle.take() else { return };
        let now_us = self.now_us;
        let AngleReading { time_us, angle_urad } = reading;
        self.patient.reads_angle(now_us);
        // 10 degrees beyond 0 to 140 degrees.
        if !(-175_000..=2_618_461).contains(&angle_urad) {
            self.patient.ends("an angle beyond the joint");
        }
        if let Some((before, read_us)) = self.read.replace((reading, now_us))
            && now_us - read_us <= BOUNDS.angle_us
        {
            let stamped_us = u64::from(time_us.wrapping_sub(before.time_us));
            // 20 rad/s.
            let most_urad = (20 * stamped_us).max(50_000);
            if stamped_us < 5_000 || stamped_us > now_us - read_us + 2 * BOUNDS.angle_us {
                self.patient.ends("time stamps");
            } else if u64::from(angle_urad.abs_diff(before.angle_urad)) > most_urad {
                self.patient.ends("a jump of the angle");
            }
        }
    }
}
