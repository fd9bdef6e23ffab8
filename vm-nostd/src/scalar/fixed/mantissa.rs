//! Logarithm and reciprocal of a mantissa: a number 1 <= m < 2 in 32 bits, the first of them set.
//!
//! Both start from the same table: c = 1/m at the middle of the 32nd of the range that m is in,
//! and then go on with r = m c - 1, |r| < 1/64.

use crate::scalar::series;

/// Bits of the index into the tables.
const INDEX_BITS: u32 = 5;
const ENTRIES: usize = 1 << INDEX_BITS;

/// 1/m at the middle of each 32nd of 1..2, Q0.32.
static RECIPROCALS: [u32; ENTRIES] = {
    let mut table = [0; ENTRIES];
    let mut index = 0;
    while index < ENTRIES {
        // m = (2 * 32 + 2 index + 1)/64.
        table[index] = ((64 << 32) / (64 + 2 * index as u64 + 1)) as u32;
        index += 1;
    }
    table
};

/// -ln of each of [`RECIPROCALS`], Q0.32.
static LOGARITHMS: [u32; ENTRIES] = {
    let mut table = [0; ENTRIES];
    let mut index = 0;
    while index < ENTRIES {
        let below_one = RECIPROCALS[index] as f64 / 4_294_967_296.0 - 1.0;
        table[index] = (4_294_967_296.0 * -series::ln_1p(below_one) + 0.5) as u32;
        index += 1;
    }
    table
};

/// What the two tables take.
#[cfg(test)]
pub(super) const TABLE_BYTES: usize = 2 * ENTRIES * size_of::<u32>();

/// The high half of a product of signed 32-bit fractions.
fn high(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 32) as i32
}

/// The table's entry for `m`, and r = m c - 1 in Q0.32.
///
/// # Scaling and overflow
/// m is Q1.31 and c Q0.32: their product Q1.63 is 1 within 1/64, so that the difference to 2^63,
/// shifted to Q0.32, is below 2^26 + 1 in magnitude.
fn reduced(m: u32) -> (usize, i32) {
    let index = ((m >> (31 - INDEX_BITS)) & (ENTRIES as u32 - 1)) as usize;
    let product = u64::from(m) * u64::from(RECIPROCALS[index]);
    (index, (product.wrapping_sub(1 << 63) as i64 >> 31) as i32)
}

/// ln m in Q0.32, for m in Q1.31 with its first bit set; within 3 units.
///
/// # Scaling and overflow
/// r - r²/2 + r³/3 - r⁴/4 is below 2^27 in magnitude, and ln m below 0.6932 × 2^32: sums fit in
/// 64 bits with room to spare. The series is cut at r⁵/5 < 2^-32.3.
pub(super) fn ln(m: u32) -> i64 {
    let (index, r) = reduced(m);
    // r/4, r/3 and so on are taken of numbers below 2^27: no shift overflows.
    const THIRD: i32 = 0x5555_5555;
    let fourth = high(r, r) >> 2;
    let third = high(r, THIRD) - fourth;
    let second = (r >> 1) - high(r, third);
    let sum = i64::from(r) - i64::from(high(r, second));
    i64::from(LOGARITHMS[index]) + sum
}

/// 1/m in Q0.32, for m in Q1.31 with its first bit set; within 5 units, and below 2^32.
///
/// # Scaling and overflow
/// c (1 - r)(1 + r²)(1 + r⁴) is c/(1 + r) to 1 - r⁸. Each factor is 1 within 1/64; products are
/// taken of the parts beyond 1, which are below 2^27 in Q0.32.
pub(super) fn reciprocal(m: u32) -> u32 {
    let (index, r) = reduced(m);
    let square = high(r, r);
    let fourth = high(square, square);
    let mut beyond = -r;
    beyond += square + high(beyond, square);
    beyond += fourth + high(beyond, fourth);
    let c = i64::from(RECIPROCALS[index]);
    let exact = c + ((c * i64::from(beyond)) >> 32);
    exact.min(i64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every mantissa near the edges of the table's ranges, and some hundred thousand between.
    fn mantissas() -> impl Iterator<Item = u32> {
        let edges = (0..ENTRIES as u32).flat_map(|index| {
            let edge = 0x8000_0000 + (index << (31 - INDEX_BITS));
            (0..200)
                .map(move |step| edge + step)
                .chain((1..200).map(move |s| edge.wrapping_sub(s) | 0x8000_0000))
        });
        edges.chain((0..500_000).map(|step| 0x8000_0000 + step * 4_294))
    }

    #[test]
    fn logarithms_are_within_three_units() {
        let mut worst = 0.0_f64;
        for m in mantissas() {
            let exact = (f64::from(m) / 2_f64.powi(31)).ln() * 2_f64.powi(32);
            worst = worst.max((ln(m) as f64 - exact).abs());
        }
        assert!(worst <= 3.0, "{worst}");
    }

    #[test]
    fn reciprocals_are_within_five_units() {
        let mut worst = 0.0_f64;
        for m in mantissas() {
            let exact = 2_f64.powi(63) / f64::from(m);
            worst = worst.max((f64::from(reciprocal(m)) - exact.min(4_294_967_295.0)).abs());
        }
        assert!(worst <= 5.0, "{worst}");
    }
}
