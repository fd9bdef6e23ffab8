//! Quotients and reciprocals without a division: products with the reciprocal of a mantissa.

use super::factor::Factor;
use super::mantissa::{self, word};
use super::number::{FRACTION, Fixed, exact};
use core::array::from_fn;

/// Reciprocal of a positive denominator as a factor. The factor times a numerator in the same
/// format is the quotient in Q8.24; its error is below 1 ULP plus 2^-28 of its value. Denominators
/// below 1 ULP are clamped to 1 ULP.
///
/// # Scaling and overflow
/// Shifted left by z bits, 1 to 31, until its first bit is set, the denominator is a mantissa in
/// Q1.31. The reciprocal of the mantissa, clamped to 2^31 - 1, is 2^(38 - z) times the factor. This
/// shift is 7 to 37 bits.
pub(super) fn reciprocal_factor(denominator: Fixed) -> Factor {
    let denominator = denominator.to_bits().max(1) as u32;
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
pub(super) fn reciprocal(x: Fixed) -> Fixed {
    const LEAST: i32 = 1 << (FRACTION - 7);
    let x = x.to_bits().max(LEAST) as u32;
    let zeros = x.leading_zeros();
    scaled_back(mantissa::reciprocal(x << zeros), 14 - zeros)
}

/// The reciprocal of a mantissa in Q1.31, at most 2^31, shifted right by up to 22 bits, rounded and
/// clamped to 2^31 - 1.
#[inline(always)]
fn scaled_back(reciprocal: u32, shift: u32) -> Fixed {
    let bits = ((reciprocal + (1 << shift >> 1)) >> shift).min(i32::MAX as u32);
    Fixed::from_bits(bits as i32)
}

/// 1/(1 + d v) in Q8.24 for each d; the error is below 2^-24 plus 2^-28 of the value. 1 + d v is
/// clamped to at least 2^-7, within 2^-16.
///
/// # Scaling and overflow
/// d v is Q16.48 and at most 2^62. The high word of 1 + d v is Q16.16 and at least 2^9. Shifted
/// left by z bits, 1 to 22, the sum is a mantissa; the reciprocal of that in Q1.31, shifted right
/// by 22 - z bits, is Q8.24. At 2^-7 it would be 128 and is clamped to one unit below.
#[inline(always)]
pub(super) fn reciprocals_of_one_plus<const N: usize>(d: [Fixed; N], v: Fixed) -> [Fixed; N] {
    const ONE: i32 = 1 << 16;
    let (mut mantissas, mut zeros) = ([0; N], [0; N]);
    for index in 0..N {
        let (high, low) = exact(d[index].to_bits(), v.to_bits());
        let sum = ((high + ONE).max(ONE >> 7), low);
        zeros[index] = sum.0.leading_zeros();
        mantissas[index] = word(sum, zeros[index]) as u32;
    }
    let found = mantissa::reciprocals(mantissas);
    let mut reciprocals = [Fixed::from_bits(0); N];
    for index in 0..N {
        reciprocals[index] = scaled_back(found[index], 22 - zeros[index]);
    }
    reciprocals
}
