//! Factors from 0 to 1: a product takes one instruction (SMMUL) and a shift, and cannot overflow.

use super::number::{FRACTION, Fixed, ONE, high};

/// A number from 0 to 1 in Q1.31. 1 would be 2^31 and is clamped below it.
#[derive(Clone, Copy, Debug)]
pub struct Unit(i32);

impl Unit {
    /// A number in Q8.24, clamped to 0 and 1 - 1 ULP.
    #[inline(always)]
    pub(super) fn new(number: Fixed) -> Self {
        Self(number.to_bits().clamp(0, ONE - 1) << (31 - FRACTION))
    }

    /// The number `bits` in Q1.31.
    #[inline(always)]
    pub(super) fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    #[cfg(test)]
    pub(crate) fn to_bits(self) -> i32 {
        self.0
    }

    /// Product with a number in any format, rounded toward minus infinity to a multiple of two
    /// units.
    #[inline(always)]
    pub(super) fn of(self, number: i32) -> i32 {
        high(number, self.0) << 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_with_units_are_within_two_units_and_an_ulp() {
        for unit in [-ONE, -1, 0, 1, 12_345, ONE / 2, ONE - 1, ONE, 2 * ONE, i32::MAX] {
            let exact = f64::from(unit.clamp(0, ONE)) / f64::from(ONE);
            for number in [0, 1, -1, 12_345, -7_654_321, 1 << 24, i32::MAX, i32::MIN] {
                let error = exact * f64::from(number)
                    - f64::from(Unit::new(Fixed::from_bits(unit)).of(number));
                let ulp = f64::from(number).abs() / f64::from(ONE);
                assert!((-ulp..2.0 + ulp).contains(&error), "{unit} {number}: {error}");
            }
        }
    }
}
