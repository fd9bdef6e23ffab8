//! Parameters of the musculotendon path of a muscle as a polynomial of one or two joint angles.
//!
//! With the offsets d_j = q_j - reference_j of the joints' angles q_j,
//!
//! L_mt = length + Σ_j Σ_k terms_jk d_j^k + product d_1 d_2,
//!
//! and the moment arm about joint j is minus the derivative, r_j = -dL_mt/dq_j (virtual work: An et
//! al., J. Biomech. Eng. 106 (1984) 280-282, tendon-joint displacement). It is positive where the
//! muscle flexes, towards greater angles.

use crate::error::{Limit, ParameterError, within};
use crate::scalar::Arithmetic;

/// Highest power of an angle.
pub const ORDER: usize = 6;

/// Range of a joint's angle, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AngleRange {
    /// Least angle, rad; -6.3 to 6.3.
    pub least: f64,
    /// Greatest angle, rad; 0.01 more than the least, to 6.3.
    pub most: f64,
}

impl AngleRange {
    /// A range in degrees.
    pub const fn degrees(least: f64, most: f64) -> Self {
        Self { least: least * RADIANS, most: most * RADIANS }
    }

    /// Validates the range; the error has field, value and limit.
    pub fn validate(&self) -> Result<(), ParameterError> {
        within("angle_range.least", self.least, -6.3, 6.3)?;
        within("angle_range.most", self.most, self.least + 0.01, 6.3)
    }

    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.least + self.most)
    }

    fn half(&self) -> f64 {
        0.5 * (self.most - self.least)
    }

    /// Half of the range and a little: in fixed point polynomials are of numbers below 1, and of 1
    /// they would take -1. Of a narrow range the little is 4 ULP, for an end and the middle are
    /// rounded.
    pub(super) fn reach(&self) -> f64 {
        Arithmetic::max(self.half() * (1.0 + 1e-6), self.half() + 4.0 * ULP)
    }
}

/// Of an angle in fixed point, rad.
const ULP: f64 = 1.0 / 16_777_216.0;

/// Radians of a degree.
pub(crate) const RADIANS: f64 = core::f64::consts::PI / 180.0;

/// What a muscle does about a joint, anywhere in the joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Action {
    /// Its moment arm is positive: the path shortens towards greater angles.
    Flexes,
    /// Its moment arm is negative: the path lengthens towards greater angles.
    Extends,
    /// It does not cross the joint: its terms are 0.
    None,
    /// Its moment arm may change its sign.
    Either,
}

/// A path as a polynomial of `J` joint angles, 1 or 2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// serde implements its traits for arrays of certain lengths only.
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "[f64; J]: serde::Serialize, [[f64; ORDER]; J]: serde::Serialize, \
                     [Action; J]: serde::Serialize",
        deserialize = "[f64; J]: serde::Deserialize<'de>, \
                       [[f64; ORDER]; J]: serde::Deserialize<'de>, \
                       [Action; J]: serde::Deserialize<'de>"
    ))
)]
pub struct PathParams<const J: usize> {
    /// Path length at the reference angles, m; more than 0, to 4.
    pub length: f64,
    /// Reference angles, rad; -6.3 to 6.3.
    pub reference: [f64; J],
    /// Of each joint the coefficients of d, d², ... d⁶, m/rad^k; each -1 to 1.
    pub terms: [[f64; ORDER]; J],
    /// Coefficient of d_1 d_2, m/rad²; -1 to 1, and 0 with one joint.
    pub product: f64,
    /// What the muscle does about each joint: refused if its moment arm says otherwise.
    pub action: [Action; J],
}

/// Angles at which a moment arm is looked at.
const SAMPLES: u32 = 256;
/// Bisections that bring an angle to its last bits.
const HALVINGS: usize = 50;

const SHORTEST: &str = "path.length: shortest path in the joints' range, m";
const LONGEST: &str = "path.length: longest path in the joints' range, m";
const FLEXOR: &str = "path.terms: moment arm of a flexor, m";
const EXTENSOR: &str = "path.terms: moment arm of an extensor, m";
const UNCROSSED: &str = "path.terms: moment arm about a joint that is not crossed, m";
/// A moment arm that acts is at least this, m: with less the muscle is at a dead centre.
pub const LEAST_ARM: f64 = 1e-4;
/// Greatest moment arm, m.
const GREATEST_ARM: f64 = 0.5;

/// Value of a polynomial without a constant and its slope at `offset`.
fn polynomial(terms: &[f64; ORDER], offset: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for term in terms.iter().rev() {
        slope = slope * offset + value;
        value = value * offset + term;
    }
    (value * offset, value + slope * offset)
}

impl<const J: usize> PathParams<J> {
    /// Path length (m) at any angles (rad), also beyond the joints' ranges.
    pub fn length_at(&self, angles: [f64; J]) -> f64 {
        let offsets = self.offsets(angles);
        let added: f64 = (0..J).map(|j| polynomial(&self.terms[j], offsets[j]).0).sum();
        self.length + added + self.coupled(|j| offsets[j])
    }

    /// Moment arms (m) at any angles (rad), positive where the muscle flexes.
    pub fn moment_arms_at(&self, angles: [f64; J]) -> [f64; J] {
        let offsets = self.offsets(angles);
        core::array::from_fn(|j| {
            // 0 with one joint.
            let other = if J == 2 { self.product * offsets[1 - j] } else { 0.0 };
            -(polynomial(&self.terms[j], offsets[j]).1 + other)
        })
    }

    fn offsets(&self, angles: [f64; J]) -> [f64; J] {
        core::array::from_fn(|j| angles[j] - self.reference[j])
    }

    fn coupled(&self, of: impl Fn(usize) -> f64) -> f64 {
        if J == 2 { self.product * of(0) * of(1) } else { 0.0 }
    }

