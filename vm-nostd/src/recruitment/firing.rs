//! Firing of what is recruited naturally: f_env rises linearly with raw activation, from fmin at
//! the threshold Uth to fmax at U = 1; below Uth it is 0.

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
        // By the threshold that U is compared with: f_env is fmin there, and never below 0.
        let threshold = S::from_f64(threshold);
        let range = Scalar::max(1.0 - threshold.to_f64(), LEAST_RANGE);
        Self {
            threshold,
            maximum_frequency: S::from_f64(maximum_frequency),
            slope: S::factor((maximum_frequency - minimum_frequency) / range),
        }
    }

    /// f_env (f0.5) at a raw activation. From fmax down: it is met at U = 1 however near to that
    /// the threshold is.
    pub(super) fn frequency(&self, activation: S) -> S {
        if activation < self.threshold {
            return S::ZERO;
        }
        self.maximum_frequency - (S::ONE - activation).scaled(&self.slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::paper_table_1::SLOW;
    use crate::scalar::fixed::Fixed;

    /// f_env at the threshold, as U is compared with it, and at U = 1.
    fn at_both_ends<S: Scalar>(fiber_type: &FiberType, threshold: f64) -> [f64; 2] {
        let firing = Firing::<S>::new(fiber_type, threshold);
        [firing.threshold, S::ONE].map(|activation| firing.frequency(activation).to_f64())
    }

    #[test]
    fn from_its_threshold_on_a_unit_fires_from_fmin_to_fmax() {
        for (least, most) in [(0.0, 10.0), (0.5, 2.0)] {
            let t = FiberType { minimum_frequency: least, maximum_frequency: most, ..SLOW };
            for threshold in [0.001, 0.28, 0.6, 0.997, 1.0 - 1e-5] {
                for [at_threshold, at_1] in
                    [at_both_ends::<f32>(&t, threshold), at_both_ends::<Fixed>(&t, threshold)]
                {
                    assert!((at_threshold - least).abs() < 1.5e-6, "{threshold}: {at_threshold}");
                    assert_eq!(at_1, most, "{threshold}");
                }
            }
        }
    }
}
