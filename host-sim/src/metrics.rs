//! Error of a force trace.

use crate::reference::Sample;

/// Error of a force trace, in % of F0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceError {
    /// Largest absolute difference.
    pub max: f64,
    /// Root of the mean squared difference.
    pub rms: f64,
    /// Mean difference.
    pub bias: f64,
}

impl ForceError {
    /// Error of `forces` against `expected` (N), relative to the maximal force `f0` (N).
    ///
    /// # Panics
    /// If the traces are empty or of different lengths.
    pub fn between(forces: &[f64], expected: &[f64], f0: f64) -> Self {
        assert_eq!(forces.len(), expected.len(), "traces of one length");
        assert!(!forces.is_empty(), "traces with samples");
        let (mut max, mut squares, mut sum) = (0.0_f64, 0.0, 0.0);
        for (force, expected) in forces.iter().zip(expected) {
            let error = (force - expected) / f0 * 100.0;
            max = max.max(error.abs());
            squares += error * error;
            sum += error;
        }
        let count = forces.len() as f64;
        // `f64::max` ignores NaN; the sum does not.
        let max = if sum.is_nan() { f64::NAN } else { max };
        Self { max, rms: (squares / count).sqrt(), bias: sum / count }
    }
}

/// The forces of a run's samples, N.
pub fn forces<'a>(samples: impl IntoIterator<Item = &'a Sample>) -> Vec<f64> {
    samples.into_iter().map(|sample| sample.force).collect()
}