    /// Shortest and longest path (m) with angles in their ranges; with a product, a bound of them.
    pub fn extremes(&self, ranges: &[AngleRange; J]) -> (f64, f64) {
        let (mut shortest, mut longest) = (self.length, self.length);
        for (j, range) in ranges.iter().enumerate() {
            let at = |angle: f64| polynomial(&self.terms[j], angle - self.reference[j]);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut include = |angle: f64| {
                let (value, slope) = at(angle);
                (least, most) = (Arithmetic::min(least, value), Arithmetic::max(most, value));
                slope
            };
            let mut before = (range.least, include(range.least));
            for sample in 1..=SAMPLES {
                let angle = sampled(range, sample);
                let here = (angle, include(angle));
                if (before.1 > 0.0) != (here.1 > 0.0) {
                    include(turning(|angle| at(angle).1, before.0, here.0));
                }
                before = here;
            }
            (shortest, longest) = (shortest + least, longest + most);
        }
        if J == 2 {
            let corners = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(a, b)| {
                let end = |j: usize, most: usize| {
                    let range = &ranges[j];
                    (if most == 1 { range.most } else { range.least }) - self.reference[j]
                };
                self.product * end(0, a) * end(1, b)
            });
            shortest += corners.into_iter().fold(f64::INFINITY, Arithmetic::min);
            longest += corners.into_iter().fold(f64::NEG_INFINITY, Arithmetic::max);
        }
        (shortest, longest)
    }

    /// Validates the path for joints of these ranges and a muscle whose path domain
    /// ([`MuscleParams::path_domain`](crate::MuscleParams::path_domain)) is given, m.
    ///
    /// Refused are a moment arm that is not of its [`Action`] or below 0.1 mm somewhere in the
    /// range (a path that is not monotone), and a path that leaves the muscle's domain.
    pub fn validate(
        &self,
        ranges: &[AngleRange; J],
        domain: (f64, f64),
    ) -> Result<(), ParameterError> {
        within("joints", J as f64, 1.0, 2.0)?;
        ranges.iter().try_for_each(AngleRange::validate)?;
        within("path.length", self.length, f64::MIN_POSITIVE, 4.0)?;
        let most_product = if J == 2 { 1.0 } else { 0.0 };
        within("path.product", self.product, -most_product, most_product)?;
        for j in 0..J {
            within("path.reference", self.reference[j], -6.3, 6.3)?;
            self.terms[j].iter().try_for_each(|&term| within("path.terms", term, -1.0, 1.0))?;
            self.validate_arm(j, ranges)?;
        }
        let (shortest, longest) = self.extremes(ranges);
        within(SHORTEST, shortest, domain.0, domain.1)?;
        within(LONGEST, longest, domain.0, domain.1)
    }

    /// The moment arm about joint `j` is its action's: at the samples, and between them by the
    /// greatest slope that it can have.
    fn validate_arm(&self, j: usize, ranges: &[AngleRange; J]) -> Result<(), ParameterError> {
        let range = &ranges[j];
        let reach = Arithmetic::max(
            (range.least - self.reference[j]).abs(),
            (range.most - self.reference[j]).abs(),
        );
        // |d²L/dq²| <= Σ k (k - 1) |terms_k| reach^(k - 2).
        let (mut steepest, mut power) = (0.0, 1.0);
        for (k, term) in (1..).zip(&self.terms[j]).skip(1) {
            steepest += f64::from(k * (k - 1)) * term.abs() * power;
            power *= reach;
        }
        let between = steepest * range.half() / f64::from(SAMPLES);
        let mut other = (0.0, 0.0);
        if J == 2 {
            let (beside, reference) = (&ranges[1 - j], self.reference[1 - j]);
            let ends = [beside.least, beside.most].map(|angle| self.product * (angle - reference));
            other = (Arithmetic::min(ends[0], ends[1]), Arithmetic::max(ends[0], ends[1]));
        }
        for sample in 0..=SAMPLES {
            let slope = polynomial(&self.terms[j], sampled(range, sample) - self.reference[j]).1;
            let least = -(slope + other.1) - between;
            let most = -(slope + other.0) + between;
            match self.action[j] {
                Action::Flexes => within(FLEXOR, least, LEAST_ARM, GREATEST_ARM)?,
                Action::Extends => within(EXTENSOR, most, -GREATEST_ARM, -LEAST_ARM)?,
                Action::None => {
                    within(UNCROSSED, least, 0.0, 0.0)?;
                    within(UNCROSSED, most, 0.0, 0.0)?;
                }
                Action::Either => {
                    within("path.terms: moment arm, m", least, -GREATEST_ARM, GREATEST_ARM)?;
                    within("path.terms: moment arm, m", most, -GREATEST_ARM, GREATEST_ARM)?;
                }
            }
        }
        Ok(())
    }
}

fn sampled(range: &AngleRange, sample: u32) -> f64 {
    let share = f64::from(sample) / f64::from(SAMPLES);
    range.least + share * (range.most - range.least)
}

/// Where a slope changes its sign between two angles.
fn turning(slope: impl Fn(f64) -> f64, mut least: f64, mut most: f64) -> f64 {
    let rises = slope(least) > 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (least + most);
        if (slope(middle) > 0.0) == rises { least = middle } else { most = middle }
    }
    0.5 * (least + most)
}

/// Refuses more joints or muscles than there may be.
pub(super) fn count(field: &'static str, value: usize, most: usize) -> Result<(), ParameterError> {
    if (1..=most).contains(&value) {
        return Ok(());
    }
    let limit = Limit::Within { least: 1.0, most: most as f64 };
    Err(ParameterError { field, fiber: None, value: value as f64, limit })
}
