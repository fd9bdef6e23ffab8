//! The limb that a joint moves: the torque that a motion needs.
//!
//! τ = J a + B v + G sin(q - q_hang), with the inertia J about the joint, damping B, and G = m g l
//! of the limb's weight at its centre's distance from the joint.

use super::path::Axis;
use super::path_params::AngleRange;
use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::scalar::float::tangent;
use crate::summed::summed;

/// Parameters of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimbParams {
    /// Inertia about the joint J, kg m²; 0 to 10.
    pub inertia: f64,
    /// Damping B, N m s/rad; 0 to 100.
    pub damping: f64,
    /// Weight times the distance of its centre G, N m; 0 to 200, and 0 where the joint's range is
    /// wider than 4 rad.
    pub gravity: f64,
    /// Angle at which the limb hangs straight down, rad; -6.3 to 6.3.
    pub hanging_angle: f64,
}

impl LimbParams {
    /// Validates the parameters; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("limb.inertia", self.inertia, 0.0, 10.0)?;
        within("limb.damping", self.damping, 0.0, 100.0)?;
        within("limb.gravity", self.gravity, 0.0, 200.0)?;
        within("limb.hanging_angle", self.hanging_angle, -6.3, 6.3)
    }
}

/// Terms of the sine's series: over a range of 4 rad the rest is below 3e-4 of G, over 2.5 rad
/// 3e-6.
const TERMS: usize = 10;
/// Widest range of a limb that has weight, rad.
const WIDEST: f64 = 4.0;

summed! {
    /// A limb, ready for a tick; torques count in a unit.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Limb<S: Scalar> {
        inertia: S::Factor,
        damping: S::Factor,
        axis: Axis<S>,
        /// G sin(q - q_hang) by powers of the share of the range.
        gravity: [S; TERMS],
    }
}

impl<S: Scalar> Limb<S> {
    pub(super) fn new(
        params: &LimbParams,
        range: &AngleRange,
        unit: f64,
    ) -> Result<Self, ParameterError> {
        params.validate()?;
        if params.gravity > 0.0 {
            within("angle_range.most", range.most, range.least, range.least + WIDEST)?;
        }
        let middle = range.middle() - params.hanging_angle;
        // sin and cos of the middle by tan of its half, kept away from its pole.
        let half = tangent(0.5 * middle);
        let (sine, cosine) =
            (2.0 * half / (1.0 + half * half), (1.0 - half * half) / (1.0 + half * half));
        let derivatives = [sine, cosine, -sine, -cosine];
        let mut scale = params.gravity / unit;
        let mut gravity = [0.0; TERMS];
        for (power, term) in gravity.iter_mut().enumerate() {
            *term = derivatives[power % 4] * scale;
            scale *= range.reach() / (power + 1) as f64;
        }
        Ok(Self {
            inertia: S::factor(params.inertia / unit),
            damping: S::factor(params.damping / unit),
            axis: Axis::new(range),
            gravity: gravity.map(S::from_f64),
        })
    }

    /// The torque of a motion: angle (rad), velocity (rad/s), acceleration (rad/s²).
    pub(super) fn torque(&self, angle: S, velocity: S, acceleration: S) -> S {
        let [gravity] = self.axis.share(angle).polynomials([&self.gravity]);
        acceleration.scaled(&self.inertia) + velocity.scaled(&self.damping) + gravity
    }
}
