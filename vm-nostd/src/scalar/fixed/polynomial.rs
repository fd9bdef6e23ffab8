//! Polynomials of a number between -1 and 1.

use super::number::high;

/// Polynomial in x by Horner's scheme, -1 < x < 1, in Q8.24; coefficients from the constant on.
/// Each product is truncated by less than two units: with eight coefficients the error is below 16
/// units.
///
/// # Scaling and overflow
/// x is converted to Q1.31: a product with it is Q9.23 and is doubled to Q8.24. The magnitudes of
/// the coefficients add up to at most 100, which bounds every intermediate sum.
#[inline(always)]
pub(super) fn at(x: i32, terms: impl DoubleEndedIterator<Item = i32>) -> i32 {
    let share = x << 7;
    terms.rev().fold(0, |value, term| term + (high(share, value) << 1))
}

#[cfg(test)]
mod tests {
    use super::super::exhaustive::{UNIT, random_numbers};
    use super::*;

    #[test]
    fn polynomials_are_within_their_bounds() {
        let mut terms = random_numbers().map(|bits| bits >> 4);
        for _ in 0..2_000 {
            let terms: [i32; 8] = core::array::from_fn(|_| terms.next().expect("endless"));
            for x in random_numbers().map(|bits| bits >> 7).take(100) {
                let value = at(x, terms.into_iter());
                let x = f64::from(x) / UNIT;
                let exact =
                    terms.into_iter().rev().fold(0.0, |sum, term| f64::from(term) + sum * x);
                assert!((f64::from(value) - exact).abs() <= 16.0, "{terms:?} of {x}");
            }
        }
    }
}
