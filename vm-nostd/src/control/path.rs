//! Musculotendon path and moment arms of a muscle at angles, by the polynomial of
//! [`PathParams`].

use super::path_params::{AngleRange, ORDER, PathParams};
use crate::scalar::Scalar;
use crate::summed::summed;

/// Powers of an angle, the 0th included.
const POWERS: usize = ORDER + 1;

summed! {
    /// The joints' angles as a path takes them: x = (q - middle)/half of the range, -1..1.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Axis<S: Scalar> {
        pub(super) least: S,
        pub(super) most: S,
        middle: S,
        per_half: S::Factor,
    }
}

impl<S: Scalar> Axis<S> {
    pub(super) fn new(range: &AngleRange) -> Self {
        Self {
            least: S::from_f64(range.least),
            most: S::from_f64(range.most),
            middle: S::from_f64(range.middle()),
            per_half: S::factor(1.0 / range.reach()),
        }
    }

    pub(super) fn share(&self, angle: S) -> S {
        let angle = angle.max(self.least).min(self.most);
        (angle - self.middle).scaled(&self.per_half)
    }
}

/// Polynomials count in this unit, m: in fixed point its ULP is 6 nm.
const UNIT: f64 = 0.1;

summed! {
    /// A path, ready for a tick.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Path<S: Scalar, const J: usize> {
        /// Path in the middle of the ranges.
        middle: S::PathLength,
        /// Its change by powers of x of each joint, decimetres.
        change: [[S; POWERS]; J],
        /// -d change/dx, decimetres.
        arm: [[S; ORDER]; J],
        /// d arm/dx, decimetres.
        slope: [[S; ORDER]; J],
        /// Coefficient of x_1 x_2, decimetres.
        product: S,
        /// Decimetres to path lengths.
        unit: S::Factor,
        /// 0.1 m over the half range: decimetres per x to m/rad.
        per_angle: [S::Factor; J],
        /// The same over the half range once more.
        per_angle_squared: [S::Factor; J],
    }
}

/// A muscle in a posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<S: Scalar, const J: usize> {
    /// L_mt, m (in fixed point: µm).
    pub path_length: S::PathLength,
    /// Moment arm about each joint, m/rad; positive where the muscle flexes.
    pub moment_arms: [S; J],
    /// Its derivative by the angle of the same joint, m/rad².
    pub arm_slopes: [S; J],
}

impl<S: Scalar, const J: usize> Path<S, J> {
    /// A path that was validated for these ranges.
    pub(super) fn new(params: &PathParams<J>, ranges: &[AngleRange; J]) -> Self {
        let middle = ranges.each_ref().map(AngleRange::middle);
        let mut change = [[0.0; POWERS]; J];
        for (j, powers) in change.iter_mut().enumerate() {
            let offset = middle[j] - params.reference[j];
            let other = if J == 2 {
                params.product * (middle[1 - j] - params.reference[1 - j])
            } else {
                0.0
            };
            *powers = shifted(&params.terms[j], offset);
            powers[1] += other;
            let mut scale = 1.0 / UNIT;
            // Its value in the middle is in `middle`.
            powers[0] = 0.0;
            for power in powers {
                *power *= scale;
                scale *= ranges[j].reach();
            }
        }
        let half = |j: usize| ranges[j].reach();
        Self {
            middle: S::path_length(params.length_at(middle)),
            arm: change.map(|powers: [f64; POWERS]| {
                core::array::from_fn(|k| S::from_f64(-powers[k + 1] * (k + 1) as f64))
            }),
            slope: change.map(|powers: [f64; POWERS]| {
                core::array::from_fn(|k| {
                    let above = powers.get(k + 2).copied().unwrap_or(0.0);
                    S::from_f64(-above * ((k + 1) * (k + 2)) as f64)
                })
            }),
            change: change.map(|powers| powers.map(S::from_f64)),
            product: S::from_f64(if J == 2 {
                params.product * half(0) * half(1) / UNIT
            } else {
                0.0
            }),
            unit: S::path_factor(UNIT),
            per_angle: core::array::from_fn(|j| S::factor(UNIT / half(j))),
            per_angle_squared: core::array::from_fn(|j| S::factor(UNIT / (half(j) * half(j)))),
        }
    }

    /// The muscle at shares x of the ranges.
    pub(super) fn at(&self, shares: &[S; J]) -> Placed<S, J> {
        let mut change = S::ZERO;
        let mut moment_arms = [S::ZERO; J];
        let mut arm_slopes = [S::ZERO; J];
        for (j, &x) in shares.iter().enumerate() {
            let [longer] = x.polynomials([&self.change[j]]);
            change = change + longer;
            let [arm, slope] = x.polynomials([&self.arm[j], &self.slope[j]]);
            let other = if J == 2 { self.product * shares[1 - j] } else { S::ZERO };
            moment_arms[j] = (arm - other).scaled(&self.per_angle[j]);
            arm_slopes[j] = slope.scaled(&self.per_angle_squared[j]);
        }
        if J == 2 {
            change = change + self.product * shares[0] * shares[1];
        }
        let path_length = S::lengthened(self.middle, change, &self.unit);
        Placed { path_length, moment_arms, arm_slopes }
    }
}

/// A polynomial without a constant, by powers of the distance from `offset`.
fn shifted(terms: &[f64; ORDER], offset: f64) -> [f64; POWERS] {
    let mut powers = [0.0; POWERS];
    powers[1..].copy_from_slice(terms);
    // Repeated synthetic division by (d - offset).
    for lowest in 0..ORDER {
        for power in (lowest..ORDER).rev() {
            powers[power] += offset * powers[power + 1];
        }
    }
    powers
}
