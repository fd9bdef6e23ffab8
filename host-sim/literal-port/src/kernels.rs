//! The libm calls of one evaluation of the right-hand side.

use crate::real::Real;

/// Two softplus, the compression, two force-length and two activation-frequency relations and the
/// yield: 8 exponentials, 2 logarithms and 6 powers, with typical arguments for a fascicle `length`
/// (L_ce0), a `frequency` (f0.5) and a speed (L_ce0/s). The sum of the results keeps every call
/// from being optimised away.
///
/// A lower bound for the cost of a tick that evaluates the paper's equations with libm once.
pub fn kernels_of_one_evaluation<R: Real>(length: R, frequency: R, speed: R) -> R {
    let one = R::of(1.0);
    let mut sum = (length.exp() + one).ln() + (frequency.exp() + one).ln();
    sum = sum + (-length).exp();
    for (beta, rho, exponent) in [(2.3, 1.62, 1.1), (1.55, 2.12, 1.4)] {
        let distance = length.pow(R::of(beta));
        sum = sum + (-distance.pow(R::of(rho))).exp();
        sum = sum + (-frequency.pow(R::of(exponent))).exp();
    }
    sum + (-speed.abs()).exp()
}
