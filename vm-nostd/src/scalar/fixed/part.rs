//! Factors from -1/2 to 1/2: a product takes one instruction (SMMUL) and cannot overflow.

use super::factor::nearest;
use super::number::high;
use super::product;
use crate::summed::summed_numbers;
use core::ops::Add;

/// A number from -1/2 to 1/2 in Q0.32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part(i32);

summed_numbers! {
    Part: |part| part.0.cast_unsigned(), |word| Some(Self(word.cast_signed()));
}

impl Part {
    pub(super) const MINUS_HALF: Self = Self(i32::MIN);

    /// The nearest number. 1/2 would be 2^31 and is clamped to 2^31 - 1.
    pub(crate) const fn new(value: f64) -> Self {
        Self(nearest(value * 4_294_967_296.0))
    }

    /// Product with a number in any format, rounded toward minus infinity.
    #[inline(always)]
    pub(super) fn of(self, number: i32) -> i32 {
        high(number, self.0)
    }

    /// Product with a number in any format, with 32 more fractional bits; at most 2^62.
    #[inline(always)]
    pub(super) fn exactly_of(self, number: i32) -> i64 {
        product::signed(number, self.0)
    }

    /// Product with a number in any format, rounded to nearest.
    ///
    /// # Scaling and overflow
    /// The product is at most 2^62: adding half a unit of its high word does not overflow.
    #[inline(always)]
    pub(super) fn rounded_of(self, number: i32) -> i32 {
        ((self.exactly_of(number) + (1 << 31)) >> 32) as i32
    }
}

impl Add for Part {
    type Output = Self;
    /// A sum of 1/2 wraps around. It occurs only for the time at the end of a tick, which is not
    /// used.
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_with_parts_are_within_a_unit() {
        for value in [-0.5, -0.3, -1e-9, 0.0, 1e-3, 0.125, 0.499_999, 0.5] {
            let part = Part::new(value);
            for number in [0, 1, -1, 12_345, -7_654_321, 1 << 24, i32::MAX, i32::MIN] {
                let exact = f64::from(number) * value;
                let error = exact - f64::from(part.of(number));
                assert!((-0.5..1.5).contains(&error), "{number} x {value}: {error}");
                let error = exact - f64::from(part.rounded_of(number));
                assert!(error.abs() <= 1.0, "{number} x {value}: {error}");
            }
        }
    }
}
