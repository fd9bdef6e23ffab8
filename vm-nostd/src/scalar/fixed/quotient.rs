//! Quotients as products with a reciprocal, without a division.

use super::factor::Factor;
use super::mantissa;
use super::number::{FRACTION, exact};
use core::array::from_fn;

/// Reciprocal of a positive denominator, for quotients in Q8.24 of numbers in one format; quotients
/// are within 2^-28 of their value and 1 ULP. A denominator below an ULP counts as one.
///
/// # Scaling and overflow
/// The denominator, shifted left by z bits, 1 to 31, until its first bit is set, is a mantissa in
/// Q1.31; its reciprocal there, at most 2^31 and here a unit less, is 2^(38 - z) times what the
/// numerator has to be multiplied with. That shift is 7 to 37 bits.
pub(super) fn reciprocal_factor(denominator: i32) -> Factor {
    let denominator = denominator.max(1) as u32;
    let zeros = denominator.leading_zeros();
    let reciprocal = mantissa::reciprocal(denominator << zeros).min(i32::MAX as u32);
    Factor::scaled_down(reciprocal as i32, 38 - zeros)
}

/// Reciprocals of two positive numbers as factors: 2^62 over the number, shifted right by `shifts`
/// less the number of its zeros before the first bit. Within 2^-28 of their value.
///
/// # Scaling and overflow
/// Shifted left until their first bit is set, both are mantissas in Q1.31, and so are their
/// reciprocals, of which 2^31 is a unit less.
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

/// 1/x in Q8.24 of a positive number, saturated; within 2^-28 of its value and 1 unit. For 0 and
/// below it is the greatest number.
///
/// # Scaling and overflow
/// x, 2^-7 at least, where 1/x is 2^7 and saturates, and shifted left by z bits, up to 14, until
/// its first bit is set, is a mantissa; its reciprocal in Q1.31, shifted right by 14 - z bits, is
/// Q8.24.
pub(super) fn reciprocal(x: i32) -> i32 {
    const LEAST: i32 = 1 << (FRACTION - 7);
    let x = x.max(LEAST) as u32;
    let zeros = x.leading_zeros();
    scaled_back(mantissa::reciprocal(x << zeros), 14 - zeros)
}

/// A mantissa's reciprocal in Q1.31, at most 2^31, shifted right by up to 22 bits, rounded; 2^31,
/// not shifted, becomes a unit less.
#[inline(always)]
fn scaled_back(reciprocal: u32, shift: u32) -> i32 {
    ((reciprocal + (1 << shift >> 1)) >> shift).min(i32::MAX as u32) as i32
}

/// Two words as one, shifted left by at most 31 bits.
#[inline(always)]
pub(super) fn word((high, low): (i32, u32), left: u32) -> i32 {
    (high << left) | (low >> 1 >> (31 - left)) as i32
}

/// 1/(1 + d v) in Q8.24 of each d, within 2^-24 and 2^-28 of its value; 1 + d v below 2^-7 counts
/// as that, to 2^-16.
///
/// # Scaling and overflow
/// d v is Q16.48 and at most 2^62; of the sum, the high word is Q16.16 and 2^9 at least.
/// Shifted left by z bits, 1 to 22, it is a mantissa; its reciprocal in Q1.31, shifted right by
/// 22 - z bits, is Q8.24. At 2^-7 it would be 128 and is a unit less.
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
    use super::super::every::{UNIT, of_any_length};
    use super::*;

    /// How far a number is from one that saturates, as a share of 1 unit and 2^-28 of it.
    fn of_the_bound(found: i32, exact: f64) -> f64 {
        let saturated = (exact * UNIT).clamp(f64::from(-i32::MAX), f64::from(i32::MAX));
        (f64::from(found) - saturated).abs() / (1.0 + saturated.abs() * 2_f64.powi(-28))
    }

    #[test]
    fn reciprocals_are_within_an_ulp_or_saturate() {
        for x in (-10..1_000_000).chain(of_any_length().take(1_000_000)) {
            let found = of_the_bound(reciprocal(x), UNIT / f64::from(x.max(1)));
            assert!(found <= 1.0, "1/{x}: {found} of the bound");
        }
    }

    fn ratio(numerator: i32, denominator: i32) -> i32 {
        reciprocal_factor(denominator).times(numerator)
    }

    #[test]
    fn ratios_are_within_an_ulp_or_saturate() {
        let edges = [0, 1, -1, 7, 1 << 24, i32::MAX, i32::MIN, i32::MAX - 1, 1 << 30, 1 << 17];
        let numbers = || edges.into_iter().chain(of_any_length());
        for n in numbers().take(2_000) {
            for d in numbers().skip(1).take(2_000).filter(|d| *d > 0) {
                let found = of_the_bound(ratio(n, d), f64::from(n) / f64::from(d));
                assert!(found <= 1.0, "{n}/{d}: {found} of the bound");
            }
        }
        assert_eq!(ratio(7, 0), 7 << 24);
    }

    #[test]
    fn reciprocals_of_one_plus_a_product_are_within_their_bound() {
        let numbers = || [0, 1, -1, i32::MAX, i32::MIN].into_iter().chain(of_any_length());
        for d in numbers().take(2_000) {
            for v in numbers().take(2_000) {
                let sum = 1.0 + f64::from(d) / UNIT * (f64::from(v) / UNIT);
                let exact = 1.0 / sum.max(2_f64.powi(-7));
                let [found, _] =
                    reciprocals_of_one_plus([d, v], v).map(|bits| f64::from(bits) / UNIT);
                // The least sum is told from its high word: by 2^-16 at most.
                let least =
                    if sum < 2_f64.powi(-7) { exact * exact * 2_f64.powi(-16) } else { 0.0 };
                let bound = 2_f64.powi(-24) * (1.0 + exact / 16.0) + least;
                assert!((found - exact).abs() <= bound, "{d} {v}: {found} {exact}");
            }
        }
    }
}
