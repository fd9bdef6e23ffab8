//! How velocity goes on from the middle of a substep to its end.
//!
//! Of a velocity that differs from the steady one, damping c leaves e^-z after a substep, z = h c/m
//! with the mass m; and the steady velocity itself moves on as the forces grow. The midpoint rule
//! alone (end = 2 middle - start) leaves (2 - z)/(2 + z) of the difference: with much damping all
//! of it, reversed. With s = z/(2 + z), from 0 to 1 as damping grows, s³ (2 - s) of what was gained
//! up to the middle is taken back, and s (1 - s)/2 of that added to the mean velocity. Pure decay
//! would ask for up to 0.14 more. On a tendon, though, what is left of a velocity rings: a fit of
//! pure decay, s² (2 + 5 s - 4 s²)/3, was measured to make 1.5 to 2 times the error after steps of
//! stimulation frequency.

use crate::scalar::{Balance, Scalar};

/// Velocities (L_ce0/s) at a substep's end, and in its mean, relative to that at its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left<S> {
    pub(super) end: S,
    pub(super) mean: S,
}

/// Of a mass against its damping (`balanced`): what is left of the velocity `gained` up to the
/// middle, while the force is `growing` (F0 in half the substep).
#[inline(always)]
pub(super) fn left<S: Scalar>(balanced: &Balance<S>, gained: S, growing: S) -> Left<S> {
    let s = balanced.damped;
    // What was gained beyond the steady velocity's part, times s.
    let difference = gained.by(s) - growing * balanced.reciprocal;
    let share = S::ONE.by(s);
    let squared = share.by(s);
    let back = (squared + squared - squared.by(s)) * difference;
    Left { end: gained - back, mean: (share - squared).half() * back }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a mass over half the substep, and a damping, both F0 s/L_ce0.
    fn of(inertia: f64, damping: f64) -> Balance<f64> {
        let reciprocal = 1.0 / (inertia + damping);
        Balance { root: 0.0, damped: damping * reciprocal, reciprocal }
    }

    #[test]
    fn what_damping_leaves_is_what_decays_exponentially_within_15_percent() {
        for step in 0..=4000 {
            // Half of z: damping over inertia.
            let y = 1e-4 * 1.005_f64.powi(step);
            // From a velocity of 1 to a steady one of 0, the middle is at 1/(1 + y).
            let gained = 1.0 / (1.0 + y) - 1.0;
            let end = left(&of(1.0, y), gained, 0.0).end / gained;
            let exact = (1.0 - (-2.0 * y).exp() * (1.0 + y)) / y;
            assert!((end - exact).abs() < 0.15, "z {}: {end} {exact}", 2.0 * y);
            let mean = 1.0 / (1.0 + y) + left(&of(1.0, y), gained, 0.0).mean;
            let exact = -(-2.0 * y).exp_m1() / (2.0 * y);
            assert!((mean - exact).abs() < 0.07, "z {}: mean {mean} {exact}", 2.0 * y);
        }
    }

    #[test]
    fn a_steady_velocity_that_grows_is_followed_to_the_end() {
        // Much damping, and a velocity that grows by 0.01 in half a substep.
        let after = left(&of(1e-3, 1.0), 0.01, 0.01);
        assert!((after.end - 0.01).abs() < 1e-4 && after.mean.abs() < 1e-6, "{after:?}");
    }
}
