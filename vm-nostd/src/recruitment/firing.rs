//! Firing frequency in natural recruitment: f_env rises linearly with activation U from fmin at the
//! threshold Uth to fmax at U = 1; below Uth it is 0.

use crate::params::FiberType;
use crate::scalar::{Arithmetic, Scalar};
use crate::summed::summed;

summed! {
    /// Firing of one unit.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Firing<S: Scalar> {
        /// Uth.
        pub(super) threshold: S,
        maximum_frequency: S,
        /// (fmax - fmin)/(1 - Uth).
        slope: S::Factor,
    }
}

/// Lower bound of 1 - Uth, for units that are recruited at U = 1 only.
const LEAST_RANGE: f64 = 1e-6;

impl<S: Scalar> Firing<S> {
    pub(super) fn new(fiber_type: &FiberType, threshold: f64) -> Self {
        let FiberType { minimum_frequency, maximum_frequency, .. } = *fiber_type;
        // Use the rounded threshold, so that f_env is fmin there and never below 0.
        let threshold = S::from_f64(threshold);
        let range = Arithmetic::max(1.0 - threshold.to_f64(), LEAST_RANGE);
        Self {
            threshold,
            maximum_frequency: S::from_f64(maximum_frequency),
            slope: S::factor((maximum_frequency - minimum_frequency) / range),
        }
    }

    /// f_env (f0.5) at an activation. Computed downwards from fmax, which is thus exact at U = 1
    /// for any threshold.
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

    /// f_env at the rounded threshold and at U = 1.
    fn at_both_ends<S: Scalar>(fiber_type: &FiberType, threshold: f64) -> [f64; 2] {
        let firing = Firing::<S>::new(fiber_type, threshold);
        [firing.threshold, S::ONE].map(|activation| firing.frequency(activation).to_f64())
    }

    #[test]
    fn a_unit_fires_at_fmin_at_its_threshold_and_at_fmax_at_full_activation() {
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
