//! Force-length relation of the filaments: FL = exp(-|(L^beta - 1)/omega|^rho).

use crate::checksum::summed;
use crate::error::{ParameterError, within};
use crate::scalar::Scalar;

/// Coefficients of FL.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceLengthParams {
    /// Width omega; 0.1 to 10.
    #[doc(alias = "omega")]
    pub width: f64,
    /// Skewness beta; 0.1 to 10.
    #[doc(alias = "beta")]
    pub skewness: f64,
    /// Roundness rho; 1 to 10.
    #[doc(alias = "rho")]
    pub roundness: f64,
}

impl ForceLengthParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("force_length.width", self.width, 0.1, 10.0)?;
        within("force_length.skewness", self.skewness, 0.1, 10.0)?;
        within("force_length.roundness", self.roundness, 1.0, 10.0)
    }
}

/// FL of one fibre type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceLength<S: Scalar> {
    skewness: S,
    roundness: S,
    /// 1/omega.
    per_width: S::Factor,
}

summed!([S: Scalar] ForceLength<S> { skewness, roundness, per_width });

impl<S: Scalar> ForceLength<S> {
    pub(crate) fn new(params: &ForceLengthParams) -> Self {
        Self {
            skewness: S::from_f64(params.skewness),
            roundness: S::from_f64(params.roundness),
            per_width: S::factor(1.0 / params.width),
        }
    }

    /// FL (0..1) and its slope (1/L_ce0) from the fascicle length's logarithm and reciprocal.
    #[inline(always)]
    pub(crate) fn at(&self, logarithm: S, reciprocal: S) -> (S, S) {
        let power = (self.skewness * logarithm).exp();
        let offset = (power - S::ONE).scaled(&self.per_width);
        // Keeps the logarithm in its domain; so near to the optimum FL is 1.
        let distance = offset.abs().max(S::LEAST);
        let (lost, growth) = (self.roundness * distance.ln()).weibull();
        // By ln |z| it is rho times the growth, with d ln|z|/dL = beta L^beta / (L omega |z|).
        let turned = (self.skewness * reciprocal * power).scaled(&self.per_width);
        let slope = (self.roundness * growth).ratio(distance) * turned;
        (S::ONE - lost, if offset < S::ZERO { slope } else { -slope })
    }
}
