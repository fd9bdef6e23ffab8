//! Musculotendon path and moment arms as functions of joint angles.

use super::skeleton::Joints;

/// Path length, quadratic in each angle: `length + Σ (a q + b q²)`, with q measured from the
/// reference angle. The moment arm about a joint is minus the derivative of the path with respect
/// to q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPolynomial {
    /// At the reference angles, m.
    pub length: f64,
    /// The reference angles, rad.
    pub reference: Joints,
    /// a, m/rad.
    pub linear: Joints,
    /// b, m/rad².
    pub quadratic: Joints,
}

impl PathPolynomial {
    /// Path length, m.
    pub fn length(&self, angles: Joints) -> f64 {
        let added = |joint: usize| {
            let angle = angles[joint] - self.reference[joint];
            angle * (self.linear[joint] + angle * self.quadratic[joint])
        };
        self.length + added(0) + added(1)
    }

    /// Moment arms, m: positive where the muscle flexes.
    pub fn moment_arms(&self, angles: Joints) -> Joints {
        [0, 1].map(|joint| {
            let angle = angles[joint] - self.reference[joint];
            -(self.linear[joint] + 2.0 * angle * self.quadratic[joint])
        })
    }

    /// The longest path (m) with angles between `least` and `greatest`.
    pub fn longest(&self, least: Joints, greatest: Joints) -> f64 {
        let mut longest = self.length;
        for joint in [0, 1] {
            let added = |angle: f64| angle * (self.linear[joint] + angle * self.quadratic[joint]);
            let (from, to) =
                (least[joint] - self.reference[joint], greatest[joint] - self.reference[joint]);
            // The extremum, where the moment arm is 0; there is none without b.
            let turning = -self.linear[joint] / (2.0 * self.quadratic[joint]);
            let inside = if turning > from && turning < to { turning } else { from };
            longest += added(from).max(added(to)).max(added(inside));
        }
        longest
    }
}
