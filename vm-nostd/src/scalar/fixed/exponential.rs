//! Exponentials: 32-bit products, shifts and a table of powers of two.

use super::number::{Fixed, exact, high, square};
use super::share::Share;
use crate::scalar::series;

/// log2 e in Q2.30.
const LOG2_E: i32 = 1_549_082_005;
const POWER_BITS: u32 = 5;
const POWERS: usize = 1 << POWER_BITS;

/// 2^((index + 1/2)/32) in Q1.31.
static POWERS_OF_TWO: [u32; POWERS] = {
    let mut table = [0; POWERS];
    let mut index = 0;
    while index < POWERS {
        let x = core::f64::consts::LN_2 * (index as f64 + 0.5) / POWERS as f64;
        table[index] = (series::exp(x) * 2_147_483_648.0 + 0.5) as u32;
        index += 1;
    }
    table
};

/// Bytes of the table.
#[cfg(test)]
pub(super) const TABLE_BYTES: usize = POWERS * size_of::<u32>();

/// 2^t as a mantissa in Q1.31 and the exponent of a power of two, for t in Q10.54.
///
/// # Scaling and overflow
/// t = x log2 e is below 185 in magnitude. The first five bits of its fraction are
/// the index into the table. The rest, minus half a step, times ln 2 is y, |y| < 2^-6.5. The series
/// y + y²/2 + y³/6 has a truncation error of y⁴/24 < 2^-30; it is below 2^26 in Q0.32, and its
/// product with half the entry below 2^25. The mantissa is 1 to 2; rounding can make it slightly
/// less than 1.
#[inline(never)]
fn parts((twos, low): (i32, u32)) -> (u32, i32) {
    let fraction = ((twos as u32) << 10) | (low >> 22);
    let index = (fraction >> (32 - POWER_BITS)) as usize;
    let rest = fraction << POWER_BITS >> POWER_BITS;
    // ln 2 in Q0.31; the other factor is doubled to compensate.
    const LN_2: i32 = 1_488_522_236;
    let y = high((rest as i32 - (1 << (31 - POWER_BITS))) << 1, LN_2);
    // 1/6 in Q0.32.
    const SIXTH: i32 = 0x2aaa_aaab;
    let square = square(y);
    let beyond = y + (square >> 1) + high(square, high(y, SIXTH));
    let entry = POWERS_OF_TWO[index];
    let more = high((entry >> 1) as i32, beyond) << 1;
    (entry.wrapping_add(more as u32), twos >> 22)
}

/// A mantissa shifted right, rounded; 0 for shifts above 32.
fn shifted(mantissa: u32, shift: u32) -> u32 {
    if shift <= 32 { ((mantissa >> (shift - 1)) + 1) >> 1 } else { 0 }
}

/// e^x in Q8.24, saturated; the error is below 1 unit plus 2^-28 of the value.
///
/// # Scaling and overflow
/// Exponents are -185 to 184. The mantissa in Q1.31 is shifted right by 7 - exponent to Q8.24. From
/// an exponent of 7 on the result saturates; below -25 the shift exceeds 32 and the result is 0.
pub(super) fn exp(x: Fixed) -> Fixed {
    let (mantissa, exponent) = parts(exact(x.to_bits(), LOG2_E));
    let bits =
        if exponent >= 7 { i32::MAX } else { shifted(mantissa, (7 - exponent) as u32) as i32 };
    Fixed::from_bits(bits)
}

/// e^-x in Q0.32 for x >= 0, clamped to one unit below 1; the error is below 8 units.
#[inline(always)]
pub(super) fn decay(x: Fixed) -> Share {
    decay_of(exact(-x.to_bits().max(0), LOG2_E))
}

/// [`decay`] of a number in Q8.24 divided by 2^`bits`; `bits` is 1 to 31.
#[inline(always)]
pub(super) fn decay_over(x: i32, bits: u32) -> Share {
    let (high, low) = exact(-x, LOG2_E);
    decay_of((high >> bits, (high << (32 - bits)).cast_unsigned() | (low >> bits)))
}

/// 2^t in Q0.32 for t <= 0 in Q10.54, clamped to one unit below 1.
///
/// # Scaling and overflow
/// For x > 0 the exponent is negative: the Q1.31 mantissa is shifted right by 0 or more. For x = 0
/// the result would be 2^32 and is clamped to 2^32 - 1.
#[inline(always)]
fn decay_of(twos: (i32, u32)) -> Share {
    let (mantissa, exponent) = parts(twos);
    match -1 - exponent {
        ..=-1 => Share::MOST,
        0 => Share::from_bits(mantissa),
        shift => Share::from_bits(shifted(mantissa, shift as u32)),
    }
}
