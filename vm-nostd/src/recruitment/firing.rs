//! Firing of what is recruited naturally: f_env rises linearly with raw activation, from fmin at the
//! threshold Uth to fmax at U = 1; below Uth it is 0.

use crate::params::FiberType;
use crate::scalar::Scalar;

/// Firing of one unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Firing<S: Scalar> {
    /// Uth.
    pub(super) threshold: S,
    /// fmin.
    minimum_frequency: S,
    /// (fmax - fmin)/(1 - Uth).
    slope: S::Factor,
}

impl<S: Scalar> Firing<S> {
    pub(super) fn new(fiber_type: &FiberType, threshold: f64) -> Self {
        let FiberType { minimum_frequency, maximum_frequency, .. } = *fiber_type;
        // What is only recruited at U = 1 fires as all do then.
        let (least, slope) = if threshold < 1.0 {
            (minimum_frequency, (maximum_frequency - minimum_frequency) / (1.0 - threshold))
        } else {
            (maximum_frequency, 0.0)
        };
        Self {
            threshold: S::from_f64(threshold),
            minimum_frequency: S::from_f64(least),
            slope: S::factor(slope),
        }
    }

    /// f_env (f0.5) at a raw activation.
    pub(super) fn frequency(&self, activation: S) -> S {
        if activation >= self.threshold {
            self.minimum_frequency + (activation - self.threshold).scaled(&self.slope)
        } else {
            S::ZERO
        }
    }
}
