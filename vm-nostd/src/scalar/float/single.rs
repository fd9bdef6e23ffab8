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

/// Where a cubic meets its function besides both ends of a piece, in pieces from each: where this
/// makes the largest error least, a sixth of that of the cubic with the slopes of both ends.
const INNER: f64 = 1.0 - core::f64::consts::FRAC_1_SQRT_2;

/// Values of a function at the meetings of a piece; its argument is in pieces.
macro_rules! meetings {
    ($at:ident, $index:expr) => {{
        let place = $index as f64;
        [$at(place), $at(place + INNER), $at(place + (1.0 - INNER)), $at(place + 1.0)]
    }};
}

/// The cubic with the values of [`meetings!`]. Coefficients are in order of powers, constant
/// first; the argument is 0..1 across the piece.
const fn cubic([start, first, second, end]: [f64; 4]) -> [f32; 4] {
    let rise = end - start;
    // The cubic is start + rise t + t (1 - t) (level + slope t).
    let share = INNER * (1.0 - INNER);
    let first = (first - start - INNER * rise) / share;
    let second = (second - start - (1.0 - INNER) * rise) / share;
    let slope = (second - first) / (1.0 - 2.0 * INNER);
    let level = first - INNER * slope;
    [start as f32, (rise + level) as f32, (slope - level) as f32, -slope as f32]
}

/// Number of pieces of a table: a power of two, so that one instruction masks the index.
const PIECES: usize = 64;

/// Value of a cubic, and its slope per piece.
#[inline(always)]
fn cubic_at([a, b, c, d]: &[f32; 4], share: f32) -> (f32, f32) {
    let bent = share * d;
    let curved = c + bent;
    (a + share * (b + share * curved), b + share * (curved + curved + bent))
}

const SOFTPLUS_PER_UNIT: u32 = 4;
/// From this |x| on, e^-|x| is below the ULP of |x|.
const LONGEST_TAIL: f32 = PIECES as f32 / SOFTPLUS_PER_UNIT as f32;

/// ln(1 + e^-x) for 0 <= x < 16.
static SOFTPLUS: [[f32; 4]; PIECES] = {
    const fn at(place: f64) -> f64 {
        series::ln_1p(series::exp(-place / SOFTPLUS_PER_UNIT as f64))
    }
    let mut table = [[0.0; 4]; PIECES];
    let mut index = 0;
    while index < PIECES {
        table[index] = cubic(meetings!(at, index));
        index += 1;
    }
    table
};

/// ln(e^x + 1) and its slope. The error of the value is below 4e-7 plus 1e-7 of x, and its relative
/// error below 2.5e-6; the error of the slope is below 2e-5.
///
/// Far below 0 the value is e^x, with a small relative error: in a slack muscle the equilibrium of
/// two such forces depends on their ratio.
#[inline(always)]
pub(super) fn softplus(x: f32) -> (f32, f32) {
    let distance = x.abs();
    if distance < LONGEST_TAIL {
        let place = distance * SOFTPLUS_PER_UNIT as f32;
        let index = place as u32;
        let piece = &SOFTPLUS[index as usize % PIECES];
        let (tail, slope) = cubic_at(piece, place - index as f32);
        let slope = slope * -(SOFTPLUS_PER_UNIT as f32);
        let above = 0.5 * (x + distance);
        return (above + tail, 0.5 + (0.5 - slope).copysign(x));
    }
    cold_path();
    if x < 0.0 {
        let power = exp(x);
        (power, power)
    } else {
        (x, 1.0)
    }
}

const WEIBULL_PER_UNIT: f32 = 3.5;
/// Index of the piece that starts at x = 0. The first node that is none of a constant piece is at
/// x = -14.9, the last at 2.9, where the value rounds to 1.
const WEIBULL_ZERO: i32 = 53;

/// The first and the last piece are constant, and are extrapolated.
static WEIBULL: [[f32; 4]; PIECES] = {
    const fn at(place: f64) -> f64 {
        series::one_minus_exp(series::exp((place - WEIBULL_ZERO as f64) / WEIBULL_PER_UNIT as f64))
    }
    const LAST: usize = PIECES - 1;
    let mut table = [[0.0; 4]; PIECES];
    let mut index = 1;
    while index < LAST {
        table[index] = cubic(meetings!(at, index));
        index += 1;
    }
    table[0][0] = at(1.0) as f32;
    table[LAST][0] = at(LAST as f64) as f32;
    table
};

/// 1 - e^-e^x for -14.8 <= x <= 3; the relative error is below 4e-6. x, at most 4e37 in magnitude,
/// is clamped to about this range.
///
/// The position within a piece is computed from the place before the index is added, so that no
/// bits are lost.
#[inline(always)]
pub(super) fn weibull(x: f32) -> f32 {
    let place = x * WEIBULL_PER_UNIT;
    let index = ((place + WEIBULL_ZERO as f32) as i32).clamp(0, PIECES as i32 - 1);
    cubic_at(&WEIBULL[index as usize], place - (index - WEIBULL_ZERO) as f32).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_take_2304_bytes() {
        let bytes = size_of_val(&MANTISSAS) + size_of_val(&SOFTPLUS) + size_of_val(&WEIBULL);
        assert_eq!(bytes, 2304);
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
