//! Kernels in `f32`: short polynomials, and cubic pieces from compile-time tables. The table in
//! `tests/kernels` holds their error bounds over every bit pattern.

use crate::scalar::cold::cold_path;
use crate::scalar::series;

/// 1.5 × 2^23: adding it to a number below 2^22 rounds the number to an integer, which is then in
/// the last bits.
const ROUNDING: f32 = 12_582_912.0;
/// ln 2 in two parts (Cody-Waite reduction): the high part has few bits.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Smallest x for which e^x is a normal number, as an integer.
const LEAST_EXPONENT: f32 = -87.0;

/// e^x for x <= 88; the relative error is below 2.2e-7. x is clamped to at least -87.
#[inline(always)]
pub(super) fn exp(x: f32) -> f32 {
    let x = if x > LEAST_EXPONENT { x } else { LEAST_EXPONENT };
    let shifted = x * core::f32::consts::LOG2_E + ROUNDING;
    let twos = shifted - ROUNDING;
    let r = (x - twos * LN_2_HIGH) - twos * LN_2_LOW;
    // Minimax for (e^r - 1 - r)/r² on |r| <= ln 2/2, in two independent halves.
    let square = r * r;
    let series = (0.499_991_47 + r * 0.166_664_59) + square * (0.041_898_31 + r * 0.008_374_51);
    let mantissa = 1.0 + (r + square * series);
    f32::from_bits(mantissa.to_bits().wrapping_add(shifted.to_bits() << 23))
}

/// 1 - e^-x for x >= 0; the relative error is below 4e-7 up to x = 8. x is clamped to at most 8.
#[inline(always)]
pub(super) fn one_minus_exp(x: f32) -> f32 {
    // Evaluated at x/8; y → 1 - (1 - y)² then doubles x three times.
    let u = if x < 8.0 { x * 0.125 } else { 1.0 };
    // Minimax for (1 - e^-u)/u on 0 <= u <= 1.
    let series = 0.999_999_94
        + u * (-0.499_995_36
            + u * (0.166_611_24
                + u * (-0.041_423_16 + u * (0.007_842_377 + u * -0.000_914_548_2))));
    let eighth = u * series;
    let quarter = eighth * (2.0 - eighth);
    let half = quarter * (2.0 - quarter);
    half * (2.0 - half)
}

/// 1 - e^-x for 0 <= x <= 1.25; the relative error is below 5e-7.
#[inline(always)]
pub(super) fn short_lag_response(x: f32) -> f32 {
    // Minimax for (1 - e^-x)/x.
    let square = x * x;
    let (first, second) = (0.999_999_7 + x * -0.499_984_53, 0.166_527_03 + x * -0.041_194_26);
    let third = 0.007_588_855 + x * -0.000_816_409_95;
    x * (first + square * (second + square * third))
}

/// √x of a non-negative number, with a relative error from 0 to +5e-5, never negative, for x of at
/// least 1e-37. Below that the result is at most 1e-18.
#[inline(always)]
pub(crate) fn square_root(x: f32) -> f32 {
    // g is 1/√x within 5 %, from half the exponent. With w = x g², √x is x g/√w; 1/√w is a minimax
    // parabola, raised by its largest error.
    let guess = f32::from_bits(0x5f35_59df - (x.to_bits() >> 1));
    let root = x * guess;
    let w = root * guess;
    root * (1.895_067_2 + w * (w * 0.394_393_92 - 1.289_453_1))
}

const LOGARITHM_BITS: u32 = 5;
const LOGARITHMS: usize = 1 << LOGARITHM_BITS;
const FRACTION_BITS: u32 = 23;

/// For each 32nd of the mantissas 1 to 2: the reciprocal 1/c of its midpoint, and ln c, rounded to
/// `f32`.
static MANTISSAS: [(f32, f32); LOGARITHMS] = {
    let mut table = [(0.0, 0.0); LOGARITHMS];
    let mut index = 0;
    while index < LOGARITHMS {
        let reciprocal = (64.0 / (64.0 + 2.0 * index as f64 + 1.0)) as f32;
        // The logarithm of the reciprocal of the rounded 1/c.
        table[index] = (reciprocal, -series::ln_1p(reciprocal as f64 - 1.0) as f32);
        index += 1;
    }
    table
};

/// ln x of a positive normal number; the error is below 1.5e-7 plus 1e-7 of the value. For 0 and
/// subnormal numbers the result is -88.1 to -87.2.
#[inline(always)]
pub(super) fn ln(x: f32) -> f32 {
    let bits = x.to_bits();
    let exponent = (bits >> FRACTION_BITS) as i32 - 127;
    let index = (bits >> (FRACTION_BITS - LOGARITHM_BITS)) as usize & (LOGARITHMS - 1);
    let mantissa = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000);
    let (reciprocal, logarithm) = MANTISSAS[index];
    let r = mantissa * reciprocal - 1.0;
    // |r| <= 1/64: the truncation error of the series is r⁵/5 < 2e-10.
    let square = r * r;
    let series = r - square * ((0.5 - r * 0.333_333_34) + square * 0.25);
    let twos = exponent as f32;
    twos * LN_2_HIGH + (logarithm + (series + twos * LN_2_LOW))
}

/// The cubic with given values and slopes at both ends of a piece. Coefficients are in order of
/// powers, constant first; the argument is 0..1 across the piece.
const fn hermite(length: f64, start: (f64, f64), end: (f64, f64)) -> [f32; 4] {
    let (a, b) = (start.0, start.1 * length);
    let (rise, last) = (end.0 - start.0, end.1 * length);
    [a as f32, b as f32, (3.0 * rise - 2.0 * b - last) as f32, (b + last - 2.0 * rise) as f32]
}

