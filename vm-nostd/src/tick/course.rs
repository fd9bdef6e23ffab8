//! A quantity that changes linearly during a tick.

use crate::scalar::Scalar;

/// A quantity during a tick: its value at the middle, and its change from start to end.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Course<S> {
    pub(crate) middle: S,
    pub(crate) change: S,
}

impl<S: Scalar> Course<S> {
    /// The value `time` ticks after the middle.
    #[inline(always)]
    pub(crate) fn at(&self, time: S::Part) -> S {
        self.middle + self.change.portion(time)
    }
}
