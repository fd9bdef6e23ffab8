//! Polynomials of a number between -1 and 1.

use super::number::high;

/// The polynomial with terms by powers of x, the constant first, and its slope, in Q8.24, for x in
/// Q8.24 between -1 and 1. Each product is cut by less than two units: of eight terms, the value is
/// within 16 units, and the slope, in which every cut value is multiplied again, within 72.
///
/// # Scaling and overflow
/// x becomes a share in Q1.31: a product with it is Q9.23 before it is doubled. Magnitudes of
/// terms, and of the slope's terms, add to 100 at most: so does what is summed up at any step.
#[inline(always)]
pub(super) fn at(x: i32, terms: impl DoubleEndedIterator<Item = i32>) -> (i32, i32) {
    let share = x << 7;
    let times = |value: i32| high(share, value) << 1;
    let (mut value, mut slope) = (0, 0);
    for term in terms.rev() {
        slope = value + times(slope);
        value = term + times(value);
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::super::every::{UNIT, of_any_length};
    use super::*;

    #[test]
    fn polynomials_and_their_slopes_are_within_their_bounds() {
        let mut terms = of_any_length().map(|bits| bits >> 4);
        for _ in 0..2_000 {
            let terms: [i32; 8] = core::array::from_fn(|_| terms.next().expect("endless"));
            for x in of_any_length().map(|bits| bits >> 7).take(100) {
                let (value, slope) = at(x, terms.into_iter());
                let x = f64::from(x) / UNIT;
                let (mut exact, mut steep) = (0.0, 0.0);
                for term in terms.into_iter().rev() {
                    steep = exact + steep * x;
                    exact = f64::from(term) + exact * x;
                }
                assert!((f64::from(value) - exact).abs() <= 16.0, "{terms:?} of {x}");
                assert!((f64::from(slope) - steep).abs() <= 72.0, "{terms:?} of {x}");
            }
        }
    }
}
