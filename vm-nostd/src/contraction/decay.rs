//! How velocity goes on from the middle of a substep to its end.
//!
//! Of a velocity that differs from the steady one, damping c leaves e^-z after a substep, z = h c/m
//! with the mass m; and the steady velocity itself moves on as the forces grow. The midpoint rule
//! alone (end = 2 middle - start) leaves (2 - z)/(2 + z) of the difference: with much damping all
//! of it, reversed. With s = z/(2 + z), from 0 to 1 as damping grows, the share of what was gained
//! up to the middle that has to be taken back is fitted by s² (2 + 5 s - 4 s²)/3, which is right at
//! either end and to 0.03 in between; and what the difference adds to the mean velocity by
//! s (1 - s)/2 of that share, to 0.053: it matters where damping is large.

use crate::checksum::summed;
use crate::scalar::Scalar;

/// The coefficients of the fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decay<S> {
    two_thirds: S,
    five_thirds: S,
    four_thirds: S,
}

summed!([S: Scalar] Decay<S> { two_thirds, five_thirds, four_thirds });

/// Velocities (L_ce0/s) at a substep's end, and in its mean, relative to that at its middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left<S> {
    pub(super) end: S,
    pub(super) mean: S,
}

impl<S: Scalar> Decay<S> {
    pub(super) fn new() -> Self {
        Self {
            two_thirds: S::from_f64(2.0 / 3.0),
            five_thirds: S::from_f64(5.0 / 3.0),
            four_thirds: S::from_f64(4.0 / 3.0),
        }
    }

    /// Of a mass over half the substep (`inertia`) and a `damping`, both F0 s/L_ce0: what is left
    /// of the velocity `gained` up to the middle, while the force is `growing` (F0 in half the
    /// substep).
    #[inline(always)]
    pub(super) fn of(&self, inertia: S, damping: S, gained: S, growing: S) -> Left<S> {
        let reciprocal = (inertia + damping).reciprocal();
        let s = damping * reciprocal;
        // What was gained beyond the steady velocity's part; both times s.
        let difference = s * gained - growing * reciprocal;
        let share = s * (self.two_thirds + s * (self.five_thirds - s * self.four_thirds));
        Left {
            end: gained - share * difference,
            mean: s * share * (S::ONE - s).half() * difference,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_damping_leaves_is_what_decays_exponentially_within_3_percent() {
        let decay = Decay::<f64>::new();
        for step in 0..=4000 {
            // Half of z: damping over inertia.
            let y = 1e-4 * 1.005_f64.powi(step);
            // From a velocity of 1 to a steady one of 0, the middle is at 1/(1 + y).
            let gained = 1.0 / (1.0 + y) - 1.0;
            let end = decay.of(1.0, y, gained, 0.0).end / gained;
            let exact = (1.0 - (-2.0 * y).exp() * (1.0 + y)) / y;
            assert!((end - exact).abs() < 0.03, "z {}: {end} {exact}", 2.0 * y);
            let mean = 1.0 / (1.0 + y) + decay.of(1.0, y, gained, 0.0).mean;
            let exact = -(-2.0 * y).exp_m1() / (2.0 * y);
            assert!((mean - exact).abs() < 0.053, "z {}: mean {mean} {exact}", 2.0 * y);
        }
    }

    #[test]
    fn a_steady_velocity_that_grows_is_followed_to_the_end() {
        let decay = Decay::<f64>::new();
        // Much damping, and a velocity that grows by 0.01 in half a substep.
        let left = decay.of(1e-3, 1.0, 0.01, 0.01);
        assert!((left.end - 0.01).abs() < 1e-4 && left.mean.abs() < 1e-6, "{left:?}");
    }
}
