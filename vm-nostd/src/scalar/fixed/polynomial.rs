//! Polynomials of a number between -1 and 1.

use super::number::high;

/// The polynomial with terms by powers of x, the constant first, in Q8.24, for x in Q8.24 between
/// -1 and 1. Each product is cut by less than two units: of eight terms, the value is within 16
/// units.
/// # Scaling and overflow
/// x becomes a share in Q1.31: a product with it is Q9.23 before it is doubled. Magnitudes of
/// terms add to 100 at most: so does what is summed up at any step.
#[inline(always)]
pub(super) fn at(x: i32, terms: impl DoubleEndedIterator<Item = i32>) -> i32 {
    let share = x << 7;
    terms.rev().fold(0, |value, term| term + (high(share, value) << 1))
}

#[cfg(test)]
mod tests {
    use super::super::every::{UNIT, of_any_length};
    use super::*;

    #[test]
    fn polynomials_are_within_their_bounds() {
        let mut terms = of_any_length().map(|bits| bits >> 4);
        for _ in 0..2_000 {
            let terms: [i32; 8] = core::array::from_fn(|_| terms.next().expect("endless"));
            for x in of_any_length().map(|bits| bits >> 7).take(100) {
                let value = at(x, terms.into_iter());
                let x = f64::from(x) / UNIT;
                let exact =
                    terms.into_iter().rev().fold(0.0, |sum, term| f64::from(term) + sum * x);
                assert!((f64::from(value) - exact).abs() <= 16.0, "{terms:?} of {x}");
            }
        }
    }
}
