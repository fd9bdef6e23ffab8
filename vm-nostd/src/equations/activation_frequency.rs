//! Activation-frequency relation: Af = 1 - exp(-(Y S f/(af n_f))^n_f),
//! n_f = nf0 + nf1 (1/L - 1).

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::summed::summed;
use core::array::from_fn;

/// Coefficients of Af.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ActivationParams {
    /// a_f, f0.5; 0.05 to 10.
    #[doc(alias = "af")]
    pub scale: f64,
    /// n_f0; 0.5 to 10.
    #[doc(alias = "nf0")]
    pub exponent: f64,
    /// n_f1; 0 to 20.
    #[doc(alias = "nf1")]
    pub length_dependence: f64,
}

/// Lower bound of n_f: below it Af has no physiological meaning, and at 0 Af is undefined.
const LEAST_EXPONENT: f64 = 0.2;

impl ActivationParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("activation.scale", self.scale, 0.05, 10.0)?;
        within("activation.exponent", self.exponent, 0.5, 10.0)?;
        within("activation.length_dependence", self.length_dependence, 0.0, 20.0)
    }

    /// Refuses exponents that the arithmetic cannot represent at the shortest fascicle length.
    pub(crate) fn validate_magnitudes(
        &self,
        shortest: f64,
        largest: f64,
    ) -> Result<(), ParameterError> {
        let exponent = self.exponent + self.length_dependence * (1.0 / shortest - 1.0);
        within("activation.exponent: n_f at the shortest length", exponent, 0.0, largest)?;
        within("activation.scale: a_f n_f", self.scale * exponent, 0.0, largest)
    }

    /// The longest fascicle length, in L_ce0 and not above `most`, at which n_f is still defined.
    pub(crate) fn longest_length(&self, most: f64) -> f64 {
        let reciprocal = 1.0 + (LEAST_EXPONENT - self.exponent) / self.length_dependence;
        // If n_f1 is 0, the reciprocal is minus infinity: no limit.
        if reciprocal > 1.0 / most { 1.0 / reciprocal } else { most }
    }
}

summed! {
    /// Af of one fibre type.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct ActivationFrequency<S> {
        /// nf0 - nf1 and nf1.
        exponent: [S; 2],
        scale: S,
    }
}

/// Af as a function of frequency at one fascicle length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActivationCurve<S> {
    exponent: S,
    /// 1/(af n_f).
    per_scale: S,
}

impl<S: Scalar> ActivationFrequency<S> {
    pub(crate) fn new(params: &ActivationParams) -> Self {
        Self {
            exponent: [
                S::from_f64(params.exponent - params.length_dependence),
                S::from_f64(params.length_dependence),
            ],
            scale: S::from_f64(params.scale),
        }
    }

    /// n_f, given 1/L.
    pub(crate) fn exponent(&self, reciprocal: S) -> S {
        let [constant, slope] = self.exponent;
        constant + slope * reciprocal
    }
}

/// Af as a function of frequency at one fascicle length, for all types.
#[inline(always)]
pub(crate) fn curves<S: Scalar, const N: usize>(
    types: [&ActivationFrequency<S>; N],
    reciprocal: S,
) -> [ActivationCurve<S>; N] {
    let exponents = types.map(|t| t.exponent(reciprocal));
    let scales: [S; N] = from_fn(|i| types[i].scale * exponents[i]);
    let per_scale = S::reciprocals(scales);
    from_fn(|i| ActivationCurve { exponent: exponents[i], per_scale: per_scale[i] })
}

impl<S: Scalar> ActivationCurve<S> {
    /// Af for an effective frequency Y S f (f0.5, at least 0).
    #[inline(always)]
    pub(crate) fn at(&self, frequency: S) -> S {
        let activation = (self.exponent * frequency.ln_of_product(self.per_scale)).weibull();
        if frequency > S::ZERO { activation } else { S::ZERO }
    }

    /// Af at the length of `other`, at the frequency at which Af is `activation` at this length:
    /// x' = n_f' (x/n_f - ln(n_f'/n_f)) with x = ln(-ln(1 - Af)).
    pub(crate) fn at_other_length(&self, activation: S, other: &Self) -> S {
        if activation <= S::ZERO {
            return S::ZERO;
        }
        let inactive = (S::ONE - activation).max(S::LEAST);
        let x = (-inactive.ln()).max(S::LEAST).ln();
        let ratio = other.exponent.ratio(self.exponent);
        (x * ratio - other.exponent * ratio.ln()).weibull()
    }
}
