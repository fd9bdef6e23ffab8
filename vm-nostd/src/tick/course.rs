//! A quantity as a linear function of time during a tick.

use crate::scalar::Scalar;

/// A linear function of time during a tick: the mid-tick value, and the change from start to end.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Course<S> {
    pub(crate) middle: S,
    pub(crate) change: S,
}

impl<S: Scalar> Course<S> {
    /// The value `time` ticks after mid-tick, -1/2 to 1/2.
    #[inline(always)]
    pub(crate) fn at(&self, time: S::Part) -> S {
        self.middle + self.change.portion(time)
    }
}
