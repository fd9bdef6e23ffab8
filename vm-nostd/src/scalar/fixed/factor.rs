//! Constant factors of any magnitude.

use super::number::{FRACTION, Fixed, exact, saturating_shift};
use crate::summed::summed;
use fixed::types::I16F16;

/// Units of a number in Q8.24.
pub(super) const UNITS: f64 = (1 << FRACTION) as f64;
/// Units of a quantity in Q16.16.
pub(super) const QUANTITY_UNITS: f64 = (1 << 16) as f64;

summed! {
    /// A constant factor of any magnitude, mantissa × 2^-shift, between numbers as integer
    /// multiples of their ULP ("units").
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Factor {
        mantissa: i32,
        /// 1 to 62.
        shift: u8,
    }

    valid: |factor| (1..=LARGEST_SHIFT).contains(&factor.shift)
}

/// Largest shift of a factor.
const LARGEST_SHIFT: u8 = 62;

impl Factor {
    /// The nearest factor. The mantissa has 31 bits for factors of at least 2^-32, fewer below.
    pub(super) fn new(value: f64) -> Self {
        const TWO_30: f64 = (1 << 30) as f64;
        let (mut mantissa, mut shift) = (value * TWO_30 * 2.0, 31);
        while mantissa.abs() >= 2.0 * TWO_30 && shift > 1 {
            mantissa *= 0.5;
            shift -= 1;
        }
        while mantissa.abs() < TWO_30 && shift < LARGEST_SHIFT {
            mantissa *= 2.0;
            shift += 1;
        }
        Self { mantissa: nearest(mantissa), shift }
    }

    #[cfg(test)]
    pub(crate) fn value(&self) -> f64 {
        f64::from(self.mantissa) * 2_f64.powi(-i32::from(self.shift))
    }

    /// The factor mantissa × 2^-shift; `shift` is 1 to 62.
    #[inline(always)]
    pub(super) fn scaled_down(mantissa: i32, shift: u32) -> Self {
        Self { mantissa, shift: shift as u8 }
    }

    /// Units times the factor, saturated. The error is below 0.51 units plus 2^-31 of the product
    /// (for factors below 2^-32: plus half the last bit of the mantissa). It rounds to nearest,
    /// because truncated lengths would make the fascicles drift.
    ///
    /// # Scaling and overflow
    /// If the shift is above 32, the low word of the product is shifted out. The high word is at
    /// most 2^30, so that adding half a unit does not overflow.
    #[inline(always)]
    pub(super) fn times(self, units: i32) -> i32 {
        let product = exact(units, self.mantissa);
        match u32::from(self.shift) {
            shift @ 33.. => ((product.0 >> (shift - 33)) + 1) >> 1,
            shift => saturating_shift(product, shift)
                .saturating_add((product.1 >> (shift - 1) & 1) as i32),
        }
    }
}

/// Nearest integer, saturated.
pub(super) const fn nearest(value: f64) -> i32 {
    // Adding a half and truncating rounds positive values; `as` saturates.
    (if value < 0.0 { value - 0.5 } else { value + 0.5 }) as i32
}

/// The nearest number, saturated.
pub(crate) const fn nearest_number(value: f64) -> Fixed {
    Fixed::from_bits(nearest(value * UNITS))
}

/// The nearest quantity, saturated.
pub(crate) const fn nearest_quantity(value: f64) -> I16F16 {
    I16F16::from_bits(nearest(value * QUANTITY_UNITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_of_any_magnitude_round_to_nearest() {
        for exponent in -40..=29 {
            for mantissa in [1.0, -1.0, 1.234_567_890_123, -1.999_999_999_999] {
                let value = mantissa * 2_f64.powi(exponent);
                let factor = Factor::new(value);
                for units in [0, 1, -1, 12_345, -7_654_321, 1 << 24, i32::MAX, i32::MIN] {
                    let exact = f64::from(units) * value;
                    let expected = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
                    let error = (f64::from(factor.times(units)) - expected).abs();
                    // Half the last bit of the mantissa, which has 31 bits down to 2^-32.
                    let relative = 2_f64.powi(-31).max(2_f64.powi(-63 - exponent));
                    let bound = 0.51 + expected.abs() * relative;
                    assert!(error <= bound, "{units} x {value:e}: {error} > {bound}");
                }
            }
        }
    }
}
