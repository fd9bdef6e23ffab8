//! The passive elements: F_pe1, in parallel with the fascicles, and F_pe2, the thick filaments.

use crate::error::{ParameterError, within};
use crate::scalar::Scalar;
use crate::softplus::softplus;

/// Coefficients of F_pe1 = c1 k1 ln(exp((L/L_max - Lr1)/k1) + 1) + eta V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParallelParams {
    /// Stiffness of the stretched element c_1, F0 per L_max; 1 to 200.
    #[doc(alias = "c1")]
    pub stiffness: f64,
    /// Width of the toe region k_1, L_max; 0.01 to 0.3.
    #[doc(alias = "k1")]
    pub toe: f64,
    /// Length at which it becomes taut L_r1, L_max; 0.8 to 1.5.
    #[doc(alias = "Lr1")]
    pub slack_length: f64,
    /// Viscosity eta, F0 s/L_ce0; 0 to 1.
    #[doc(alias = "eta")]
    pub viscosity: f64,
}

/// Coefficients of F_pe2 = min(0, c2 (exp(k2 (L - Lr2)) - 1)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompressionParams {
    /// Strength c_2, F0; -1 to 0.
    #[doc(alias = "c2")]
    pub strength: f64,
    /// Steepness k_2, 1/L_ce0; -40 to -1.
    #[doc(alias = "k2")]
    pub steepness: f64,
    /// Length below which the filaments are compressed L_r2, L_ce0; 0.4 to 1.
    #[doc(alias = "Lr2")]
    pub onset_length: f64,
}

impl ParallelParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("parallel.stiffness", self.stiffness, 1.0, 200.0)?;
        within("parallel.toe", self.toe, 0.01, 0.3)?;
        within("parallel.slack_length", self.slack_length, 0.8, 1.5)?;
        within("parallel.viscosity", self.viscosity, 0.0, 1.0)
    }

    /// F_pe1 in F0 at V = 0 for a fascicle length in L_max.
    pub(crate) fn force(&self, length: f64) -> f64 {
        self.stiffness * self.toe * softplus((length - self.slack_length) / self.toe).0
    }
}

impl CompressionParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("compression.strength", self.strength, -1.0, 0.0)?;
        within("compression.steepness", self.steepness, -40.0, -1.0)?;
        within("compression.onset_length", self.onset_length, 0.4, 1.0)
    }
}

/// The elastic part of F_pe1 for one muscle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parallel<S> {
    /// 1/(L_max k1).
    per_fascicle: S,
    /// Lr1/k1.
    slack: S,
    /// c1 k1, F0.
    force: S,
    /// c1/L_max, F0/L_ce0.
    stiffness: S,
}

impl<S: Scalar> Parallel<S> {
    pub(crate) fn new(params: &ParallelParams, maximum_fascicle_length: f64) -> Self {
        Self {
            per_fascicle: S::from_f64(1.0 / (maximum_fascicle_length * params.toe)),
            slack: S::from_f64(params.slack_length / params.toe),
            force: S::from_f64(params.stiffness * params.toe),
            stiffness: S::from_f64(params.stiffness / maximum_fascicle_length),
        }
    }

    /// Force (F0) at V = 0 and its slope (F0/L_ce0) at a fascicle length in L_ce0.
    pub(crate) fn at(&self, fascicle_length: S) -> (S, S) {
        let (value, slope) = softplus(fascicle_length * self.per_fascicle - self.slack);
        (self.force * value, self.stiffness * slope)
    }
}

/// F_pe2, shared by the fibre types; it counts in proportion to their activation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compression<S> {
    strength: S,
    steepness: S,
    onset_length: S,
}

impl<S: Scalar> Compression<S> {
    pub(crate) fn new(params: &CompressionParams) -> Self {
        Self {
            strength: S::from_f64(params.strength),
            steepness: S::from_f64(params.steepness),
            onset_length: S::from_f64(params.onset_length),
        }
    }

    /// Force (F0, never positive) and its slope (F0/L_ce0) at a fascicle length in L_ce0.
    pub(crate) fn at(&self, fascicle_length: S) -> (S, S) {
        let growth = (self.steepness * (fascicle_length - self.onset_length)).exp();
        let force = self.strength * (growth - S::ONE);
        let slope = self.strength * self.steepness * growth;
        if force < S::ZERO { (force, slope) } else { (S::ZERO, S::ZERO) }
    }
}
