//! Kernels in Q8.24: exponential, logarithm, softplus, quotient and what is made of them. Integer
//! multiplications of 32 bits by 32 into 64, shifts and two tables; no division.

use super::mantissa;
use crate::scalar::series;

/// 1 in Q8.24.
pub(super) const ONE: i32 = 1 << 24;
const FRACTION: u32 = 24;

/// A 64-bit number of units as a number that fits; the nearest one if it does not.
pub(super) fn saturate(units: i64) -> i32 {
    let low = units as i32;
    // The greatest number, or with every bit turned the least.
    if i64::from(low) == units { low } else { i32::MAX ^ (units >> 63) as i32 }
}

/// The product in Q8.24, rounded; saturated.
///
/// # Scaling and overflow
/// The product of two 32-bit numbers and half a unit fit in 63 bits: Q16.48. It fits in Q8.24 if its
/// high word has no more than 24 bits, sign included; the test is on words, since a comparison of 64
/// bits takes as long as all the rest.
pub(super) fn product(a: i32, b: i32) -> i32 {
    let exact = i64::from(a) * i64::from(b) + (1 << (FRACTION - 1));
    let high = (exact >> 32) as i32;
    if high << 8 >> 8 == high { (exact >> FRACTION) as i32 } else { i32::MAX ^ (high >> 31) }
}

/// log2 e in Q2.30, and ln 2 in Q0.32.
const LOG2_E: i64 = 1_549_082_005;
const LN_2: i64 = 2_977_044_472;
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

/// e^x as a mantissa in Q1.31 and a power of two.
///
/// # Scaling and overflow
/// x log2 e is below 185 and held in Q10.54. Of its fraction, five bits choose the table's entry
/// and the rest, less half a step, is y = (..) ln 2, |y| < 2^-6.5: the series
/// y + y²/2 + y³/6 + y⁴/24 is below 2^26 in Q0.32 and its product with the entry below 2^58.
fn exp_parts(x: i32) -> (u32, i32) {
    let twos = i64::from(x) * LOG2_E;
    let exponent = (twos >> 54) as i32;
    let fraction = (twos >> 22) as u32;
    let index = (fraction >> (32 - POWER_BITS)) as usize;
    let rest = fraction << POWER_BITS >> POWER_BITS;
    let y = ((i64::from(rest) - (1 << (31 - POWER_BITS))) * LN_2) >> 32;
    let series = |c: i64, inner: i64| (((y * inner) >> 32) * c) >> 32;
    const ONE_32: i64 = 1 << 32;
    const HALF: i64 = 1 << 31;
    const THIRD: i64 = 0x5555_5555;
    const QUARTER: i64 = 1 << 30;
    let fourth = ONE_32 + series(QUARTER, ONE_32);
    let third = ONE_32 + series(THIRD, fourth);
    let second = ONE_32 + series(HALF, third);
    let beyond = (y * second) >> 32;
    let entry = i64::from(POWERS_OF_TWO[index]);
    let mantissa = entry + ((entry * beyond) >> 32);
    (mantissa.min(i64::from(u32::MAX)) as u32, exponent)
}

/// e^x, saturated; within 1 unit where it is below 1, and within 2^-27 of its value above.
///
/// # Scaling and overflow
/// Exponents run from -185 to 184. A mantissa in Q1.31 becomes Q8.24 by a shift of 7 to the right,
/// less the exponent: of 0 bits at an exponent of 7 and more, where it saturates, and of more
/// than 32 below -25, where nothing is left.
pub(super) fn exp(x: i32) -> i32 {
    let (mantissa, exponent) = exp_parts(x);
    match 7 - exponent {
        ..=0 => i32::MAX,
        shift @ 1..=32 => ((u64::from(mantissa) + (1 << (shift - 1))) >> shift) as i32,
        _ => 0,
    }
}

/// e^-x in Q0.32 for x >= 0, below 1 by at least a unit; within 4 units.
///
/// # Scaling and overflow
/// The exponent of a number below 1 is negative: the shift of the Q1.31 mantissa is 0 or to the
/// right. For x = 0 it would be 2^32 and is a unit less.
pub(super) fn decay(x: i32) -> u32 {
    let (mantissa, exponent) = exp_parts(-x.max(0));
    match -1 - exponent {
        ..=-1 => u32::MAX,
        0 => mantissa,
        shift @ 1..=32 => ((u64::from(mantissa) + (1 << (shift - 1))) >> shift) as u32,
        _ => 0,
    }
}

