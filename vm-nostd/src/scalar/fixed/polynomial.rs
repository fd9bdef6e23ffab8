//! Polynomials of a number between -1 and 1.

use super::number::{Fixed, high};

/// Polynomial in x by Horner's scheme, -1 < x < 1, in Q8.24; coefficients from the constant on.
/// Each product is truncated by less than two units: with eight coefficients the error is below 16
/// units.
///
/// # Scaling and overflow
/// x is converted to Q1.31: a product with it is Q9.23 and is doubled to Q8.24. The magnitudes of
/// the coefficients add up to at most 100, which bounds every intermediate sum.
#[inline(always)]
pub(super) fn at(x: Fixed, terms: &[Fixed]) -> Fixed {
    let share = x.to_bits() << 7;
    let terms = terms.iter().map(|term| term.to_bits());
    Fixed::from_bits(terms.rev().fold(0, |value, term| term + (high(share, value) << 1)))
}
