//! Force-velocity relation of the filaments: a hyperbola for shortening, another for lengthening.
//!
//! V <= 0: (Vmax - V)/(Vmax + (cV0 + cV1 L) V);
//! V > 0: (bV - (aV0 + aV1 L + aV2 L²) V)/(bV + V).
//!
//! Both are (1 + n V)/(1 + d V) = 1 + (n - d) V/(1 + d V), with n and d chosen by the sign of V.

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::summed::summed;
use crate::tick::course::Course;

/// Coefficients of FV.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceVelocityParams {
    /// Velocity of unloaded shortening V_max, L_ce0/s; -100 to -0.1.
    #[doc(alias = "Vmax")]
    pub maximum_velocity: f64,
    /// c_V0 and c_V1 of the shortening branch, each -100 to 100.
    #[doc(alias = "cV0")]
    pub shortening: [f64; 2],
    /// a_V0, a_V1 and a_V2 of the lengthening branch, each -100 to 100.
    #[doc(alias = "aV0")]
    pub lengthening: [f64; 3],
    /// b_V of the lengthening branch, L_ce0/s; 0.01 to 10.
    #[doc(alias = "bV")]
    pub lengthening_velocity: f64,
}

/// Lower bound of cV0 + cV1 L + 1. At 0 and below, FV has a pole between V = 0 and Vmax.
const POLE_MARGIN: f64 = 0.02;

/// Names, in errors, of derived quantities.
const SHORTENING: &str = "force_velocity.shortening: cV0 + cV1 L";
const LENGTHENING: &str = "force_velocity.lengthening: aV0 + aV1 L + aV2 L²";

impl ForceVelocityParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        let v_max = self.maximum_velocity;
        within("force_velocity.maximum_velocity", v_max, -100.0, -0.1)?;
        for coefficient in self.shortening {
            within("force_velocity.shortening", coefficient, -100.0, 100.0)?;
        }
        for coefficient in self.lengthening {
            within("force_velocity.lengthening", coefficient, -100.0, 100.0)?;
        }
        within("force_velocity.lengthening_velocity", self.lengthening_velocity, 0.01, 10.0)
    }

    /// Shortest fascicle length (L_ce0, at least `least`) above which the shortening branch has no
    /// pole and rises with V.
    pub(crate) fn shortest_length(&self, least: f64) -> f64 {
        let [c0, c1] = self.shortening;
        if c1 > 0.0 { ((POLE_MARGIN - 1.0 - c0) / c1).max(least) } else { least }
    }

    /// Refuses coefficients that the arithmetic cannot represent in a range of fascicle lengths:
    /// those of both branches, (1 + n V)/(1 + d V), and their terms.
    pub(crate) fn validate_magnitudes(
        &self,
        least: f64,
        most: f64,
        largest: f64,
    ) -> Result<(), ParameterError> {
        let within = |field, value: f64| within(field, value, -largest, largest);
        let v_max = self.maximum_velocity;
        within("force_velocity.maximum_velocity", v_max)?;
        within("force_velocity.maximum_velocity: its reciprocal", 1.0 / v_max)?;
        let [c0, c1] = self.shortening;
        let [a0, a1, a2] = self.lengthening;
        let b = self.lengthening_velocity;
        within("force_velocity.lengthening_velocity: its reciprocal", 1.0 / b)?;
        for coefficient in [c0 / v_max, c1 * most / v_max] {
            within("force_velocity.shortening: relative to V_max", coefficient)?;
        }
        // Horner's scheme: monotonic terms are largest at an end of the range, and the quadratic is
        // at most the sum of its checked terms.
        for length in [least, most] {
            for part in [a0, (a1 + a2 * length) * length, a1, a2 * length] {
                within("force_velocity.lengthening: relative to b_V", part / b)?;
            }
        }
        Ok(())
    }

    /// Refuses coefficients with which FV does not increase monotonically with V over a range of
    /// fascicle lengths: the sign of the net force at V = 0 would not be that of V.
    pub(crate) fn validate_monotone(&self, least: f64, most: f64) -> Result<(), ParameterError> {
        let [c0, c1] = self.shortening;
        let [a0, a1, a2] = self.lengthening;
        let turning_point = if a2 == 0.0 { least } else { (-0.5 * a1 / a2).max(least).min(most) };
        for length in [least, most, turning_point] {
            let shortening = c0 + c1 * length;
            within(SHORTENING, shortening, POLE_MARGIN * 0.5 - 1.0, 300.0)?;
            let lengthening = a0 + a1 * length + a2 * length * length;
            within(LENGTHENING, lengthening, -300.0, -1.0)?;
        }
        Ok(())
    }
}

summed! {
    /// FV of one fibre type.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct ForceVelocity<S> {
        maximum_velocity: S,
        /// -1/Vmax, and cV0/Vmax, cV1/Vmax.
        per_maximum: S,
        shortening: [S; 2],
        /// 1/bV and -aV0/bV, -aV1/bV, -aV2/bV.
        per_lengthening: S,
        lengthening: [S; 3],
    }
}

impl<S: Scalar> ForceVelocity<S> {
    pub(crate) fn new(params: &ForceVelocityParams) -> Self {
        let v_max = params.maximum_velocity;
        let b = params.lengthening_velocity;
        Self {
            maximum_velocity: S::from_f64(v_max),
            per_maximum: S::from_f64(-1.0 / v_max),
            shortening: params.shortening.map(|c| S::from_f64(c / v_max)),
            per_lengthening: S::from_f64(1.0 / b),
            lengthening: params.lengthening.map(|a| S::from_f64(-a / b)),
        }
    }