/// Number of pieces of a table: a power of two, so that one instruction masks the index.
const PIECES: usize = 128;

/// Value of a piecewise cubic, and its slope per piece, at a `place` in units of pieces. The piece
/// that starts at place 0 has index `zero`. Outside the table, the first or the last piece is
/// extrapolated.
///
/// The position within a piece is computed from the place before the index is added, so that no
/// bits are lost.
#[inline(always)]
fn piecewise(pieces: &[[f32; 4]; PIECES], place: f32, zero: i32) -> (f32, f32) {
    let index = ((place + zero as f32) as i32).clamp(0, PIECES as i32 - 1);
    let share = place - (index - zero) as f32;
    let [a, b, c, d] = pieces[index as usize];
    let bent = share * d;
    let curved = c + bent;
    let value = a + share * (b + share * curved);
    let slope = b + share * (curved + curved + bent);
    (value, slope)
}

const SOFTPLUS_PER_UNIT: u32 = 4;
const SOFTPLUS_LEAST: i32 = -(PIECES as i32) / (2 * SOFTPLUS_PER_UNIT as i32);

/// The last piece is x, and is extrapolated. Below the first piece another formula is used.
static SOFTPLUS: [[f32; 4]; PIECES] = {
    const fn node(index: usize) -> (f64, f64) {
        let power = series::exp(SOFTPLUS_LEAST as f64 + index as f64 / SOFTPLUS_PER_UNIT as f64);
        (series::ln_1p_of(power), power / (1.0 + power))
    }
    let mut table = [[0.0; 4]; PIECES];
    let mut index = 0;
    while index < PIECES - 1 {
        table[index] = hermite(1.0 / SOFTPLUS_PER_UNIT as f64, node(index), node(index + 1));
        index += 1;
    }
    let start = SOFTPLUS_LEAST as f64 + index as f64 / SOFTPLUS_PER_UNIT as f64;
    table[index] = [start as f32, 1.0 / SOFTPLUS_PER_UNIT as f32, 0.0, 0.0];
    table
};

/// ln(e^x + 1) and its slope. The error of the value is below 2e-6 plus 1e-7 of x, and its relative
/// error below 2e-5; the error of the slope is below 2e-5. x is at most 8e37 in magnitude.
///
/// Far below 0 the value is e^x, with a small relative error: in a slack muscle the equilibrium of
/// two such forces depends on their ratio.
#[inline(always)]
pub(super) fn softplus(x: f32) -> (f32, f32) {
    const ZERO: i32 = PIECES as i32 / 2;
    let place = x * SOFTPLUS_PER_UNIT as f32;
    if (place + ZERO as f32).is_sign_negative() {
        cold_path();
        let power = exp(x);
        return (power, power);
    }
    let (value, slope) = piecewise(&SOFTPLUS, place, ZERO);
    (value, slope * SOFTPLUS_PER_UNIT as f32)
}

const WEIBULL_LEAST: i32 = -15;
const WEIBULL_MOST: i32 = 3;
const WEIBULL_PER_UNIT: i32 = 7;

/// The first and the last piece are constant, and are extrapolated.
static WEIBULL: [[f32; 4]; PIECES] = {
    const fn node(index: usize) -> (f64, f64) {
        let place = (index - 1) as f64 / WEIBULL_PER_UNIT as f64;
        let power = series::exp(WEIBULL_LEAST as f64 + place);
        (series::one_minus_exp(power), power * series::exp(-power))
    }
    const LAST: usize = PIECES - 1;
    let mut table = [[0.0; 4]; PIECES];
    let mut index = 1;
    while index < LAST {
        table[index] = hermite(1.0 / WEIBULL_PER_UNIT as f64, node(index), node(index + 1));
        index += 1;
    }
    table[0][0] = node(1).0 as f32;
    table[LAST][0] = node(LAST).0 as f32;
    table
};
const _: () = assert!((WEIBULL_MOST - WEIBULL_LEAST) * WEIBULL_PER_UNIT == PIECES as i32 - 2);

/// 1 - e^-e^x for -15 <= x <= 3; the relative error is below 2e-6. x, at most 4e37 in magnitude, is
/// clamped to this range.
#[inline(always)]
pub(super) fn weibull(x: f32) -> f32 {
    const ZERO: i32 = 1 - WEIBULL_LEAST * WEIBULL_PER_UNIT;
    piecewise(&WEIBULL, x * WEIBULL_PER_UNIT as f32, ZERO).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_take_4352_bytes() {
        let bytes = size_of_val(&MANTISSAS) + size_of_val(&SOFTPLUS) + size_of_val(&WEIBULL);
        assert_eq!(bytes, 4352);
        let readme = include_str!("../../../README.md");
        assert!(readme.contains(&format!("tables of {} KiB", bytes as f64 / 1024.0)));
    }

    #[test]
    fn beyond_their_ranges_kernels_are_clamped() {
        assert_eq!(exp(-1e30), exp(-87.0));
        assert_eq!(softplus(-1e30), softplus(-87.0));
        assert_eq!(softplus(1e30), (1e30, 1.0));
        assert_eq!((weibull(-1e30), weibull(1e30)), (weibull(-15.0), weibull(3.0)));
        assert_eq!((one_minus_exp(0.0), short_lag_response(0.0)), (0.0, 0.0));
        assert_eq!(square_root(0.0), 0.0);
        assert!(square_root(1e-40) < 1e-18);
        for least in [0.0, 1e-45, 1e-40, 1e-38] {
            assert!((-88.1..-87.2).contains(&ln(least)), "{least:e}: {}", ln(least));
        }
    }
}