/// ln x of a positive number; within 1 unit. For 0 and below it is that of one unit.
///
/// # Scaling and overflow
/// x is shifted left until its first bit is set; the power of two taken out is -24 to 6, and with
/// ln 2 in Q0.32 the sum is below 17 × 2^32.
pub(super) fn ln(x: i32) -> i32 {
    let x = x.max(1) as u32;
    let zeros = x.leading_zeros();
    let power = 7 - zeros as i64;
    let sum = power * LN_2 + mantissa::ln(x << zeros);
    ((sum + (1 << 7)) >> 8) as i32
}

/// ln(e^x + 1), saturated, and the logistic function of x; within 2 units each.
///
/// # Scaling and overflow
/// 1 + e^-|x| is a mantissa in Q1.31: e^-|x| in Q0.32 is below 1. Its logarithm is below ln 2 and
/// its reciprocal 1/2 to 1, both in Q0.32.
pub(super) fn softplus(x: i32) -> (i32, i32) {
    let decay = decay(x.saturating_abs());
    let mantissa = 0x8000_0000 | (decay >> 1);
    let tail = ((mantissa::ln(mantissa) + (1 << 7)) >> 8) as i32;
    let share = mantissa::reciprocal(mantissa);
    let rounded = |share: u32| ((u64::from(share) + (1 << 7)) >> 8) as i32;
    if x > 0 {
        (x.saturating_add(tail), rounded(share))
    } else {
        (tail, rounded(((u64::from(share) * u64::from(decay)) >> 32) as u32))
    }
}

/// `numerator/denominator` in Q8.24, saturated, for numbers in one format and a positive
/// denominator; within 2^-28 of its value and 1 unit. A denominator below a unit counts as one.
///
/// # Scaling and overflow
/// Both are shifted left until their first bit is set, n and d in Q1.31; see [`of_mantissas`].
pub(super) fn ratio(numerator: i32, denominator: i32) -> i32 {
    let (n, d) = (numerator.unsigned_abs(), denominator.max(1) as u32);
    let (zeros, denominator_zeros) = (n.leading_zeros(), d.leading_zeros());
    if n == 0 {
        return 0;
    }
    let shift = 39 + zeros as i32 - denominator_zeros as i32;
    of_mantissas(n << zeros, d << denominator_zeros, shift, numerator < 0)
}

/// The same for 64-bit numbers in one format.
///
/// # Scaling and overflow
/// Both are shifted left until their first bit is set and cut to 32 bits.
fn quotient(numerator: i64, denominator: i64) -> i32 {
    if numerator == 0 {
        return 0;
    }
    let (n, d) = (numerator.unsigned_abs(), denominator.max(1) as u64);
    let (zeros, denominator_zeros) = (n.leading_zeros(), d.leading_zeros());
    let (n, d) = ((n << zeros >> 32) as u32, (d << denominator_zeros >> 32) as u32);
    let shift = 39 + zeros as i32 - denominator_zeros as i32;
    of_mantissas(n, d, shift, numerator < 0)
}

/// n/d of mantissas in Q1.31, as a product in Q1.63 shifted right by `shift`.
///
/// # Scaling and overflow
/// The reciprocal of d is Q0.32 and below 2^32, its product with n Q1.63 and below 2^64. What is
/// left is a shift by 39 and the difference of the two shifts that made the mantissas.
fn of_mantissas(n: u32, d: u32, shift: i32, negative: bool) -> i32 {
    let product = u64::from(n) * u64::from(mantissa::reciprocal(d));
    let magnitude = match shift {
        ..=31 => i32::MAX,
        // Half a unit first: the sum of a product below 2^64 might pass it.
        32..=63 => (((product >> (shift - 1)) + 1) >> 1).min(i32::MAX as u64) as i32,
        _ => 0,
    };
    if negative { -magnitude } else { magnitude }
}

