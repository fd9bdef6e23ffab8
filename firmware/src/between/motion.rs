//! Motion of a controlled joint: what is wanted of it, and what its sensor says.

use crate::between::guarded::Sum;
use serde::{Deserialize, Serialize};
use vm_nostd::Checksum;

/// What the joint's controller is to do from now on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Angle, rad; in the joint's range.
    pub angle: f32,
    /// Its velocity, rad/s; -100 to 100. The angle goes on at it until the next target.
    pub velocity: f32,
    /// Its acceleration, rad/s²; -100 to 100.
    pub acceleration: f32,
    /// Torque in addition to that of the motion, N m; in the controller's range.
    pub torque: f32,
}

impl Target {
    /// The target, so many µs later.
    pub(crate) fn after(self, us: u64) -> Self {
        // µs of less than a minute are exact.
        Self { angle: self.angle + self.velocity * (us as f32 * 1e-6), ..self }
    }
}

impl Sum for Target {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { angle, velocity, acceleration, torque } = *self;
        let words = [angle, velocity, acceleration, torque].map(f32::to_bits);
        words.into_iter().for_each(|word| checksum.add(word));
    }
}

/// A reading of the joint's angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AngleReading {
    /// When it was measured by the sensor's clock, µs; wraps around.
    pub time_us: u32,
    /// The angle, µrad.
    pub angle_urad: i32,
}

impl AngleReading {
    /// The angle, rad.
    pub fn angle(&self) -> f32 {
        self.angle_urad as f32 * 1e-6
    }
}

impl Sum for AngleReading {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { time_us, angle_urad } = *self;
        checksum.add(time_us);
        checksum.add(angle_urad.cast_unsigned());
    }
}
