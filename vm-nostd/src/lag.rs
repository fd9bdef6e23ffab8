//! A first-order lag towards a target that is constant during a tick.

use crate::scalar::Scalar;
use crate::time_step::TimeStep;

/// `dy/dt = (target - y)/T`, exactly, over half a tick and over a tick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lag<S> {
    half: S,
    whole: S,
}

impl<S: Scalar> Lag<S> {
    /// A lag of `time_constant` s.
    pub(crate) fn new(time_constant: f64, step: TimeStep) -> Self {
        let x = step.seconds() / time_constant;
        let done = |x: f64| S::from_f64(-Scalar::exp_m1(-x));
        Self { half: done(0.5 * x), whole: done(x) }
    }

    /// The value at the middle of the tick.
    pub(crate) fn at_middle(&self, start: S, target: S) -> S {
        start + (target - start) * self.half
    }

    /// The value at the end of the tick.
    pub(crate) fn at_end(&self, start: S, target: S) -> S {
        start + (target - start) * self.whole
    }
}