    /// FV during a tick, from the mid-tick fascicle length (L_ce0) and its change `travel` (L_ce0)
    /// during the tick.
    ///
    /// The lengthening branch depends on length as strongly as FL does. Held constant during the
    /// tick, it would cause nearly all of the error at 2 ms.
    #[inline(always)]
    pub(crate) fn at(&self, fascicle_length: S, travel: S) -> VelocityCurve<S> {
        let [c0, c1] = self.shortening;
        let [a0, a1, a2] = self.lengthening;
        let steepness = a1 + (a2 + a2) * fascicle_length;
        VelocityCurve {
            shortening: Course { middle: c0 + c1 * fascicle_length, change: c1 * travel },
            lengthening: Course {
                middle: a0 + (a1 + a2 * fascicle_length) * fascicle_length,
                change: steepness * travel,
            },
        }
    }
}

/// FV during one tick. Either branch is (1 + n V)/(1 + d V).
#[derive(Clone, Copy, Debug)]
pub(crate) struct VelocityCurve<S> {
    /// d of the shortening branch.
    shortening: Course<S>,
    /// n of the lengthening branch.
    lengthening: Course<S>,
}

/// FV of all types during a tick; see [`ForceVelocity::at`].
#[inline(always)]
pub(crate) fn curves<S: Scalar, const N: usize>(
    types: [&ForceVelocity<S>; N],
    fascicle_length: S,
    travel: S,
) -> [VelocityCurve<S>; N] {
    let none = Course { middle: S::ZERO, change: S::ZERO };
    let mut curves = [VelocityCurve { shortening: none, lengthening: none }; N];
    for (curve, fiber) in curves.iter_mut().zip(types) {
        *curve = fiber.at(fascicle_length, travel);
    }
    curves
}

impl<S: Scalar> ForceVelocity<S> {
    /// n and d of the branch selected by `lengthening`, `time` ticks after mid-tick of a `curve`.
    #[inline(always)]
    pub(crate) fn branch(
        &self,
        curve: &VelocityCurve<S>,
        time: S::Part,
        lengthening: bool,
    ) -> Branch<S> {
        if lengthening {
            Branch { numerator: curve.lengthening.at(time), denominator: self.per_lengthening }
        } else {
            Branch { numerator: self.per_maximum, denominator: curve.shortening.at(time) }
        }
    }
}

impl<S: Scalar> ForceVelocity<S> {
    /// Whether a velocity is at or beyond V_max, where FV is clamped to 0; the paper's expression
    /// is negative there.
    pub(crate) fn is_beyond(&self, velocity: S) -> bool {
        velocity <= self.maximum_velocity
    }
}

/// One branch of FV at one length: (1 + n V)/(1 + d V).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch<S> {
    /// n.
    pub(crate) numerator: S,
    /// d.
    pub(crate) denominator: S,
}

/// FV at one velocity V: the value is 1 + secant V, the slope dFV/dV is secant reciprocal, and half
/// the curvature is -bend times the slope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Value<S> {
    /// (n - d)/(1 + d V).
    pub(crate) secant: S,
    /// 1/(1 + d V).
    pub(crate) reciprocal: S,
    /// d/(1 + d V).
    pub(crate) bend: S,
}

impl<S: Scalar> Value<S> {
    /// FV at the velocity.
    pub(crate) fn value(&self, velocity: S) -> S {
        S::ONE + self.secant * velocity
    }
}

impl<S: Scalar> Branch<S> {
    /// A branch with FV = 0 at a velocity beyond V_max.
    pub(crate) fn beyond(velocity: S) -> Self {
        Self { numerator: (-velocity).reciprocal(), denominator: S::ZERO }
    }

    /// FV at a velocity V, given 1/(1 + d V).
    #[inline(always)]
    pub(crate) fn at(&self, reciprocal: S) -> Value<S> {
        Value {
            secant: (self.numerator - self.denominator) * reciprocal,
            reciprocal,
            bend: self.denominator * reciprocal,
        }
    }
}

impl<S: Scalar> ForceVelocity<S> {
    /// FV at a velocity above V_max, computed as in the mechanics.
    pub(crate) fn on(&self, curve: &VelocityCurve<S>, time: S::Part, velocity: S) -> Value<S> {
        let branch = self.branch(curve, time, velocity > S::ZERO);
        let [reciprocal] = velocity.reciprocals_of_one_plus([branch.denominator]);
        branch.at(reciprocal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::PAPER_MUSCLE;
    use crate::scalar::Kernels;
    use crate::scalar::fixed::Fixed;

    #[test]
    fn fv_is_0_beyond_v_max() {
        for fiber in PAPER_MUSCLE.fibers {
            let params = fiber.fiber_type.force_velocity;
            let (least, most) = (params.maximum_velocity, params.maximum_velocity + 0.1);
            let (f64, fixed) =
                (ForceVelocity::<f64>::new(&params), ForceVelocity::<Fixed>::new(&params));
            assert!(f64.is_beyond(least) && !f64.is_beyond(most));
            assert!(
                fixed.is_beyond(Fixed::from_f64(least)) && !fixed.is_beyond(Fixed::from_f64(most))
            );
        }
        for velocity in [-0.2, -3.0, -60.0] {
            let [of_f64] = velocity.reciprocals_of_one_plus([0.0]);
            let secant = Branch::<f64>::beyond(velocity).at(of_f64).secant;
            assert!((1.0 + secant * velocity).abs() < 1e-15);
            let velocity = Fixed::from_f64(velocity);
            let [of_fixed] = velocity.reciprocals_of_one_plus([Fixed::ZERO]);
            let secant = Branch::<Fixed>::beyond(velocity).at(of_fixed).secant;
            let value = (Fixed::ONE + secant * velocity).to_f64();
            assert!(value.abs() < 60.0 / 16_777_216.0 + 1e-7, "{value}");
        }
    }
}
