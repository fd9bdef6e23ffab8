//! Arithmetic of the port: single or double precision, with libm's functions.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number nearest to a constant.
    fn of(constant: f64) -> Self;
    /// e^x.
    fn exp(self) -> Self;
    /// ln x.
    fn ln(self) -> Self;
    /// x^y.
    fn pow(self, exponent: Self) -> Self;
    /// |x|.
    fn abs(self) -> Self;
}

impl Real for f32 {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        constant as f32
    }
    fn exp(self) -> Self {
        libm::expf(self)
    }
    fn ln(self) -> Self {
        libm::logf(self)
    }
    fn pow(self, exponent: Self) -> Self {
        libm::powf(self, exponent)
    }
    fn abs(self) -> Self {
        libm::fabsf(self)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn of(constant: f64) -> Self {
        constant
    }
    fn exp(self) -> Self {
        libm::exp(self)
    }
    fn ln(self) -> Self {
        libm::log(self)
    }
    fn pow(self, exponent: Self) -> Self {
        libm::pow(self, exponent)
    }
    fn abs(self) -> Self {
        libm::fabs(self)
    }
}