/// (1 + n v)/(1 + d v): value, slope and half its curvature, each saturated. A denominator below
/// 2^-7 counts as that.
///
/// # Scaling and overflow
/// n v and d v are Q16.48, and with |n|, |d| < 128 and |v| <= 128 at most 2^62. Both sums are
/// cut to Q12.20 or, below 8, to Q4.28; beyond 2048 and below -8, which is beyond the speed of any
/// muscle, they saturate. The denominator with f bits behind the point, shifted left by z
/// until its first bit is set, is a mantissa; its reciprocal in Q0.32, shifted right by 39 - f - z,
/// is 1/d in Q8.24. That shift is 1 to 18: at the least denominator, 2^-7, z is 10, and at the
/// greatest 1.
pub(super) fn hyperbola(v: i32, n: i32, d: i32) -> (i32, i32, i32) {
    const ONE_48: i64 = 1 << 48;
    const LEAST: i64 = ONE_48 >> 7;
    let fraction = |exact: i64| if exact < 8 * ONE_48 { 28 } else { 20 };
    let numerator = (ONE_48 + i64::from(n) * i64::from(v)).max(-8 * ONE_48 + 1);
    let denominator = (ONE_48 + i64::from(d) * i64::from(v)).max(LEAST);
    let (n_fraction, d_fraction) = (fraction(numerator), fraction(denominator));
    let numerator = saturate(numerator >> (48 - n_fraction));
    let denominator = saturate(denominator >> (48 - d_fraction)) as u32;
    let zeros = denominator.leading_zeros();
    let shift = 39 - d_fraction - zeros;
    let reciprocal = mantissa::reciprocal(denominator << zeros);
    let reciprocal = ((u64::from(reciprocal) + (1 << (shift - 1))) >> shift) as i32;
    let value = saturate((i64::from(numerator) * i64::from(reciprocal)) >> n_fraction);
    let slope = product(product(n.saturating_sub(d), reciprocal), reciprocal);
    let bend = product(product(d, slope), reciprocal);
    (value, slope, bend.saturating_neg())
}

