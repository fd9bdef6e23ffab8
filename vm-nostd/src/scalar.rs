//! Arithmetics of the model: floating point and fixed point behind one trait.

pub(crate) mod cold;
pub(crate) mod fixed;
pub(crate) mod float;
mod series;

use crate::summed::{FromWords, Summed};
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

pub(crate) mod sealed {
    /// Seals [`Scalar`](super::Scalar): only tested types implement it.
    pub trait Sealed {}
}

/// An arithmetic of the model: `f32` with a floating-point unit, [`Fixed`](crate::Fixed) without
/// one, `f64` for comparison.
///
/// Results are bit-identical on all machines: `a * b + c` is never fused, and the kernels are
/// portable code.
///
/// The equations are generic over this trait. Sums and products saturate in fixed point; operations
/// that need more resolution are explicit: [`scaled`](Scalar::scaled) by a constant of any
/// magnitude, [`LagState`](Scalar::LagState) for the state of a lag, [`ratio`](Scalar::ratio).
///
/// Kernels and functions called once per tick are inlined: a call needs a stack frame and spills
/// registers.
pub trait Scalar:
    sealed::Sealed
    + FromWords
    + Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// A word of a saved state.
    type Bits: Copy + Debug + Eq + From<u32> + TryFrom<u64> + Into<u64> + Summed + Send + Sync;
    /// A constant factor of any magnitude.
    type Factor: Copy + Debug + FromWords + Send + Sync;
    /// State of a lag, with more resolution than the number itself.
    type LagState: Copy + Debug + PartialEq + Send + Sync;
    /// A factor from -1/2 to 1/2, such as a time in ticks since mid-tick.
    type Part: Copy + Debug + Add<Output = Self::Part> + FromWords + Send + Sync;
    /// A factor from 0 to 1.
    type Unit: Copy + Debug + Send + Sync;
    /// Share, 0..1, of the distance of a lag to its target.
    type Share: Copy + Debug + FromWords + Send + Sync;
    /// A musculotendon path length: m in floating point, µm in fixed point.
    type PathLength: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;
    /// A quantity with a unit: stimulation frequency in pps, pulse amplitude in mA, pulse width in
    /// µs.
    type Quantity: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;
    /// A tendon force: N in floating point, mN in fixed point.
    type Force: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;

    /// Number of the arithmetic in a saved state.
    #[doc(hidden)]
    const ARITHMETIC: u32;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// -1/2.
    const MINUS_HALF: Self::Part;
    /// A positive value that is negligible in every equation.
    const LEAST: Self;
    /// Largest representable coefficient.
    const LARGEST_COEFFICIENT: f64;
    /// Whether each operation of a tick is done for all fibre types before the next one, which
    /// hides latencies. With few registers it is faster to process one type after the other.
    const SIDE_BY_SIDE: bool;
    /// Range of maximal isometric force that outputs can represent, N.
    const MAXIMAL_FORCES: (f64, f64);
    /// Resolution of forces, N.
    const FORCE_STEP: f64;
    /// Longest representable path, m.
    const LONGEST_PATH: f64;
    /// Words of a [`LagState`](Scalar::LagState) in a saved state.
    const LAG_STATE_WORDS: usize;

    /// Nearest value. Used when a muscle is built, never in a tick.
    fn from_f64(value: f64) -> Self;
    /// The value, exactly.
    fn to_f64(self) -> f64;
    /// The value as a word of a saved state.
    fn to_bits(self) -> Self::Bits;
    /// The value of a word from [`to_bits`](Scalar::to_bits).
    fn from_bits(bits: Self::Bits) -> Self;
    /// Whether it is finite.
    fn is_finite(self) -> bool;
    /// Whether it is the largest value: the limit of saturation in fixed point, infinity in
    /// floating point.
    fn is_saturated(self) -> bool;

    /// The factor nearest to a constant. Used when a muscle is built.
    fn factor(value: f64) -> Self::Factor;
    /// Product with a constant; saturates.
    #[must_use]
    fn scaled(self, factor: &Self::Factor) -> Self;
    /// The part nearest to a constant, -1/2 to 1/2. Used when a muscle is built.
    fn part(value: f64) -> Self::Part;
    /// Product with a part; fixed point rounds toward minus infinity.
    #[must_use]
    fn portion(self, part: Self::Part) -> Self;
    /// Product with a part; fixed point rounds to nearest.
    #[must_use]
    fn rounded_portion(self, part: Self::Part) -> Self;
    /// The number as a factor; clamped to 0..1 in fixed point.
    fn unit(self) -> Self::Unit;
    /// Product with a factor from 0 to 1; fixed point rounds toward minus infinity to a multiple of
    /// two ULP.
    #[must_use]
    fn by(self, unit: Self::Unit) -> Self;
    /// `self` divided by a positive number; saturates.
    #[must_use]
    fn ratio(self, divisor: Self) -> Self;

    /// Half of `self`; fixed point rounds toward minus infinity.
    #[must_use]
    fn half(self) -> Self;
    /// Polynomials in `self` (-1..1). Coefficients are in order of powers, constant first; the sum
    /// of their magnitudes is at most 100.
    fn polynomials<const N: usize, const TERMS: usize>(
        self,
        terms: [&[Self; TERMS]; N],
    ) -> [Self; N];
    /// Reciprocal of a positive number; saturates.
    #[must_use]
    fn reciprocal(self) -> Self;
    /// Reciprocals of positive numbers.
    #[must_use]
    fn reciprocals<const N: usize>(numbers: [Self; N]) -> [Self; N];
    /// Quotients by positive numbers.
    #[must_use]
    fn ratios<const N: usize>(dividends: [Self; N], divisors: [Self; N]) -> [Self; N];
    /// Reciprocal of a positive number as a factor, for several quotients by the same divisor.
    fn reciprocal_factor(self) -> Self::Factor;

    /// Exponential of `self`, which is at most 80; underflows to 0.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number; for 0, approximately that of the smallest positive
    /// number.
    #[must_use]
    fn ln(self) -> Self;
    /// `ln(exp(self) + 1)` and its slope, the logistic function of `self`, 0..1.
    fn softplus(self) -> (Self, Self::Unit);
    /// `1 - exp(-exp(self))`, the Weibull distribution as a function of the logarithm.
    #[must_use]
    fn weibull(self) -> Self;
    /// `1/(1 + factor self)` for each factor; the denominators must be positive.
    #[must_use]
    fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N];
    /// Solves a force balance with a residual `self`, a line and a hyperbola: the root u of
    /// `self` + `line` u + h(u) = 0. Also returns the damping at the root relative to the inertia.
    ///
    /// h(u) = `steepness` u/(1 + bend u), with half its curvature at 0 in `half_curvature`; the
    /// root is on the branch through 0. `line` and `steepness` are positive. The damping is
    /// `viscosity` plus the secant of the hyperbola, h(u)/u.
    fn hyperbola_root(
        self,
        line: Self,
        steepness: Self,
        half_curvature: Self,
        inertia: Self,
        viscosity: Self,
    ) -> Balance<Self>;

    /// State of a lag with the value `self`.
    fn lag_state(self) -> Self::LagState;
    /// Value of the state of a lag.
    fn of(state: Self::LagState) -> Self;
    /// State of a lag after adding `difference` times `share`.
    fn advanced(state: Self::LagState, difference: Self, share: Self::Share) -> Self::LagState;
    /// State of a lag after adding two differences times their shares.
    fn advanced_by_two(
        state: Self::LagState,
        first: (Self, Self::Share),
        second: (Self, Self::Share),
    ) -> Self::LagState;
    /// The share nearest to a constant, 0..1. Used when a muscle is built.
    fn share(value: f64) -> Self::Share;
    /// Step response of a lag after `self` time constants: 1 - exp(-`self`).
    fn lag_response(self) -> Self::Share;
    /// Step response of two lags in series after half of x and after x = `self` time constants, at
    /// most 2.5.
    fn lags(self) -> [Lags<Self::Share>; 2];
    /// Words of the state of a lag.
    fn lag_state_words(state: Self::LagState) -> impl Iterator<Item = Self::Bits>;
    /// State of a lag from the next words; `None` if there are too few.
    fn lag_state_from_words(words: &mut impl Iterator<Item = Self::Bits>)
    -> Option<Self::LagState>;

    /// Nearest path length to one in m. Not used in a tick.
    fn path_length(metres: f64) -> Self::PathLength;
    /// Path length in m, exact or rounded to `f64`.
    fn path_metres(path: Self::PathLength) -> f64;
    /// Whether it is finite.
    fn path_is_finite(path: Self::PathLength) -> bool;
    /// Factor from path lengths to numbers: `value` per m.
    fn per_metre(value: f64) -> Self::Factor;
    /// (`path` - `other`) times a factor per m.
    fn path_difference(
        path: Self::PathLength,
        other: Self::PathLength,
        per_metre: &Self::Factor,
    ) -> Self;
    /// Factor from numbers to path lengths: `metres` per 1.
    fn path_factor(metres: f64) -> Self::Factor;
    /// A path length plus a number times a factor; saturates.
    fn lengthened(path: Self::PathLength, by: Self, factor: &Self::Factor) -> Self::PathLength;
    /// The word of a path length.
    fn path_bits(path: Self::PathLength) -> Self::Bits;
    /// The path length whose word is `bits`.
    fn path_from_bits(bits: Self::Bits) -> Self::PathLength;

    /// Nearest quantity to one in its unit. Not used in a tick.
    fn quantity(value: f64) -> Self::Quantity;
    /// A quantity in its unit, exactly.
    fn quantity_value(quantity: Self::Quantity) -> f64;
    /// Whether it is finite.
    fn quantity_is_finite(quantity: Self::Quantity) -> bool;
    /// Factor from quantities to numbers: `value` per unit.
    fn per_quantity(value: f64) -> Self::Factor;
    /// A quantity times a factor per unit.
    fn of_quantity(quantity: Self::Quantity, per_unit: &Self::Factor) -> Self;
    /// Factor from numbers to quantities: units per 1.
    fn quantity_factor(value: f64) -> Self::Factor;
    /// A number times a factor as a quantity; saturates.
    fn as_quantity(self, quantity_factor: &Self::Factor) -> Self::Quantity;

    /// Factor from relative force to force, for F0 in N.
    fn force_factor(newtons: f64) -> Self::Factor;
    /// A force relative to F0 as a force.
    fn force(self, force_factor: &Self::Factor) -> Self::Force;
    /// Factor from forces to numbers: `value` per N.
    fn per_newton(value: f64) -> Self::Factor;
    /// A force times a factor per N.
    fn of_force(force: Self::Force, per_newton: &Self::Factor) -> Self;
    /// A force times a share, 0..1.
    fn of_share(self, force: Self::Force) -> Self::Force;
    /// The word of a force.
    fn force_bits(force: Self::Force) -> Self::Bits;
    /// Force in N, exact or rounded to `f64`.
    fn newtons(force: Self::Force) -> f64;
    /// Force in N for a muscle whose F0 is `newtons`, from the one of `force` and `relative_force`
    /// that has the higher resolution.
    fn newtons_of(force: Self::Force, relative_force: Self, newtons: f64) -> f64;

    /// Minimum; `other` if `self` is NaN.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// Maximum; `other` if `self` is NaN.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// Whether it lies between 0 and `end`, which can be negative.
    fn is_between_0_and(self, end: Self) -> bool;

    /// Whether its sign bit is set.
    fn is_negative(self) -> bool;

    /// `self` if its sign bit is `negative`, otherwise 0.
    #[must_use]
    fn of_sign(self, negative: bool) -> Self;

    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

/// Step response of two lags in series after x time constants.
#[derive(Clone, Copy, Debug)]
pub struct Lags<T> {
    /// Response of the first lag, 1 - exp(-x).
    pub response: T,
    /// Response of the first lag minus that of the second, x exp(-x).
    pub delayed: T,
}

/// Root of a force balance, and the damping there.
#[derive(Clone, Copy, Debug)]
pub struct Balance<S: Scalar> {
    /// The root.
    pub root: S,
    /// damping/(inertia + damping), 0..1.
    pub damped: S::Unit,
    /// 1/(inertia + damping).
    pub reciprocal: S,
}
