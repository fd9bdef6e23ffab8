//! Logarithm and reciprocal of mantissas: 1 <= m < 2 in Q1.31.
//!
//! Both use a table of c = 1/m at the midpoints of 64 intervals, and a series in r = m c - 1,
//! |r| < 1/128.

use super::number::{FRACTION, Fixed, exact, high, square};
use super::product;
use crate::scalar::cold::cold_path;
use crate::scalar::series;

/// Bits of the index into the tables.
const INDEX_BITS: u32 = 6;
const ENTRIES: usize = 1 << INDEX_BITS;

/// 1/m at the midpoint of each 64th of 1..2, Q0.32.
static RECIPROCALS: [u32; ENTRIES] = {
    let mut table = [0; ENTRIES];
    let mut index = 0;
    while index < ENTRIES {
        // m = (2 * 64 + 2 index + 1)/128.
        table[index] = ((128 << 32) / (128 + 2 * index as u64 + 1)) as u32;
        index += 1;
    }
    table
};

/// -ln of each of [`RECIPROCALS`], Q1.31.
static LOGARITHMS: [i32; ENTRIES] = {
    let mut table = [0; ENTRIES];
    let mut index = 0;
    while index < ENTRIES {
        let below_one = RECIPROCALS[index] as f64 / 4_294_967_296.0 - 1.0;
        table[index] = (2_147_483_648.0 * -series::ln_1p(below_one) + 0.5) as i32;
        index += 1;
    }
    table
};

/// Bytes of the two tables.
#[cfg(test)]
pub(super) const TABLE_BYTES: usize = 2 * ENTRIES * size_of::<u32>();

/// The index of `m` in the tables, the reciprocal c there, and r = m c - 1 in Q0.32.
///
/// # Scaling and overflow
/// m is Q1.31 and c Q0.32; their product, Q1.63, is within 1/128 of 1. The 1 is bit 63 and is
/// dropped by taking the 32 bits from bit 31 on, which are r: below 2^25 + 1 in magnitude.
#[inline(always)]
fn reduced(m: u32) -> (usize, u32, i32) {
    let index = ((m >> (31 - INDEX_BITS)) & (ENTRIES as u32 - 1)) as usize;
    let c = RECIPROCALS[index];
    let product = product::unsigned(m, c);
    (index, c, (product >> 31) as u32 as i32)
}

/// 1/m in Q1.31, 2^30 to 2^31, for m in Q1.31 with its first bit set; the error is below 3 units.
///
/// # Scaling and overflow
/// c (1 - r + r² - r³ + r⁴) is c/(1 + r) with a truncation error of r⁵ < 2^-35. r⁴, at most 2^-28,
/// is approximated by r² 2^-14; the error is at most a quarter of that. The series without its 1 is
/// below 2^26 in Q0.32, and its product with c/2 in Q0.31 below 2^25 in magnitude: the sum does not
/// wrap around.
#[inline(always)]
pub(super) fn reciprocal(m: u32) -> u32 {
    let (_, c, r) = reduced(m);
    let square = square(r);
    let beyond = square + (square >> 14) - r - high(r, square);
    let half = (c >> 1) as i32;
    (half as u32).wrapping_add_signed(high(half, beyond))
}

/// [`reciprocal`] of several mantissas from one reciprocal, that of their product; for two the
/// error is below 8 units.
///
/// # Scaling and overflow
/// The product of two mantissas is 1 to 4: its high word is shifted left by 0 or 1 bit to make it a
/// mantissa. The reciprocal of the product times one mantissa, shifted by the same amount, is the
/// reciprocal of the other.
#[inline(always)]
pub(super) fn reciprocals<const N: usize>(mantissas: [u32; N]) -> [u32; N] {
    let mut products = mantissas;
    let mut shifts = [0; N];
    for index in 1..N {
        let product = upper(products[index - 1], mantissas[index]);
        shifts[index] = 1 - (product >> 31);
        products[index] = product << shifts[index];
    }
    let mut found = mantissas;
    let mut rest = products.last().map_or(0, |&product| reciprocal(product));
    for index in (1..N).rev() {
        found[index] = upper(rest, products[index - 1]) << shifts[index];
        rest = upper(rest, mantissas[index]) << shifts[index];
    }
    if let Some(first) = found.first_mut() {
        *first = rest;
    }
    found
}

/// High word of an unsigned product.
#[inline(always)]
fn upper(a: u32, b: u32) -> u32 {
    (product::unsigned(a, b) >> 32) as u32
}

/// High word of two words shifted left by at most 31 bits.
#[inline(always)]
pub(super) fn word((high, low): (i32, u32), left: u32) -> i32 {
    (high << left) | (low >> 1 >> (31 - left)) as i32
}

/// ln 2 in Q1.31.
const LN_2: i32 = 1_488_522_236;

/// ln x in Q8.24 of a positive number, within 1 ULP. For 0 and negative numbers it is the logarithm
/// of one ULP.
///
/// # Scaling and overflow
/// x, at most 2^31, is extended by 24 bits to Q16.48.
#[inline(always)]
pub(super) fn ln(x: Fixed) -> Fixed {
    let bits = x.to_bits().max(1);
    ln_of_words((bits >> (32 - FRACTION), bits.cast_unsigned() << FRACTION))
}

/// ln(a b) in Q8.24 of numbers that are not negative, within 1 ULP. For 0 it is the logarithm of
/// the least product.
#[inline(always)]
pub(super) fn ln_of_product(a: Fixed, b: Fixed) -> Fixed {
    ln_of_words(exact(a.to_bits(), b.to_bits()))
}

/// Logarithm in Q8.24 of a number in Q16.48 that is not negative.
///
/// # Scaling and overflow
/// The number is shifted left until its first bit is set; the exponent is -48 to 14. The logarithm
/// of the mantissa, -ln c + r - r²/2 + r³/3 with a truncation error of r⁴/4 < 2^-30, is below 0.7
/// in Q1.31. The sum is below 34 in magnitude and has 37 of 64 bits.
#[inline(never)]
fn ln_of_words((mut upper, mut lower): (i32, u32)) -> Fixed {
    let mut power = 15;
    if upper == 0 {
        cold_path();
        (upper, lower, power) = (lower.max(1).cast_signed(), 0, power - 32);
    }
    let zeros = upper.leading_zeros();
    let (index, _, r) = reduced(word((upper, lower), zeros).cast_unsigned());
    // 1/3 in Q0.32.
    const THIRD: i32 = 0x5555_5555;
    let series = r - high(r, (r >> 1) - high(r, high(r, THIRD)));
    let mantissa = LOGARITHMS[index] + (series >> 1);
    let sum = product::signed(power - zeros as i32, LN_2) + i64::from(mantissa + (1 << 6));
    Fixed::from_bits((sum >> 7) as i32)
}
