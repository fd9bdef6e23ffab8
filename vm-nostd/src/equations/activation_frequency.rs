//! Activation-frequency relation: Af = 1 - exp(-(Y S f/(af n_f))^n_f),
//! n_f = nf0 + nf1 (1/L - 1).

use crate::checksum::summed;
use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
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

/// The smallest n_f used: below, Af loses its meaning, and at 0 it is undefined.
const LEAST_EXPONENT: f64 = 0.2;

impl ActivationParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("activation.scale", self.scale, 0.05, 10.0)?;
        within("activation.exponent", self.exponent, 0.5, 10.0)?;
        within("activation.length_dependence", self.length_dependence, 0.0, 20.0)
    }

    /// Refuses exponents that the arithmetic cannot hold at the shortest fascicle length.
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
        // Without dependence on length the reciprocal is minus infinity: no limit.
        if reciprocal > 1.0 / most { 1.0 / reciprocal } else { most }
    }
}

/// Af of one fibre type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ActivationFrequency<S> {
    /// nf0 - nf1 and nf1.
    exponent: [S; 2],
    scale: S,
}

summed!([S: Scalar] ActivationFrequency<S> { exponent, scale });

/// Af at one fascicle length, ready for any frequency.
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

    /// n_f at the fascicle length whose reciprocal is given.
    pub(crate) fn exponent(&self, reciprocal: S) -> S {
        let [constant, slope] = self.exponent;
        constant + slope * reciprocal
    }
}

/// Af of all types at one fascicle length, ready for any frequencies.
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
        let activation = (self.exponent * (frequency * self.per_scale).ln()).weibull();
        if frequency > S::ZERO { activation } else { S::ZERO }
    }

    /// Af at another length, at the frequency that makes it `value` here:
    /// x' = n_f' (x/n_f - ln(n_f'/n_f)) with x = ln(-ln(1 - Af)).
    pub(crate) fn moved(&self, value: S, to: &Self) -> S {
        if value <= S::ZERO {
            return S::ZERO;
        }
        let left = (S::ONE - value).max(S::LEAST);
        let x = (-left.ln()).max(S::LEAST).ln();
        let ratio = to.exponent.ratio(self.exponent);
        (x * ratio - to.exponent * ratio.ln()).weibull()
    }
}
