//! `ln(exp(x) + 1)` and its slope: the shape of the tendon and of the parallel elastic element.

use crate::scalar::Scalar;

/// Value and slope of `ln(exp(x) + 1)`, from one exponential and without overflow.
///
/// The slope is the logistic function of `x`, 0..1.
pub(crate) fn softplus<S: Scalar>(x: S) -> (S, S) {
    let decay = (-x.abs()).exp();
    // Far below 0 the value itself is tiny, and what balances two such forces is their ratio.
    let tail = decay.ln_1p();
    let share = S::ONE / (S::ONE + decay);
    if x > S::ZERO { (x + tail, share) } else { (tail, decay * share) }
}
