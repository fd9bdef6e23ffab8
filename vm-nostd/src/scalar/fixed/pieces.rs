//! Softplus and the Weibull distribution: cubic interpolation between compile-time nodes.

use super::number::{Fixed, high};
use super::unit::Unit;
use crate::scalar::series;

/// Nodes per unit of the argument, as a power of two.
const NODE_BITS: u32 = 3;
/// Bits of a Q8.24 number within a piece.
const PLACE_BITS: u32 = 24 - NODE_BITS;

/// A function's value, 0 to 1, and its slope times the length of a piece, both in Q2.30.
type Node = (i32, i32);

const fn node(value: f64, slope: f64) -> Node {
    const UNITS: f64 = 1_073_741_824.0;
    ((value * UNITS + 0.5) as i32, (slope * UNITS / (1 << NODE_BITS) as f64 + 0.5) as i32)
}

/// Cubic Hermite interpolation at a distance `place` from the first node in Q8.24. Returns the
/// value, and the slope times the length of a piece, in Q2.30. Beyond the last node it evaluates
/// the last piece, which must be flat.
///
/// # Scaling and overflow
/// Both functions lie in 0..1 and are monotone. Their slopes times the length of a piece are below
/// 2^-3, and so are differences of adjacent values; all coefficients are below 2^29. The position
/// within a piece is a share in Q0.31; a product with it is Q3.29 and is doubled to Q2.30.
#[inline(always)]
fn between<const NODES: usize>(nodes: &[Node; NODES], place: u32) -> (i32, i32) {
    let index = ((place >> PLACE_BITS) as usize).min(NODES - 2);
    let ((start, first), (end, last)) = (nodes[index], nodes[index + 1]);
    // Negated, so that the compiler does not know its sign: see `square`.
    let share = (((place << (32 - PLACE_BITS)) >> 1) as i32).wrapping_neg();
    let less = |coefficient: i32| high(share, coefficient) << 1;
    let rise = end - start;
    let cubic = first + last - 2 * rise;
    let square = rise - first - cubic;
    let bent = less(cubic);
    let value = start - less(first - less(square - bent));
    let slope = first - less(2 * square - 3 * bent);
    (value, slope)
}

/// Converts Q2.30 to Q8.24, rounded to nearest.
fn in_units(value: i32) -> Fixed {
    Fixed::from_bits((value + (1 << 5)) >> 6)
}

/// From this |x| on, ln(1 + e^-|x|) is below half an ULP.
const LONGEST_TAIL: usize = 18;
const SOFTPLUS_NODES: usize = (LONGEST_TAIL << NODE_BITS) + 1;

/// ln(1 + e^-x) and its slope.
static SOFTPLUS: [Node; SOFTPLUS_NODES] = {
    let mut table = [(0, 0); SOFTPLUS_NODES];
    let mut index = 0;
    while index < SOFTPLUS_NODES {
        let power = series::exp(-(index as f64) / (1 << NODE_BITS) as f64);
        let (value, slope) = node(series::ln_1p(power), power / (1.0 + power));
        table[index] = (value, -slope);
        index += 1;
    }
    table
};

/// ln(e^x + 1), saturated, and its slope, the logistic function of x. The errors are below 2 units
/// and 2.1e-6.
///
/// # Scaling and overflow
/// The slope of ln(1 + e^-|x|) per piece in Q2.30 is -2^26 to 0, after positive rounding errors are
/// clamped to 0. Per unit of x, in Q1.31, it is -2^30 to 0.
#[inline(always)]
pub(super) fn softplus(x: Fixed) -> (Fixed, Unit) {
    let (tail, slope) = between(&SOFTPLUS, x.to_bits().unsigned_abs());
    let tail = in_units(tail);
    let slope = (slope & (slope >> 31)) << (NODE_BITS + 1);
    let (value, slope) = if x.to_bits() > 0 {
        (Fixed::from_bits(x.to_bits().saturating_add(tail.to_bits())), i32::MAX + slope)
    } else {
        (tail, -slope)
    };
    (value, Unit::from_bits(slope))
}

const WEIBULL_LEAST: i32 = -18;
const WEIBULL_MOST: i32 = 3;
const WEIBULL_NODES: usize = (((WEIBULL_MOST - WEIBULL_LEAST) as usize) << NODE_BITS) + 1;

static WEIBULL: [Node; WEIBULL_NODES] = {
    let mut table = [(0, 0); WEIBULL_NODES];
    let mut index = 0;
    while index < WEIBULL_NODES {
        let x = WEIBULL_LEAST as f64 + index as f64 / (1 << NODE_BITS) as f64;
        let power = series::exp(x);
        table[index] = node(series::one_minus_exp(power), power * series::exp(-power));
        index += 1;
    }
    table
};

/// 1 - e^-e^x; the error is below 16 units.
///
/// # Scaling and overflow
/// Outside the nodes the value is within 3e-8 of 0 or 1. The distance from the first node, x + 18,
/// saturates beyond the last node.
pub(super) fn weibull(x: Fixed) -> Fixed {
    let place = x.to_bits().saturating_sub(WEIBULL_LEAST << 24).max(0);
    in_units(between(&WEIBULL, place as u32).0)
}

/// Bytes of the two tables.
#[cfg(test)]
pub(super) const TABLE_BYTES: usize = (SOFTPLUS_NODES + WEIBULL_NODES) * size_of::<Node>();
