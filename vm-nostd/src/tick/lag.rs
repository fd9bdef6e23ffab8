//! A first-order lag towards a target that is constant during a tick.

use crate::scalar::Scalar;
use crate::scalar::float::one_minus_exp;
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

summed! {
    /// Exact solution of `dy/dt = (target - y)/T` over half a tick and over a tick.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Lag<S: Scalar> {
        half: S::Share,
        whole: S::Share,
    }

    valid: |lag| [lag.half, lag.whole].into_iter().all(is_share::<S>)
}

/// Whether a share is from 0 to 1.
fn is_share<S: Scalar>(share: S::Share) -> bool {
    let moved = S::of(S::advanced(S::ZERO.wide(), S::ONE, share));
    moved >= S::ZERO && moved <= S::ONE
}

impl<S: Scalar> Lag<S> {
    /// A lag of `time_constant` s.
    pub(crate) fn new(time_constant: f64, step: TimeStep) -> Self {
        let x = step.seconds() / time_constant;
        Self { half: S::share(one_minus_exp(0.5 * x)), whole: S::share(one_minus_exp(x)) }
    }

    /// Value at mid-tick.
    pub(crate) fn at_middle(&self, start: S::Wide, target: S) -> S {
        S::of(S::advanced(start, target - S::of(start), self.half))
    }

    /// Value at the end of the tick.
    pub(crate) fn at_end(&self, start: S::Wide, target: S) -> S::Wide {
        S::advanced(start, target - S::of(start), self.whole)
    }
}
