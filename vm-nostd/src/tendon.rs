//! Tendon and aponeurosis: F_se = cT kT ln(exp((L_se - LrT)/kT) + 1).

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::softplus::softplus;

/// Coefficients of the series elastic element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonParams {
    /// Stiffness of the stretched tendon c_T, F0/L_se0; 1 to 200.
    #[doc(alias = "cT")]
    pub stiffness: f64,
    /// Width of the toe region k_T, L_se0; 0.001 to 0.05.
    #[doc(alias = "kT")]
    pub toe: f64,
    /// Slack length L_r^T, L_se0; 0.5 to 1.5.
    #[doc(alias = "LrT")]
    pub slack_length: f64,
}

impl TendonParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("tendon.stiffness", self.stiffness, 1.0, 200.0)?;
        within("tendon.toe", self.toe, 1e-3, 0.05)?;
        within("tendon.slack_length", self.slack_length, 0.5, 1.5)
    }

    /// The tendon length, in L_se0, that carries `force` (F0, more than 0).
    pub(crate) fn length_at(&self, force: f64) -> f64 {
        // ln(exp(x) - 1), without overflow.
        let x = force / (self.stiffness * self.toe);
        self.toe * (x + Scalar::ln(-Scalar::exp_m1(-x))) + self.slack_length
    }
}

/// The tendon of one muscle. Its extension is counted beyond slack and in widths of the toe:
/// (L_se - LrT)/kT.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tendon<S> {
    /// 1/(kT L_se0), per m of path.
    per_path: S,
    /// L_ce0/(kT L_se0), per L_ce0 of fascicle.
    per_fascicle: S,
    /// kT L_se0/L_ce0, L_ce0 of fascicle per extension.
    fascicle_per_extension: S,
    /// 1/L_ce0, and LrT L_se0/L_ce0.
    fascicle_per_path: S,
    slack: S,
    /// cT kT, F0.
    force: S,
    /// cT L_ce0/L_se0, F0 per L_ce0 of fascicle.
    stiffness: S,
}

impl<S: Scalar> Tendon<S> {
    pub(crate) fn new(params: &TendonParams, fascicle_length: f64, tendon_length: f64) -> Self {
        let ratio = fascicle_length / tendon_length;
        Self {
            per_path: S::from_f64(1.0 / (params.toe * tendon_length)),
            per_fascicle: S::from_f64(ratio / params.toe),
            fascicle_per_extension: S::from_f64(params.toe / ratio),
            fascicle_per_path: S::from_f64(1.0 / fascicle_length),
            slack: S::from_f64(params.slack_length / ratio),
            force: S::from_f64(params.stiffness * params.toe),
            stiffness: S::from_f64(params.stiffness * ratio),
        }
    }

    /// Change of extension when the path becomes longer by `path` m.
    pub(crate) fn stretch(&self, path: S) -> S {
        path * self.per_path
    }

    /// Extension after the fascicles have become longer by `lengthening` L_ce0.
    pub(crate) fn give(&self, extension: S, lengthening: S) -> S {
        extension - lengthening * self.per_fascicle
    }

    /// Extension that leaves the fascicles `length` (L_ce0) on a path of `path` m.
    pub(crate) fn extension(&self, path: S, length: S) -> S {
        (path * self.fascicle_per_path - self.slack - length) * self.per_fascicle
    }

    /// Fascicle length (L_ce0) on a path of `path` m with the tendon at an extension.
    pub(crate) fn fascicle_length(&self, path: S, extension: S) -> S {
        path * self.fascicle_per_path - self.slack - extension * self.fascicle_per_extension
    }

    /// Force (F0) at an extension, and by how much it falls per L_ce0 of fascicle length.
    pub(crate) fn pull(&self, extension: S) -> (S, S) {
        let (value, slope) = softplus(extension);
        (self.force * value, self.stiffness * slope)
    }
}
