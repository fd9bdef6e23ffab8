//! Values with a unit: paths in Q23.9 µm, quantities in Q16.16, forces in whole mN.

use super::factor::{Factor, QUANTITY_UNITS, UNITS, nearest};
use super::number::Fixed;
use crate::scalar::constant::Constant;
use crate::scalar::{Conversions, MOST_PARTS};
use crate::summed::summed_numbers;
use fixed::types::{I16F16, I23F9};

/// Units of [`I23F9`] in a metre.
const PATH_UNITS: f64 = 512e6;

summed_numbers! {
    Fixed: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
    I16F16: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
    I23F9: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
}

/// The number, exactly.
pub(super) fn value(number: Fixed) -> f64 {
    f64::from(number.to_bits()) / UNITS
}

/// 2^32 over the number of parts of a way, rounded up, from 2 on.
const PER_PARTS: [i64; MOST_PARTS as usize - 1] = {
    let mut reciprocals = [0; MOST_PARTS as usize - 1];
    let mut index = 0;
    while index < reciprocals.len() {
        let parts = index as i64 + 2;
        reciprocals[index] = ((1 << 32) + parts - 1) / parts;
        index += 1;
    }
    reciprocals
};

/// The nearest path length to one in m, saturated.
pub(super) fn nearest_path(metres: f64) -> I23F9 {
    I23F9::from_bits(nearest(metres * PATH_UNITS))
}

/// A path length in m, exactly.
pub(super) fn metres(path: I23F9) -> f64 {
    f64::from(path.to_bits()) / PATH_UNITS
}

/// A quantity, exactly.
pub(super) fn quantity_value(quantity: I16F16) -> f64 {
    f64::from(quantity.to_bits()) / QUANTITY_UNITS
}

impl Conversions for Fixed {
    const ARITHMETIC: u32 = 3;
    const LARGEST_COEFFICIENT: f64 = 60.0;
    const MAXIMAL_FORCES: (f64, f64) = (1.0, 16e3);
    const FORCE_STEP: f64 = 1e-3;
    const LONGEST_PATH: f64 = 4.19;

    fn path_is_finite(_: I23F9) -> bool {
        true
    }
    fn per_metre(value: f64) -> Factor {
        Factor::new(value * UNITS / PATH_UNITS)
    }
    #[inline(always)]
    fn path_difference(path: I23F9, other: I23F9, per_metre: &Factor) -> Self {
        Self::from_bits(per_metre.times(path.saturating_sub(other).to_bits()))
    }
    #[inline(always)]
    fn path_change(path: I23F9, after: I23F9, other: I23F9, per_metre: &Factor) -> Self {
        // A change by itself would be rounded in every tick in the same direction.
        let position = |path| Self::path_difference(path, other, per_metre);
        position(after) - position(path)
    }
    fn path_towards(path: I23F9, end: I23F9, parts: u8) -> I23F9 {
        // Small cores have no division.
        let share = PER_PARTS.get(usize::from(parts).wrapping_sub(2)).copied().unwrap_or(1 << 32);
        let way = i64::from(end.saturating_sub(path).to_bits());
        path.saturating_add(I23F9::from_bits(((way * share) >> 32) as i32))
    }
    fn path_factor(metres: f64) -> Factor {
        Factor::new(metres * PATH_UNITS / UNITS)
    }
    fn lengthened(path: I23F9, by: Self, factor: &Factor) -> I23F9 {
        path.saturating_add(I23F9::from_bits(factor.times(by.to_bits())))
    }

    #[inline(always)]
    fn quantity_constant(constant: &Constant) -> I16F16 {
        constant.quantity
    }
    fn quantity_is_finite(_: I16F16) -> bool {
        true
    }
    fn per_quantity(value: f64) -> Factor {
        Factor::new(value * UNITS / QUANTITY_UNITS)
    }
    fn of_quantity(quantity: I16F16, per_unit: &Factor) -> Self {
        Self::from_bits(per_unit.times(quantity.to_bits()))
    }
    fn quantity_factor(value: f64) -> Factor {
        Factor::new(value * QUANTITY_UNITS / UNITS)
    }
    fn to_quantity(self, quantity_factor: &Factor) -> I16F16 {
        I16F16::from_bits(quantity_factor.times(self.to_bits()))
    }

    fn force_factor(newtons: f64) -> Factor {
        Factor::new(newtons * 1e3 / UNITS)
    }
    fn force(self, force_factor: &Factor) -> i32 {
        force_factor.times(self.to_bits())
    }
    fn per_newton(value: f64) -> Factor {
        Factor::new(value * UNITS * 1e-3)
    }
    fn of_force(force: i32, per_newton: &Factor) -> Self {
        Self::from_bits(per_newton.times(force))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_parts_of_a_way_are_equal() {
        for (parts, way) in (2..=MOST_PARTS).flat_map(|p| [1_000_003, -1_000_003].map(|w| (p, w))) {
            let [start, end] = [0, way].map(I23F9::from_bits);
            let mut path = start;
            for left in (2..=parts).rev() {
                path = Fixed::path_towards(path, end, left);
                let done = f64::from(parts - left + 1) / f64::from(parts);
                let error = f64::from(path.to_bits()) - done * f64::from(way);
                // Each part is rounded down; the rest of the way takes up what was lost.
                assert!(error.abs() < 3.0, "{parts} {way}: {error}");
            }
        }
    }

    #[test]
    fn changes_of_a_path_add_up_to_the_whole_one() {
        let per_metre = Fixed::per_metre(1.0 / 0.11);
        let (slack, start) = (nearest_path(0.02), nearest_path(0.1));
        let mut path = start;
        let mut sum = 0;
        for tick in 0..1000 {
            // 2 nm, 0.3 increments of length, and at times more.
            let after = path.saturating_add(I23F9::from_bits(1 + tick % 3));
            sum += Fixed::path_change(path, after, slack, &per_metre).to_bits();
            path = after;
        }
        let whole = Fixed::path_change(start, path, slack, &per_metre).to_bits();
        assert_eq!(sum, whole);
        assert!((f64::from(whole) - 1999.0 / 512e6 / 0.11 * UNITS).abs() < 1.0, "{whole}");
    }
}
