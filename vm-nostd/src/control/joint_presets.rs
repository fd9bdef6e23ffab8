//! Ankle, knee and elbow, each with two antagonists.
//!
//! **Moment arms** are published. Each source says what was read of it:
//!
//! - Tibialis anterior: Maganaris, J. Biomech. 33 (2000) 375-379, abstract: at rest from about
//!   4.5 cm in dorsiflexion to 2.9 cm in plantarflexion, in vivo. Assumed: a straight line between
//!   15° of dorsiflexion and 30° of plantarflexion, the range of the same author's Achilles tendon
//!   measurements of that year (Eur. J. Appl. Physiol. 83 (2000) 363-369, abstract).
//! - Soleus: Manal, Cowder & Buchanan, Physiol. Rep. 1 (2013) e00139, abstract: Achilles tendon at
//!   rest, 34.6 mm at 20° of dorsiflexion and a maximum of 36.9 mm at 10° of plantarflexion, in
//!   vivo. Assumed: a parabola with that maximum. The same paper's table 2 lists 36 to 57 mm by
//!   other methods.
//! - Quadriceps: patellar tendon in vivo, 42.55, 39.91, 37.73 and 36.18 mm at 0, 20, 40 and 60° of
//!   flexion, falling linearly ("Changes of the patellar tendon moment arm length in different knee
//!   angles", Arch. Bone Joint Surg., abstract). Here: the line of least squares, within 0.3 mm.
//!   Assumed: that it goes on to 90°.
//! - Hamstrings: 20 mm for biceps femoris, 20 to 40 mm for semimembranosus, 40 to 55 mm for
//!   semitendinosus (Tözeren, Human Body Dynamics, appendix C, which names Spoor & van Leeuwen
//!   1992). Here: the mean weighted by F0 with the middle of each range, 29.3 mm. Assumed:
//!   constant, as Visser et al., Eur. J. Appl. Physiol. 61 (1990) 453-460, found for biceps femoris
//!   (abstract).
//! - Biceps and triceps: Pigeon, Yahia & Feldman, J. Biomech. 29 (1996) 1365-1370, polynomials in
//!   degrees, as two published programs give them (the paper itself was not read).
//!
//! **Muscles** are of gait2392 (ankle, knee) and arm26 (elbow), as `vm muscles` lists them with
//! their sources. Lumped muscles have the sum of F0 and the means of the lengths and of the slow
//! fraction, weighted by F0. Assumed for all: the fascicles are at L_ce0, with the tendon at
//! L_se0, at [`MuscleOnJoint::optimal_angle`]; L_max = 1.4; no pennation.

use super::joint::JointMuscle;
use super::path_params::{Action, AngleRange, ORDER, PathParams, RADIANS};
use crate::params::class::Class;
use crate::params::presets::human_vm4::{ELEMENTS, FAST, SLOW};
use crate::params::{FiberParams, MuscleParams};

/// A joint with a flexor and an extensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPreset {
    /// Name.
    pub name: &'static str,
    /// Range of the angle, rad; greater angles are flexion (at the ankle dorsiflexion).
    pub range: AngleRange,
    /// Flexor and extensor.
    pub muscles: [MuscleOnJoint; 2],
}

/// A muscle of a joint of one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MuscleOnJoint {
    /// Name.
    pub name: &'static str,
    /// F0, N.
    pub max_isometric_force: f64,
    /// L_ce0, m.
    pub fascicle_length: f64,
    /// Slack length of the tendon, m.
    pub tendon_slack_length: f64,
    /// Share of slow fibres in the cross section.
    pub slow_fraction: f64,
    /// Moment arm by powers of the angle q in rad, constant first, m/rad^k; flexors' are positive.
    pub moment_arm: [f64; ORDER],
    /// Angle at which fascicles and tendon are at their optimal length, rad: assumed.
    pub optimal_angle: f64,
    /// What it does.
    pub action: Action,
}

/// Longest fascicles of the passive muscle, L_ce0: assumed, as for the muscles of `vm`.
const MAXIMUM_FASCICLE_LENGTH: f64 = 1.4;
/// Activation at which all fibres are recruited: the authors' default.
const RECRUITMENT_SATURATION: f64 = 0.8;

impl MuscleOnJoint {
    /// The muscle's parameters: human fibre types, standard class.
    pub fn params(&self) -> MuscleParams<2> {
        let fascicle_length = self.fascicle_length;
        let mut params = MuscleParams {
            mass: self.max_isometric_force * ELEMENTS.density * fascicle_length
                / ELEMENTS.specific_tension,
            fascicle_length,
            tendon_length: self.tendon_slack_length / ELEMENTS.tendon.slack_length,
            max_path_length: 0.0,
            recruitment_saturation: RECRUITMENT_SATURATION,
            class: Class::Standard,
            elements: ELEMENTS,
            fibers: [
                FiberParams { fraction: self.slow_fraction, fiber_type: SLOW },
                FiberParams { fraction: 1.0 - self.slow_fraction, fiber_type: FAST },
            ],
        };
        // L_max is linear in the longest path.
        let at_no_path = params.maximum_fascicle_length();
        params.max_path_length = (MAXIMUM_FASCICLE_LENGTH - at_no_path) * fascicle_length;
        params
    }

