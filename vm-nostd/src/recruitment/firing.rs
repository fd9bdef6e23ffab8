//! Firing of what is recruited naturally: f_env rises linearly with raw activation, from fmin at the
//! threshold Uth to fmax at U = 1; below Uth it is 0.

use crate::checksum::summed;
use crate::params::FiberType;
use crate::scalar::Scalar;

/// Firing of one unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Firing<S: Scalar> {
    /// Uth.
    pub(super) threshold: S,
    maximum_frequency: S,
    /// (fmax - fmin)/(1 - Uth).
    slope: S::Factor,
}

summed!([S: Scalar] Firing<S> { threshold, maximum_frequency, slope });

/// 1 - Uth is not taken as less: what is recruited at U = 1 only fires as all do then.
const LEAST_RANGE: f64 = 1e-6;

impl<S: Scalar> Firing<S> {
    pub(super) fn new(fiber_type: &FiberType, threshold: f64) -> Self {
        let FiberType { minimum_frequency, maximum_frequency, .. } = *fiber_type;
        let range = Scalar::max(1.0 - threshold, LEAST_RANGE);
        Self {
            threshold: S::from_f64(threshold),
            maximum_frequency: S::from_f64(maximum_frequency),
            slope: S::factor((maximum_frequency - minimum_frequency) / range),
        }
    }

    /// f_env (f0.5) at a raw activation. From fmax down: it is met at U = 1 however near to that the
    /// threshold is.
    pub(super) fn frequency(&self, activation: S) -> S {
        if activation < self.threshold {
            return S::ZERO;
        }
        self.maximum_frequency - (S::ONE - activation).scaled(&self.slope)
    }
}
