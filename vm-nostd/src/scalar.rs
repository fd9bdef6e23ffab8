//! The arithmetic the model runs in.

pub(crate) mod fixed;
pub(crate) mod float;
mod series;

use crate::checksum::Summed;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

pub(crate) mod sealed {
    /// Keeps [`Scalar`](super::Scalar) to the types whose accuracy is tested here.
    pub trait Sealed {}
}

/// A number the model can be computed in: `f32` with a floating-point unit, [`Fixed`](crate::Fixed)
/// without one, `f64` for comparison.
///
/// The same source, compiled for any machine, gives the same bits: there is no contraction of
/// `a * b + c`, and the kernels are portable code.
///
/// The equations are written once, over this trait. Sums and products saturate in fixed point; where
/// it would lose what is small, they use an operation that says so: [`scaled`](Scalar::scaled) by a constant
/// of any magnitude, [`Slow`](Scalar::Slow) for what a lag moves, [`ratio`](Scalar::ratio).
///
/// Kernels, and all that is called once a tick, are inlined: a call of a kernel costs a frame, and keeps
/// what is in registers from staying there.
pub trait Scalar:
    sealed::Sealed
    + Summed
    + Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// A word of a saved state.
    type Bits: Copy + Debug + Eq + From<u32> + Into<u64> + Summed;
    /// A constant to multiply with, of any magnitude.
    type Factor: Copy + Debug + Summed;
    /// A value that a lag moves, by less in a tick than the number itself may resolve.
    type Slow: Copy + Debug + PartialEq;
    /// A share, 0..1, of the way that a lag has still to go.
    type Share: Copy + Debug + Summed;
    /// A musculotendon path length: m in floating point, µm in fixed point.
    type PathLength: Copy + Debug + PartialEq + PartialOrd + Summed;
    /// What firmware sets or measures, in a unit of its own: a stimulation frequency in pps, a pulse's
    /// amplitude in mA, its width in µs.
    type Quantity: Copy + Debug + PartialEq + PartialOrd + Summed;
    /// A tendon force: N in floating point, mN in fixed point.
    type Force: Copy + Debug + PartialEq + PartialOrd + Summed;

    /// Tells arithmetics apart in a saved state.
    #[doc(hidden)]
    const ARITHMETIC: u32;
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 1/2.
    const HALF: Self;
    /// A value that is positive, and as small as makes no difference to any equation.
    const LEAST: Self;
    /// No larger coefficient can be held.
    const LARGEST_COEFFICIENT: f64;
    /// The least and the greatest maximal isometric force that outputs can resolve and hold, N.
    const MAXIMAL_FORCES: (f64, f64);
    /// The step that forces are told in, N.
    const FORCE_STEP: f64;
    /// The longest path that can be held, m.
    const LONGEST_PATH: f64;
    /// Words of a [`Slow`](Scalar::Slow) in a saved state.
    const SLOW_WORDS: usize;

    /// The nearest value. Used when a muscle is built, never in a tick.
    fn from_f64(value: f64) -> Self;
    /// The value, exactly.
    fn to_f64(self) -> f64;
    /// The word that [`from_bits`](Scalar::from_bits) turns into the same value.
    fn to_bits(self) -> Self::Bits;
    /// The value saved as `bits`.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Neither infinite nor not-a-number.
    fn is_finite(self) -> bool;
    /// The greatest value there is, at which fixed point saturates; infinity in floating point.
    fn is_saturated(self) -> bool;

    /// The factor nearest to a constant. Used when a muscle is built.
    fn factor(value: f64) -> Self::Factor;
    /// Times a constant; saturated where that is out of range.
    #[must_use]
    fn scaled(self, factor: &Self::Factor) -> Self;
    /// Divided by a positive number; saturated where that is out of range.
    #[must_use]
    fn ratio(self, divisor: Self) -> Self;

    /// Half of it; in fixed point the next lower number of what is not exact.
    #[must_use]
    fn half(self) -> Self;
    /// A polynomial of `self`, from -1 to 1, and its slope: terms by powers, the constant first. Neither the
    /// sum of their magnitudes, nor that of the slope's, is more than 100.
    fn polynomial<const N: usize>(self, terms: &[Self; N]) -> (Self, Self);
    /// 1 divided by a positive number; saturated where that is out of range.
    #[must_use]
    fn reciprocal(self) -> Self;
    /// 1 divided by a positive number, as a factor: what is divided by the same number shares it.
    fn reciprocal_factor(self) -> Self::Factor;

    /// e to the power of `self`, which is 80 at most; 0 far below, never an error.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number; of 0, that of about the least there is.
    #[must_use]
    fn ln(self) -> Self;
    /// `ln(exp(self) + 1)` and its slope, the logistic function of `self`, 0..1.
    fn softplus(self) -> (Self, Self);
    /// `1 - exp(-exp(self))`, Weibull's distribution as a function of the logarithm, and its slope.
    fn weibull(self) -> (Self, Self);
    /// `1/(1 + factor self)`, whose denominator is positive.
    #[must_use]
    fn of_one_and(self, factor: Self) -> Self;
    /// Where a straight line and a hyperbola make up for `self`: the root u of
    /// `self` + `line` u + h(u) = 0, and h(u)/(`steepness` u), the secant's share of the steepness.
    ///
    /// h(u) = `steepness` u/(1 + bend u) has half the curvature `half_curvature` at 0, and the root
    /// is the one that its branch through 0 has. `line` and `steepness` are positive.
    fn hyperbola_root(self, line: Self, steepness: Self, half_curvature: Self) -> (Self, Self);

    /// A slow value that is now `self`.
    fn slow(self) -> Self::Slow;
    /// What a slow value is now.
    fn of(slow: Self::Slow) -> Self;
    /// A slow value moved by `difference` times `share`.
    fn moved(slow: Self::Slow, difference: Self, share: Self::Share) -> Self::Slow;
    /// A slow value moved by the sum of two differences times their shares.
    fn moved_by_two(
        slow: Self::Slow,
        first: (Self, Self::Share),
        second: (Self, Self::Share),
    ) -> Self::Slow;
    /// The share nearest to a constant, 0..1. Used when a muscle is built.
    fn share(value: f64) -> Self::Share;
    /// What a lag, `self` time constants long, has done: 1 - exp(-`self`).
    fn done(self) -> Self::Share;
    /// What two lags in a row, each x = `self` time constants long, 2.5 at most, have done after half of
    /// that and after all of it.
    fn lags(self) -> [Lags<Self::Share>; 2];
    /// The words of a slow value.
    fn slow_words(slow: Self::Slow) -> impl Iterator<Item = Self::Bits>;
    /// The slow value whose words come next; none if there are too few.
    fn slow_from_words(words: &mut impl Iterator<Item = Self::Bits>) -> Option<Self::Slow>;

    /// The path length nearest to one in m. Not used in a tick.
    fn path_length(metres: f64) -> Self::PathLength;
    /// A path length in m, exactly or as nearly as `f64` has it.
    fn path_metres(path: Self::PathLength) -> f64;
    /// Neither infinite nor not-a-number.
    fn path_is_finite(path: Self::PathLength) -> bool;
    /// The factor that turns path lengths into numbers: `value` per m.
    fn per_metre(value: f64) -> Self::Factor;
    /// How much longer `path` is than `other`, times a factor per m.
    fn path_difference(
        path: Self::PathLength,
        other: Self::PathLength,
        per_metre: &Self::Factor,
    ) -> Self;
    /// The word of a path length.
    fn path_bits(path: Self::PathLength) -> Self::Bits;
    /// The path length whose word is `bits`.
    fn path_from_bits(bits: Self::Bits) -> Self::PathLength;

    /// The quantity nearest to one in its unit. Not used in a tick.
    fn quantity(value: f64) -> Self::Quantity;
    /// A quantity in its unit, exactly.
    fn quantity_value(quantity: Self::Quantity) -> f64;
    /// Neither infinite nor not-a-number.
    fn quantity_is_finite(quantity: Self::Quantity) -> bool;
    /// The factor that turns quantities into numbers: `value` per unit.
    fn per_quantity(value: f64) -> Self::Factor;
    /// A quantity times a factor per unit.
    fn of_quantity(quantity: Self::Quantity, per_unit: &Self::Factor) -> Self;
    /// The factor that turns numbers into quantities: so many units for 1.
    fn quantity_factor(value: f64) -> Self::Factor;
    /// A number times a factor as a quantity; saturated.
    fn as_quantity(self, quantity_factor: &Self::Factor) -> Self::Quantity;

    /// The factor that turns forces relative to F0 (N) into forces.
    fn force_factor(newtons: f64) -> Self::Factor;
    /// A force relative to F0 as a force.
    fn force(self, force_factor: &Self::Factor) -> Self::Force;
    /// The factor that turns forces into numbers: `value` per N.
    fn per_newton(value: f64) -> Self::Factor;
    /// A force times a factor per N.
    fn of_force(force: Self::Force, per_newton: &Self::Factor) -> Self;
    /// A force times a share, 0..1, of it.
    fn of_share(self, force: Self::Force) -> Self::Force;
    /// The word of a force.
    fn force_bits(force: Self::Force) -> Self::Bits;
    /// A force in N, exactly or as nearly as `f64` has it.
    fn newtons(force: Self::Force) -> f64;
    /// The same of a muscle whose F0 is `newtons`, by that of `force` and `relative_force` which is finer.
    fn newtons_of(force: Self::Force, relative_force: Self, newtons: f64) -> f64;

    /// The smaller of two ordered values; `other` where `self` is not-a-number.
    #[must_use]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger of two ordered values; `other` where `self` is not-a-number.
    #[must_use]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The distance from 0.
    #[must_use]
    fn abs(self) -> Self {
        if self < Self::ZERO { -self } else { self }
    }
}

/// What two lags in a row have done, each x time constants long.
#[derive(Clone, Copy, Debug)]
pub struct Lags<T> {
    /// 1 - exp(-x): how far either has come towards its target.
    pub done: T,
    /// x exp(-x): what the second still misses of the way because the first was behind.
    pub delayed: T,
}
