//! Two segments in a horizontal plane, connected by joints in series.
//!
//! `M(q) q'' + C(q, q') = torque`, with the inertia of each segment about the joint above it:
//!
//! ```text
//! k = m2 l1 c2, with the upper arm's length l1
//! M = | J1 + J2 + m2 l1² + 2 k cos q2    J2 + k cos q2 |
//!     | J2 + k cos q2                    J2            |
//! C = k sin q2 | -(2 q1' + q2') q2' |
//!              |  q1'²              |
//! ```

/// Shoulder and elbow: angles in rad, velocities in rad/s, torques in N m; flexion is positive.
pub type Joints = [f64; 2];

/// A rigid segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// kg.
    pub mass: f64,
    /// Centre of mass, from the proximal joint, m.
    pub centre: f64,
    /// Inertia about the proximal joint, kg m².
    pub inertia: f64,
}

/// Upper arm and forearm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skeleton {
    /// From shoulder to elbow.
    pub upper_arm: Segment,
    /// From the elbow, with the hand.
    pub forearm: Segment,
    /// From shoulder to elbow, m.
    pub upper_arm_length: f64,
}

impl Skeleton {
    /// Coupling of the segments m2 l1 c2, kg m².
    fn coupling(&self) -> f64 {
        self.forearm.mass * self.upper_arm_length * self.forearm.centre
    }

    /// The symmetric inertia matrix M as (M11, M12, M22), kg m².
    fn inertia(&self, angles: Joints) -> (f64, f64, f64) {
        let coupled = self.coupling() * angles[1].cos();
        let elbow = self.forearm.inertia;
        let carried = self.forearm.mass * self.upper_arm_length.powi(2);
        (self.upper_arm.inertia + elbow + carried + 2.0 * coupled, elbow + coupled, elbow)
    }

    /// Angular accelerations, rad/s².
    pub fn acceleration(&self, angles: Joints, velocities: Joints, torques: Joints) -> Joints {
        let (m11, m12, m22) = self.inertia(angles);
        let [shoulder, elbow] = velocities;
        let bent = self.coupling() * angles[1].sin();
        let free = [
            torques[0] + bent * (2.0 * shoulder + elbow) * elbow,
            torques[1] - bent * shoulder * shoulder,
        ];
        let determinant = m11 * m22 - m12 * m12;
        [
            (m22 * free[0] - m12 * free[1]) / determinant,
            (m11 * free[1] - m12 * free[0]) / determinant,
        ]
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self, angles: Joints, velocities: Joints) -> f64 {
        let (m11, m12, m22) = self.inertia(angles);
        let [shoulder, elbow] = velocities;
        0.5 * (m11 * shoulder * shoulder + 2.0 * m12 * shoulder * elbow + m22 * elbow * elbow)
    }
}

#[cfg(test)]
mod tests {
    use super::super::data::Arm;

    /// Winter's fractions of mass and length, from which the data file's numbers come.
    #[test]
    fn segments_are_those_of_a_body_of_65_kg() {
        let skeleton = Arm::built_in().skeleton;
        for (segment, mass, length, centre, gyration) in [
            (skeleton.upper_arm, 0.028, 0.309, 0.436, 0.542),
            (skeleton.forearm, 0.022, 0.242, 0.682, 0.827),
        ] {
            assert!((segment.mass - mass * 65.0).abs() < 0.005, "{segment:?}");
            assert!((segment.centre - centre * length).abs() < 0.0005, "{segment:?}");
            let inertia = segment.mass * (gyration * length).powi(2);
            assert!((segment.inertia - inertia).abs() < 0.0005, "{segment:?}: {inertia}");
        }
    }

    /// Kinetic energy computed from the velocities of the centres of mass instead of M.
    #[test]
    fn energy_is_that_of_the_segments() {
        let skeleton = Arm::built_in().skeleton;
        let (upper, fore) = (skeleton.upper_arm, skeleton.forearm);
        let (angles, [shoulder, elbow]) = ([0.7, 1.3_f64], [2.0, -3.5_f64]);
        let about_centre = fore.inertia - fore.mass * fore.centre.powi(2);
        let turning = shoulder + elbow;
        // In the frame of the upper arm, the forearm's centre moves with the elbow and about it.
        let along = -fore.centre * turning * angles[1].sin();
        let across = skeleton.upper_arm_length * shoulder + fore.centre * turning * angles[1].cos();
        let expected = 0.5
            * (upper.inertia * shoulder.powi(2)
                + fore.mass * (along.powi(2) + across.powi(2))
                + about_centre * turning.powi(2));
        let found = skeleton.kinetic_energy(angles, [shoulder, elbow]);
        assert!((found - expected).abs() < 1e-12 * expected, "{found} J, not {expected} J");
    }

    /// M and C are consistent.
    #[test]
    fn the_change_of_kinetic_energy_is_the_power_of_the_torques() {
        let skeleton = Arm::built_in().skeleton;
        let (angles, velocities, torques) = ([0.7, 1.3], [2.0, -3.5], [1.7, -0.6]);
        let acceleration = skeleton.acceleration(angles, velocities, torques);
        let dt = 1e-5;
        let energy = |dt: f64| {
            let moved = |index: usize| {
                angles[index] + velocities[index] * dt + 0.5 * acceleration[index] * dt * dt
            };
            let sped = |index: usize| velocities[index] + acceleration[index] * dt;
            skeleton.kinetic_energy([moved(0), moved(1)], [sped(0), sped(1)])
        };
        let change = (energy(dt) - energy(-dt)) / (2.0 * dt);
        let power = torques[0] * velocities[0] + torques[1] * velocities[1];
        assert!((change - power).abs() < 1e-8 * power.abs(), "{change} W, not {power} W");
    }
}