/// Halley's correction r r'/(r'² - r r''/2), at most twice Newton's; saturated.
///
/// # Scaling and overflow
/// All products are Q16.48 and at most 2^62; the difference of two of them saturates.
pub(super) fn halley(residual: i32, slope: i32, half_curvature: i32) -> i32 {
    let slope = i64::from(slope.max(1));
    let square = slope * slope;
    let reduced = square.saturating_sub(i64::from(residual) * i64::from(half_curvature));
    quotient(i64::from(residual) * slope, reduced.max(square >> 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: f64 = (1_u32 << 24) as f64;

    /// Every one of the first and last numbers of a range, and `count` between.
    fn numbers(least: i32, most: i32, count: i64) -> impl Iterator<Item = i32> {
        let (first, last) = (i64::from(least), i64::from(most));
        let step = ((last - first) / count).max(1);
        (first..=last)
            .step_by(step as usize)
            .chain(first..=(first + 2000).min(last))
            .chain((last - 2000).max(first)..=last)
            .chain((first.max(-2000))..=(last.min(2000)))
            .map(|x| x as i32)
    }

    fn worst(errors: impl Iterator<Item = f64>) -> f64 {
        errors.fold(0.0, |worst, error| if error.is_nan() { error } else { worst.max(error) })
    }

    #[test]
    fn tables_take_384_bytes() {
        assert_eq!(size_of_val(&POWERS_OF_TWO) + mantissa::TABLE_BYTES, 384);
    }

    #[test]
    fn exponentials_below_one_are_within_a_unit() {
        let error = |x: i32| (f64::from(exp(x)) - (f64::from(x) / UNIT).exp() * UNIT).abs();
        let largest = worst(numbers(i32::MIN, 0, 3_000_000).map(error));
        assert!(largest <= 1.0, "{largest} units");
    }

    #[test]
    fn exponentials_above_one_are_within_2_to_the_minus_27_of_their_value_or_saturate() {
        for x in numbers(0, i32::MAX, 3_000_000) {
            let exact = (f64::from(x) / UNIT).exp() * UNIT;
            let expected = exact.min(f64::from(i32::MAX));
            let bound = 1.0 + exact * 2_f64.powi(-27);
            assert!((f64::from(exp(x)) - expected).abs() <= bound || exact > 2.2e9, "{x}");
            assert!(exact < 2.2e9 || exp(x) == i32::MAX, "{x}");
        }
    }

    #[test]
    fn decays_are_within_four_units_of_2_to_the_minus_32() {
        let error = |x: i32| {
            let exact = (-f64::from(x) / UNIT).exp() * 4_294_967_296.0;
            (f64::from(decay(x)) - exact).abs()
        };
        let largest = worst(numbers(0, i32::MAX, 3_000_000).map(error));
        assert!(largest <= 4.0, "{largest} units");
    }

    #[test]
    fn logarithms_are_within_a_unit() {
        let error = |x: i32| (f64::from(ln(x)) - (f64::from(x) / UNIT).ln() * UNIT).abs();
        let largest = worst(numbers(1, i32::MAX, 3_000_000).map(error));
        assert!(largest <= 1.0, "{largest} units");
    }

    #[test]
    fn softplus_and_its_slope_are_within_two_units() {
        let error = |x: i32| {
            let (value, slope) = softplus(x);
            let exact = f64::from(x) / UNIT;
            let expected = exact.max(0.0) + (-exact.abs()).exp().ln_1p();
            let logistic = 1.0 / (1.0 + (-exact).exp());
            let most = f64::from(i32::MAX);
            (f64::from(value) - (expected * UNIT).min(most))
                .abs()
                .max((f64::from(slope) - logistic * UNIT).abs())
        };
        let largest = worst(numbers(i32::MIN, i32::MAX, 3_000_000).map(error));
        assert!(largest <= 2.0, "{largest} units");
    }

    #[test]
    fn quotients_are_within_a_unit_and_2_to_the_minus_28_of_their_value_or_saturate() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let wide = (state ^ (state >> 29)) as i64;
            // Of any length.
            wide >> (state >> 58)
        };
        for _ in 0..3_000_000 {
            let (numerator, denominator) = (next(), next().saturating_abs().max(1));
            let exact = numerator as f64 / denominator as f64 * UNIT;
            let expected = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            let error = (f64::from(quotient(numerator, denominator)) - expected).abs();
            let bound = 1.0 + exact.abs().min(2_f64.powi(31)) * 2_f64.powi(-28);
            assert!(error <= bound, "{numerator}/{denominator}: {error}");
        }
        assert_eq!(quotient(i64::MIN, 1), -i32::MAX);
        assert_eq!(quotient(i64::MAX, 1), i32::MAX);
        assert_eq!(quotient(7, 0), 7 * ONE);
    }

    #[test]
    fn hyperbolas_are_those_of_f64() {
        let q = |x: f64| (x * UNIT).round() as i32;
        let mut largest = [0.0_f64; 3];
        // Shortening, down to near a pole, and lengthening, steep and flat, up to the greatest speed.
        for (n, d, least, most) in [
            (0.127, -0.746, -7.88, 0.0),
            (0.109_29, 0.107, -9.15, 0.0),
            (8.0, 1.45, 0.0, 60.0),
            (17.0, 5.7, 0.0, 60.0),
        ] {
            let [n, d] = [n, d].map(|x: f64| f64::from(q(x)) / UNIT);
            for step in 0..=20_000 {
                let bits = q(least + (most - least) * f64::from(step) / 20_000.0);
                let v = f64::from(bits) / UNIT;
                let r = 1.0 / (1.0 + d * v);
                let exact = [(1.0 + n * v) * r, (n - d) * r * r, -d * (n - d) * r * r * r];
                let (value, slope, bend) = hyperbola(bits, q(n), q(d));
                for ((found, exact), largest) in
                    [value, slope, bend].into_iter().zip(exact).zip(&mut largest)
                {
                    let error = (f64::from(found) / UNIT - exact).abs() / exact.abs().max(1.0);
                    *largest = largest.max(error);
                }
            }
        }
        let [value, slope, bend] = largest;
        assert!(value <= 1.5e-5 && slope <= 1e-6 && bend <= 2e-6, "{largest:?}");
    }

    #[test]
    fn corrections_are_halleys_and_at_most_twice_newtons() {
        let q = |x: f64| (x * UNIT).round() as i32;
        for slope in [0.02, 0.3, 0.5, 2.0, 40.0] {
            for curvature in [-40.0, -2.0, 0.0, 0.1, 5.0] {
                for step in -1000..=1000 {
                    let residual = f64::from(step) * 0.12;
                    let newton = residual / slope;
                    let reduced = slope * slope - residual * curvature;
                    let exact = residual * slope / reduced.max(0.5 * slope * slope);
                    let found = f64::from(halley(q(residual), q(slope), q(curvature))) / UNIT;
                    let expected = exact.clamp(-128.0, 128.0);
                    // The slope's own rounding is 3e-8, and counts twice; the curvature's counts
                    // where what it reduces is small.
                    let bound = 1e-6 + expected.abs() * (1e-6 + 1.2e-7 / slope);
                    assert!((found - expected).abs() <= bound, "{residual} {slope} {curvature}");
                    assert!(found.abs() <= 2.0 * newton.abs() * (1.0 + 1e-5) + 1e-6);
                }
            }
        }
    }
}
