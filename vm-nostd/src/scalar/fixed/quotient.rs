//! Quotients and reciprocals without a division: products with the reciprocal of a mantissa.

use super::factor::Factor;
use super::mantissa;
use super::number::{FRACTION, exact};
use core::array::from_fn;

/// Reciprocal of a positive denominator as a factor. The factor times a numerator in the same
/// format is the quotient in Q8.24; its error is below 1 ULP plus 2^-28 of its value. Denominators
/// below 1 ULP are clamped to 1 ULP.
///
/// # Scaling and overflow
/// Shifted left by z bits, 1 to 31, until its first bit is set, the denominator is a mantissa in
/// Q1.31. The reciprocal of the mantissa, clamped to 2^31 - 1, is 2^(38 - z) times the factor. This
/// shift is 7 to 37 bits.
pub(super) fn reciprocal_factor(denominator: i32) -> Factor {
    let denominator = denominator.max(1) as u32;
    let zeros = denominator.leading_zeros();
    let reciprocal = mantissa::reciprocal(denominator << zeros).min(i32::MAX as u32);
    Factor::scaled_down(reciprocal as i32, 38 - zeros)
}

/// Reciprocals of two positive numbers as factors: 2^(62 - shift) over the number, with its shift
/// from `shifts`. The relative error is below 2^-28.
///
/// # Scaling and overflow
/// Shifted left until their first bit is set, both numbers are mantissas in Q1.31. The reciprocals
/// of these are clamped to 2^31 - 1.
#[inline(always)]
pub(super) fn reciprocal_factors(numbers: [i32; 2], shifts: [u32; 2]) -> [Factor; 2] {
    let zeros = numbers.map(|number| number.leading_zeros());
    let [a, b] = [numbers[0] << zeros[0], numbers[1] << zeros[1]].map(i32::cast_unsigned);
    let reciprocals = mantissa::reciprocals([a, b]);
    from_fn(|index| {
        let mantissa = reciprocals[index].min(i32::MAX as u32);
        Factor::scaled_down(mantissa as i32, shifts[index] - zeros[index])
    })
}

/// 1/x in Q8.24 of a positive number, saturated; the error is below 1 unit plus 2^-28 of the value.
/// For 0 and negative numbers it is the largest number.
///
/// # Scaling and overflow
/// x is clamped to at least 2^-7, where 1/x is 2^7 and saturates. Shifted left by z bits, up to 14,
/// until its first bit is set, it is a mantissa; the reciprocal of that in Q1.31, shifted right by
/// 14 - z bits, is Q8.24.
pub(super) fn reciprocal(x: i32) -> i32 {
    const LEAST: i32 = 1 << (FRACTION - 7);
    let x = x.max(LEAST) as u32;
    let zeros = x.leading_zeros();
    scaled_back(mantissa::reciprocal(x << zeros), 14 - zeros)
}

/// The reciprocal of a mantissa in Q1.31, at most 2^31, shifted right by up to 22 bits, rounded and
/// clamped to 2^31 - 1.
#[inline(always)]
fn scaled_back(reciprocal: u32, shift: u32) -> i32 {
    ((reciprocal + (1 << shift >> 1)) >> shift).min(i32::MAX as u32) as i32
}

/// High word of two words shifted left by at most 31 bits.
#[inline(always)]
pub(super) fn word((high, low): (i32, u32), left: u32) -> i32 {
    (high << left) | (low >> 1 >> (31 - left)) as i32
}

/// 1/(1 + d v) in Q8.24 for each d; the error is below 2^-24 plus 2^-28 of the value. 1 + d v is
/// clamped to at least 2^-7, within 2^-16.
///
/// # Scaling and overflow
/// d v is Q16.48 and at most 2^62. The high word of 1 + d v is Q16.16 and at least 2^9. Shifted
/// left by z bits, 1 to 22, the sum is a mantissa; the reciprocal of that in Q1.31, shifted right
/// by 22 - z bits, is Q8.24. At 2^-7 it would be 128 and is clamped to one unit below.
#[inline(always)]
pub(super) fn reciprocals_of_one_plus<const N: usize>(d: [i32; N], v: i32) -> [i32; N] {
    const ONE: i32 = 1 << 16;
    let (mut mantissas, mut zeros) = ([0; N], [0; N]);
    for index in 0..N {
        let (high, low) = exact(d[index], v);
        let sum = ((high + ONE).max(ONE >> 7), low);
        zeros[index] = sum.0.leading_zeros();
        mantissas[index] = word(sum, zeros[index]) as u32;
    }
    let found = mantissa::reciprocals(mantissas);
    let mut reciprocals = [0; N];
    for index in 0..N {
        reciprocals[index] = scaled_back(found[index], 22 - zeros[index]);
    }
    reciprocals
}

#[cfg(test)]
mod tests {
    use super::super::exhaustive::{UNIT, random_numbers};
    use super::*;

    /// Error of a number, relative to the bound of 1 unit plus 2^-28 of the exact, saturated value.
    fn relative_to_bound(found: i32, exact: f64) -> f64 {
        let saturated = (exact * UNIT).clamp(f64::from(-i32::MAX), f64::from(i32::MAX));
        (f64::from(found) - saturated).abs() / (1.0 + saturated.abs() * 2_f64.powi(-28))
    }

    #[test]
    fn reciprocals_are_within_an_ulp_or_saturate() {
        for x in (-10..1_000_000).chain(random_numbers().take(1_000_000)) {
            let found = relative_to_bound(reciprocal(x), UNIT / f64::from(x.max(1)));
            assert!(found <= 1.0, "1/{x}: {found} of the bound");
        }
    }

    fn ratio(numerator: i32, denominator: i32) -> i32 {
        reciprocal_factor(denominator).times(numerator)
    }

    #[test]
    fn ratios_are_within_an_ulp_or_saturate() {
        let edges = [0, 1, -1, 7, 1 << 24, i32::MAX, i32::MIN, i32::MAX - 1, 1 << 30, 1 << 17];
        let numbers = || edges.into_iter().chain(random_numbers());
        for n in numbers().take(2_000) {
            for d in numbers().skip(1).take(2_000).filter(|d| *d > 0) {
                let found = relative_to_bound(ratio(n, d), f64::from(n) / f64::from(d));
                assert!(found <= 1.0, "{n}/{d}: {found} of the bound");
            }
        }
        assert_eq!(ratio(7, 0), 7 << 24);
    }

    #[test]
    fn reciprocals_of_one_plus_a_product_are_within_their_bound() {
        let numbers = || [0, 1, -1, i32::MAX, i32::MIN].into_iter().chain(random_numbers());
        for d in numbers().take(2_000) {
            for v in numbers().take(2_000) {
                let sum = 1.0 + f64::from(d) / UNIT * (f64::from(v) / UNIT);
                let exact = 1.0 / sum.max(2_f64.powi(-7));
                let [found, _] =
                    reciprocals_of_one_plus([d, v], v).map(|bits| f64::from(bits) / UNIT);
                // Only the high word of the sum is clamped: an error of up to 2^-16.
                let least =
                    if sum < 2_f64.powi(-7) { exact * exact * 2_f64.powi(-16) } else { 0.0 };
                let bound = 2_f64.powi(-24) * (1.0 + exact / 16.0) + least;
                assert!((found - exact).abs() <= bound, "{d} {v}: {found} {exact}");
            }
        }
    }
}
