//! Tendon and aponeurosis: F_se = cT kT ln(exp((L_se - LrT)/kT) + 1).

use crate::error::{ParameterError, within};
use crate::scalar::constant::Constant;
use crate::scalar::float::one_minus_exp;
use crate::scalar::{Kernels, Scalar};
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

/// Coefficients of the series elastic element.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Scale of F_se, cT kT, F0.
    pub(crate) fn scale(&self) -> f64 {
        self.stiffness * self.toe
    }

    /// Tendon length (L_se0) at which F_se is `force` (F0, above 0).
    pub(crate) fn length_at(&self, force: f64) -> f64 {
        self.toe * softplus_inverse(force / self.scale()) + self.slack_length
    }

    /// F_se in F0 for a tendon length in L_se0.
    pub(crate) fn force(&self, length: f64) -> f64 {
        self.scale() * ((length - self.slack_length) / self.toe).softplus().0
    }
}

/// ln(exp(x) - 1) for x above 0, without overflow.
pub(crate) fn softplus_inverse(x: f64) -> f64 {
    x + Kernels::ln(one_minus_exp(x))
}

summed! {
    /// Tendon of one muscle. Extensions beyond slack are in L_ce0, like fascicle lengths.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Tendon<S: Scalar> {
        /// LrT L_se0: the slack length, m.
        slack_path: S::PathLength,
        /// 1/L_ce0, per m.
        per_path: S::Factor,
        /// L_ce0/(kT L_se0).
        per_toe: S::Factor,
        /// cT kT, F0.
        force: S::Factor,
        /// cT L_ce0/L_se0 times the time step, F0 per L_ce0/s and tick.
        stiffness: S::Factor,
    }
}

/// Tendon force and stiffness at an extension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<S: Scalar> {
    /// F0.
    pub(crate) force: S,
    /// Share of the taut tendon's stiffness, 0..1.
    pub(crate) tautness: S::Unit,
    /// Decrease of force per tick if the fascicles lengthen at 1 L_ce0/s, F0.
    pub(crate) stiffness: S,
    /// The extension saturated.
    pub(crate) saturated: bool,
}

summed! {
    /// Inverse of F_se: extension = kT (x + ln(1 - exp(-x))), x = F_se/(cT kT).
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct TendonInverse<S: Scalar> {
        /// 1/(cT kT), per F0.
        per_force: S::Factor,
        /// kT L_se0/L_ce0.
        toe: S::Factor,
    }
}

impl<S: Scalar> TendonInverse<S> {
    pub(crate) fn new(params: &TendonParams, fascicle_length: f64, tendon_length: f64) -> Self {
        Self {
            per_force: S::factor(1.0 / params.scale()),
            toe: S::factor(params.toe * tendon_length / fascicle_length),
        }
    }

    /// Extension (L_ce0) at a force (F0), at least the smallest representable force.
    pub(crate) fn extension(&self, force: S) -> S {
        let toes = force.max(S::LEAST).scaled(&self.per_force).max(S::LEAST);
        (toes + (S::ONE - (-toes).exp()).max(S::LEAST).ln()).scaled(&self.toe)
    }
}

impl<S: Scalar> Tendon<S> {
    pub(crate) fn new(
        params: &TendonParams,
        fascicle_length: f64,
        tendon_length: f64,
        step: TimeStep,
    ) -> Self {
        let ratio = fascicle_length / tendon_length;
        Self {
            slack_path: S::path_length(params.slack_length * tendon_length),
            per_path: S::per_metre(1.0 / fascicle_length),
            per_toe: S::factor(ratio / params.toe),
            force: S::factor(params.scale()),
            stiffness: S::factor(params.stiffness * ratio * step.seconds()),
        }
    }

    /// Change of extension (L_ce0) at constant fascicle length if the path changes from `before` to
    /// `after`.
    pub(crate) fn stretch(&self, before: S::PathLength, after: S::PathLength) -> S {
        S::path_change(before, after, self.slack_path, &self.per_path)
    }

    /// Extension (L_ce0) at a path length and a fascicle length (L_ce0).
    pub(crate) fn extension(&self, path: S::PathLength, length: S) -> S {
        S::path_difference(path, self.slack_path, &self.per_path) - length
    }

    /// Fascicle length (L_ce0) at a path length and an extension (L_ce0).
    pub(crate) fn fascicle_length(&self, path: S::PathLength, extension: S) -> S {
        S::path_difference(path, self.slack_path, &self.per_path) - extension
    }

    /// Force and stiffness at an extension (L_ce0).
    #[inline(always)]
    pub(crate) fn pull(&self, extension: S) -> Pull<S> {
        let toes = extension.scaled(&self.per_toe);
        let (value, slope) = toes.softplus();
        let force = value.scaled(&self.force);
        Pull {
            force,
            tautness: slope,
            stiffness: S::ONE.by(slope).scaled(&self.stiffness),
            saturated: toes.is_saturated() || force.is_saturated(),
        }
    }

    /// Extension (L_ce0) in toes, and its softplus: the force in its scale cT kT.
    pub(crate) fn in_toes(&self, extension: S) -> (S, S) {
        in_toes(extension.scaled(&self.per_toe))
    }

    /// Force (F0) of a softplus.
    pub(crate) fn force_of(&self, softplus: S) -> S {
        softplus.scaled(&self.force)
    }
}

/// A length in toes, and its softplus.
pub(crate) fn in_toes<S: Scalar>(toes: S) -> (S, S) {
    (toes, toes.softplus().0)
}

/// Below it, in toes, the logarithm of a softplus is taken: x less half the softplus, to 2e-5.
const SLACK: Constant = Constant::new(-4.0);

/// Logarithm of a softplus of `toes`, if it is nearly exponential. In fixed point it resolves
/// forces that are only some increments.
pub(crate) fn logarithm<S: Scalar>((toes, softplus): (S, S)) -> Option<S> {
    (toes < S::constant(&SLACK)).then(|| toes - softplus.half())
}
