//! The arithmetic the model runs in.

mod float;

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

pub(crate) mod sealed {
    /// Keeps [`Scalar`](super::Scalar) to the types whose accuracy is tested here.
    pub trait Sealed {}
}

/// A number the model can be computed in: `f32` on the target, `f64` for comparison.
///
/// The same source, compiled for any machine, gives the same bits: there is no contraction of
/// `a * b + c`, and the kernels are portable code.
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The word a value is saved in.
    type Bits: Copy + Debug + Eq + Into<u64>;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

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
    /// e to the power of `self`; 0 far below, never an error.
    fn exp(self) -> Self;
    /// e to the power of `self`, less 1, accurate near 0.
    fn exp_m1(self) -> Self;
    /// Natural logarithm of a positive number.
    fn ln(self) -> Self;
    /// Natural logarithm of 1 more than `self`, accurate near 0.
    fn ln_1p(self) -> Self;

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