    /// The path: the integral of the moment arm, through the optimal length at the optimal angle.
    pub fn path(&self) -> PathParams<1> {
        let params = self.params();
        let mut terms = [0.0; ORDER];
        for ((term, arm), power) in terms.iter_mut().zip(self.moment_arm).zip(1..) {
            *term = -arm / f64::from(power);
        }
        let path = PathParams {
            length: 0.0,
            reference: [0.0],
            terms: [terms],
            product: 0.0,
            action: [self.action],
        };
        let optimal = params.fascicle_length + params.tendon_length;
        PathParams { length: optimal - path.length_at([self.optimal_angle]), ..path }
    }

    /// The muscle as [`Joint`](super::Joint) takes it.
    pub fn on_joint(&self) -> JointMuscle<1> {
        JointMuscle::new(&self.params(), self.path())
    }
}

/// Radians of so many degrees.
const fn degrees(degrees: f64) -> f64 {
    degrees * RADIANS
}

/// A polynomial whose coefficients are mm per power of degrees, in m per power of rad.
const fn in_degrees(mut millimetres: [f64; ORDER]) -> [f64; ORDER] {
    let (mut power, mut scale) = (0, 1e-3);
    while power < ORDER {
        millimetres[power] *= scale;
        scale /= RADIANS;
        power += 1;
    }
    millimetres
}

/// Tibialis anterior and soleus; 0 is a right angle between foot and shank.
pub const ANKLE: JointPreset = JointPreset {
    name: "ankle",
    range: AngleRange::degrees(-40.0, 20.0),
    muscles: [
        MuscleOnJoint {
            name: "tibialis anterior",
            max_isometric_force: 905.0,
            fascicle_length: 0.0979,
            tendon_slack_length: 0.2228,
            slow_fraction: 0.5,
            // 45 mm at 15° and 29 mm at -30°.
            moment_arm: in_degrees([45.0 - 15.0 * 16.0 / 45.0, 16.0 / 45.0, 0.0, 0.0, 0.0, 0.0]),
            optimal_angle: degrees(-10.0),
            action: Action::Flexes,
        },
        MuscleOnJoint {
            name: "soleus",
            max_isometric_force: 3549.0,
            fascicle_length: 0.0503,
            tendon_slack_length: 0.2514,
            slow_fraction: 0.7,
            // -36.9 mm at -10°, -34.6 mm at 20°.
            moment_arm: in_degrees([
                -36.9 + 2.3 / 9.0,
                2.3 * 20.0 / 900.0,
                2.3 / 900.0,
                0.0,
                0.0,
                0.0,
            ]),
            optimal_angle: degrees(0.0),
            action: Action::Extends,
        },
    ],
};

/// Hamstrings and quadriceps, with the hip held; 0 is the straight knee.
pub const KNEE: JointPreset = JointPreset {
    name: "knee",
    range: AngleRange::degrees(0.0, 100.0),
    muscles: [
        MuscleOnJoint {
            name: "hamstrings",
            max_isometric_force: 2594.0,
            fascicle_length: 0.1235,
            tendon_slack_length: 0.3757,
            slow_fraction: 0.5,
            moment_arm: [0.0293, 0.0, 0.0, 0.0, 0.0, 0.0],
            optimal_angle: degrees(30.0),
            action: Action::Flexes,
        },
        MuscleOnJoint {
            name: "quadriceps",
            max_isometric_force: 5699.0,
            fascicle_length: 0.1063,
            tendon_slack_length: 0.2034,
            slow_fraction: 0.434,
            moment_arm: [-42.286e-3, 6.0991e-3, 0.0, 0.0, 0.0, 0.0],
            optimal_angle: degrees(60.0),
            action: Action::Extends,
        },
    ],
};

/// Biceps (both heads) and triceps (three heads); 0 is the straight elbow.
pub const ELBOW: JointPreset = JointPreset {
    name: "elbow",
    range: AngleRange::degrees(0.0, 140.0),
    muscles: [
        MuscleOnJoint {
            name: "biceps",
            max_isometric_force: 1059.9,
            fascicle_length: 0.1224,
            tendon_slack_length: 0.2394,
            slow_fraction: 0.5,
            moment_arm: in_degrees([14.660, 4.5322e-1, 1.8047e-3, -2.9883e-5, 0.0, 0.0]),
            optimal_angle: degrees(80.0),
            action: Action::Flexes,
        },
        MuscleOnJoint {
            name: "triceps",
            max_isometric_force: 2047.1,
            fascicle_length: 0.1217,
            tendon_slack_length: 0.1133,
            slow_fraction: 0.5,
            moment_arm: in_degrees([
                -23.287, -3.0284e-1, 12.886e-3, -19.092e-5, 13.277e-7, -3.5171e-9,
            ]),
            optimal_angle: degrees(80.0),
            action: Action::Extends,
        },
    ],
};
