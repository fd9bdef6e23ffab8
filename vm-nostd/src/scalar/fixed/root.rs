//! Root of a force balance with a line and a hyperbola: a quadratic equation and its square root.

use super::mantissa::word;
use super::number::{Fixed, exact, high, square};
use super::product;
use super::quotient::reciprocal_factors;
use crate::scalar::cold::cold_path;
use crate::scalar::series;

/// Arguments of [`hyperbola_root`]. All are positive except `residual` and
/// `half_curvature`.
pub(super) struct Forces {
    pub(super) residual: Fixed,
    pub(super) line: Fixed,
    pub(super) steepness: Fixed,
    pub(super) half_curvature: Fixed,
    pub(super) inertia: Fixed,
    pub(super) viscosity: Fixed,
}

/// The root u of residual + line u + steepness u/(1 + bend u) = 0 and 1/(inertia + damping), with
/// bend = -half_curvature/steepness and damping = viscosity + steepness/(1 + bend u); in Q8.24,
/// saturated.
///
/// The error of both is below 2e-7 plus that of cancellation: an error of 2^-24 of the largest
/// product and of the square root, relative to `denominator` or `secant_denominator`. The
/// reciprocal has a further error of 2^-18 of the largest product, or of 2^-17, relative to
/// `total`.
///
/// # Scaling and overflow
/// All products are Q16.48 and at most 2^62. They are normalised together: shifted left until the
/// largest fills the word, and cut to 29 bits. Sums of three are below 2^30, and the discriminant,
/// the square of such a sum plus four times a product, is below 2^60. `denominator` and
/// `secant_denominator` are below 2^31, and so is `total`, which has 8 bits fewer than their
/// product with a number in Q8.24.
#[inline(always)]
pub(super) fn hyperbola_root(forces: &Forces) -> (Fixed, Fixed) {
    let Forces { residual, line, steepness, half_curvature, inertia, viscosity } = *forces;
    let [residual, line, steepness] = [residual, line, steepness].map(Fixed::to_bits);
    let half_curvature = half_curvature.to_bits();
    let products = [
        exact(steepness, line),
        exact(steepness, steepness),
        exact(residual, half_curvature),
        exact(residual, steepness),
    ];
    let bits = products.iter().fold(0, |bits, (high, _)| bits | (high ^ (high >> 31)));
    let left = bits.leading_zeros() - 1;
    let [line_product, square, curvature_product, residual] =
        products.map(|product| word(product, left) >> 3);
    let linear = line_product + square - curvature_product;
    // linear² + 4 line_product curvature_product, written as a sum of positive terms.
    let difference = line_product + curvature_product - square;
    let discriminant =
        product::signed(difference, difference) + 4 * product::signed(line_product, square);
    let root = square_root(discriminant as u64 | 1) as i32;
    // The root is at least |difference|, so that in exact arithmetic both denominators are at least
    // their lower bounds here.
    let denominator = (linear + root).max((2 * line_product) | 1);
    let secant_denominator = (denominator + 2 * curvature_product).max((2 * square) | 1);
    // total = (inertia + damping) secant_denominator. Both quotients share one reciprocal.
    let without_secant = inertia.to_bits().saturating_add(viscosity.to_bits());
    let total = (high(without_secant, secant_denominator) + high(steepness, denominator)) | 1;
    let [per_denominator, per_total] = reciprocal_factors([denominator, total], [37, 46]);
    let bits = [per_denominator.times(-residual), per_total.times(secant_denominator)];
    bits.map(Fixed::from_bits).into()
}

/// Bits of the index into the table.
const INDEX_BITS: u32 = 7;
const ENTRIES: usize = 1 << INDEX_BITS;

/// 1/√m at the midpoint of each 128th of 0..1, Q1.31. m is at least 1/4; the entries below are
/// unused, but with them a 7-bit index needs no bounds check and cannot panic.
static RECIPROCAL_ROOTS: [u32; ENTRIES] = {
    let mut table = [0; ENTRIES];
    let mut index = ENTRIES / 4;
    while index < ENTRIES {
        let middle = (index as f64 + 0.5) / ENTRIES as f64;
        table[index] = (series::exp(-0.5 * series::ln_1p(middle - 1.0)) * 2_147_483_648.0) as u32;
        index += 1;
    }
    table
};

/// Bytes of the table.
#[cfg(test)]
pub(super) const TABLE_BYTES: usize = ENTRIES * size_of::<u32>();

/// √x for 1 <= x < 2^60; relative error below 2^-25, plus one unit.
///
/// # Scaling and overflow
/// x is shifted left by an even number z of bits, 4 to 62, until one of its first two bits is set:
/// this is m in Q0.32, 1/4 to 1. With c from the table, y = m c approximates √m within 1/128, in
/// Q1.31. d = y c - 1 is below 2^26 in Q0.32: the 1 is bit 62 of the product in Q2.62 and is
/// dropped by taking the 32 bits from bit 30 on. y (1 - d/2 + 3 d²/8 - 5 d³/16) is √m with a
/// truncation error of d⁴/4 < 2^-25.9.
#[inline(always)]
pub(crate) fn square_root(x: u64) -> u32 {
    let (mut upper, mut lower, mut shifted) = ((x >> 32) as u32, x as u32, 0);
    if upper == 0 {
        cold_path();
        (upper, lower, shifted) = (lower, 0, 32);
    }
    let zeros = upper.leading_zeros() & !1;
    let m = word((upper as i32, lower), zeros) as u32;
    let zeros = zeros + shifted;
    let c = RECIPROCAL_ROOTS[(m >> (32 - INDEX_BITS)) as usize];
    let y = (product::unsigned(m, c) >> 32) as u32;
    let d = (product::unsigned(y, c) >> 30) as u32 as i32;
    // 3/8 - 5/16 d in Q0.32.
    let curved = 0x6000_0000 - (d >> 2) - (d >> 4);
    let beyond = (d >> 1) - high(square(d), curved);
    let root = y.wrapping_add_signed(-(high((y >> 1) as i32, beyond) << 1));
    root >> (zeros / 2 - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_have_the_sign_that_cancels_any_residual() {
        let number = Fixed::from_bits;
        let any = [i32::MIN, i32::MIN + 1, -1 << 24, -1, 0, 1, 1 << 24, i32::MAX - 1, i32::MAX];
        let positive = [1, 168, 1 << 20, 1 << 24, i32::MAX];
        for (residual, half_curvature) in any.iter().flat_map(|a| any.map(|b| (*a, b))) {
            for (line, steepness) in positive.iter().flat_map(|a| positive.map(|b| (*a, b))) {
                let (inertia, viscosity) = (number(1 << 20), number(1 << 17));
                let (root, reciprocal) = hyperbola_root(&Forces {
                    residual: number(residual),
                    line: number(line),
                    steepness: number(steepness),
                    half_curvature: number(half_curvature),
                    inertia,
                    viscosity,
                });
                let what = format!("{residual} {line} {steepness} {half_curvature}");
                let (root, reciprocal) = (root.to_bits(), reciprocal.to_bits());
                assert!(i64::from(root) * i64::from(residual) <= 0, "{what}: {root}");
                assert!(reciprocal >= 0, "{what}: {reciprocal}");
            }
        }
    }
}
