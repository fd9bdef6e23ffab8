//! Basic arithmetic: constants, signs, comparison.

use super::constant::Constant;

/// Basic arithmetic beyond the operators.
pub(crate) trait Arithmetic: Copy + PartialOrd {
    /// 1/2.
    const HALF: Self;
    /// A positive value that is negligible in every equation.
    const LEAST: Self;
    /// Whether each operation of a tick is done for all fibre types before the next one, which
    /// hides latencies. With few registers it is faster to process one type after the other.
    const SIDE_BY_SIDE: bool;

    /// A constant of the model.
    fn constant(constant: &Constant) -> Self;
    /// Whether it is finite.
    fn is_finite(self) -> bool;
    /// Whether it is the largest value: the limit of saturation in fixed point, infinity in
    /// floating point.
    fn is_saturated(self) -> bool;

    /// Product, like `*`; fixed point rounds to nearest, for sums over many substeps.
    #[must_use]
    fn times(self, other: Self) -> Self;
    /// Half of `self`; fixed point rounds toward minus infinity.
    #[must_use]
    fn half(self) -> Self;

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

    /// Absolute value; saturates.
    #[must_use]
    fn abs(self) -> Self;
}
