//! The fixed-point number itself: Q8.24 that saturates.

use super::kernels::product;
use core::ops::{Add, Mul, Neg, Sub};
use fixed::types::I8F24;

/// The number that the model is computed in where there is no floating-point unit: Q8.24, from
/// -128 to 128 in steps of 6e-8, as fine as `f32` is at 1. Its sums and products saturate: nothing
/// wraps around.
///
/// It is an [`I8F24`], and comes from and turns into one. That type's own saturating product cuts
/// off, and is inlined wherever it stands; the one here rounds, and is called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fixed(I8F24);

impl Fixed {
    /// The number whose bits are given, in units of 2^-24.
    pub const fn from_bits(bits: i32) -> Self {
        Self(I8F24::from_bits(bits))
    }

    /// Its bits, in units of 2^-24.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }
}

impl From<I8F24> for Fixed {
    fn from(number: I8F24) -> Self {
        Self(number)
    }
}

impl From<Fixed> for I8F24 {
    fn from(number: Fixed) -> Self {
        number.0
    }
}

impl Add for Fixed {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Fixed {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Fixed {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

impl Mul for Fixed {
    type Output = Self;
    // Called, not inlined: there are so many places that the code would be half as long again.
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        Self::from_bits(product(self.to_bits(), other.to_bits()))
    }
}
