//! Passive elements: F_pe1, parallel to the fascicles, and F_pe2, compression of the thick
//! filaments.

use crate::equations::tendon::{in_toes, softplus_inverse};
use crate::error::{ParameterError, within};
use crate::scalar::{Arithmetic, Kernels, Scalar};
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

/// Coefficients of F_pe1 = c1 k1 ln(exp((L/L_max - Lr1)/k1) + 1) + eta V.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParallelParams {
    /// Stiffness of the stretched element c_1, F0 per L_max; 1 to 200.
    #[doc(alias = "c1")]
    pub stiffness: f64,
    /// Width of the toe region k_1, L_max; 0.01 to 0.3.
    #[doc(alias = "k1")]
    pub toe: f64,
    /// Slack length L_r1, L_max; 0.8 to 1.5.
    #[doc(alias = "Lr1")]
    pub slack_length: f64,
    /// Viscosity eta, F0 s/L_ce0; 0.001 to 1.
    #[doc(alias = "eta")]
    pub viscosity: f64,
}

/// Coefficients of F_pe2 = min(0, c2 (exp(k2 (L - Lr2)) - 1)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CompressionParams {
    /// Strength c_2, F0; -1 to 0, and such that F_pe2 is at least -1,000 F0 at the shortest length
    /// of [`MuscleParams::fascicle_domain`](crate::MuscleParams::fascicle_domain).
    #[doc(alias = "c2")]
    pub strength: f64,
    /// Steepness k_2, 1/L_ce0; -40 to -1.
    #[doc(alias = "k2")]
    pub steepness: f64,
    /// Length below which the filaments are compressed L_r2, L_ce0; 0.4 to 1.
    #[doc(alias = "Lr2")]
    pub onset_length: f64,
}

/// Lower bound of the viscosity. The passive force is linearised within a tick; while a passive
/// muscle rings, the energy error of that would accumulate without damping.
const LEAST_VISCOSITY: f64 = 1e-3;

impl ParallelParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("parallel.stiffness", self.stiffness, 1.0, 200.0)?;
        within("parallel.toe", self.toe, 0.01, 0.3)?;
        within("parallel.slack_length", self.slack_length, 0.8, 1.5)?;
        within("parallel.viscosity", self.viscosity, LEAST_VISCOSITY, 1.0)
    }

    /// Scale of F_pe1, c1 k1, F0.
    pub(crate) fn scale(&self) -> f64 {
        self.stiffness * self.toe
    }

    /// F_pe1 in F0 at V = 0 for a fascicle length in L_max.
    pub(crate) fn force(&self, length: f64) -> f64 {
        self.scale() * ((length - self.slack_length) / self.toe).softplus().0
    }

    /// Fascicle length (L_max) at which F_pe1 is `force` (F0, above 0) at V = 0.
    pub(crate) fn length_at(&self, force: f64) -> f64 {
        self.slack_length + self.toe * softplus_inverse(force / self.scale())
    }
}

impl CompressionParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("compression.strength", self.strength, -1.0, 0.0)?;
        within("compression.steepness", self.steepness, -40.0, -1.0)?;
        within("compression.onset_length", self.onset_length, 0.4, 1.0)
    }
}

impl CompressionParams {
    /// F_pe2 in F0 for a fascicle length in L_ce0.
    pub(crate) fn force(&self, length: f64) -> f64 {
        let growth = Kernels::exp(self.steepness * (length - self.onset_length));
        Arithmetic::min(self.strength * (growth - 1.0), 0.0)
    }
}

summed! {
    /// The elastic part of F_pe1 for one muscle.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Parallel<S: Scalar> {
        /// Lr1 L_max, L_ce0.
        slack_length: S,
        /// 1/(L_max k1).
        per_toe: S::Factor,
        /// c1 k1, F0.
        force: S::Factor,
        /// c1/L_max times the time step, F0 per L_ce0/s and tick.
        stiffness: S::Factor,
    }
}

impl<S: Scalar> Parallel<S> {
    pub(crate) fn new(
        params: &ParallelParams,
        maximum_fascicle_length: f64,
        step: TimeStep,
    ) -> Self {
        Self {
            slack_length: S::from_f64(params.slack_length * maximum_fascicle_length),
            per_toe: S::factor(1.0 / (maximum_fascicle_length * params.toe)),
            force: S::factor(params.scale()),
            stiffness: S::factor(params.stiffness / maximum_fascicle_length * step.seconds()),
        }
    }

    /// Force (F0) at V = 0 and its slope (F0 per L_ce0/s and tick) at a length in L_ce0.
    #[inline(always)]
    pub(crate) fn at(&self, fascicle_length: S) -> (S, S) {
        let (value, slope) = (fascicle_length - self.slack_length).scaled(&self.per_toe).softplus();
        (value.scaled(&self.force), S::ONE.by(slope).scaled(&self.stiffness))
    }

    /// Length (L_ce0) beyond slack in toes, and its softplus: the force at V = 0 in its scale
    /// c1 k1.
    pub(crate) fn in_toes(&self, fascicle_length: S) -> (S, S) {
        in_toes((fascicle_length - self.slack_length).scaled(&self.per_toe))
    }

    /// Force (F0) of a softplus.
    pub(crate) fn force_of(&self, softplus: S) -> S {
        softplus.scaled(&self.force)
    }
}

summed! {
    /// F_pe2, shared by the fibre types and weighted by their activation.
    ///
    /// Computed as |c2| - exp(k2 (L - Lr2) + ln |c2|), so that no term is large.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Compression<S: Scalar> {
        /// |c2|, F0.
        strength: S,
        /// k2.
        steepness: S::Factor,
        /// Length at which the exponential is 1, L_ce0.
        unit_length: S,
        /// -k2 times the time step, per L_ce0/s and tick.
        slope: S::Factor,
    }
}

/// Lower bound of |c2| in its logarithm, F0: negligible even after growing by e^24, as it does with
/// the steepest k2 from the greatest Lr2 to the shortest fascicles.
const NO_STRENGTH: f64 = 1e-24;

impl<S: Scalar> Compression<S> {
    pub(crate) fn new(params: &CompressionParams, step: TimeStep) -> Self {
        let strength = -params.strength;
        let logarithm = Kernels::ln(Arithmetic::max(strength, NO_STRENGTH));
        Self {
            strength: S::from_f64(strength),
            steepness: S::factor(params.steepness),
            unit_length: S::from_f64(params.onset_length - logarithm / params.steepness),
            slope: S::factor(-params.steepness * step.seconds()),
        }
    }

    /// Force (F0, never positive) and its slope (F0 per L_ce0/s and tick) at a length in L_ce0.
    #[inline(always)]
    pub(crate) fn at(&self, fascicle_length: S) -> (S, S) {
        let grown = (fascicle_length - self.unit_length).scaled(&self.steepness).exp();
        let force = self.strength - grown;
        if force < S::ZERO { (force, grown.scaled(&self.slope)) } else { (S::ZERO, S::ZERO) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::fixed::Fixed;

    /// F_pe2 with the steepest growth, at 0.4 L_ce0.
    fn compression<S: Scalar>(strength: f64) -> f64 {
        let params = CompressionParams { strength, steepness: -40.0, onset_length: 1.0 };
        Compression::<S>::new(&params, TimeStep::MILLISECOND).at(S::from_f64(0.4)).0.to_f64()
    }

    #[test]
    fn without_strength_nothing_is_compressed() {
        for found in [compression::<f32>(0.0), compression::<Fixed>(0.0), compression::<f64>(0.0)] {
            assert!(found.abs() < 1e-12, "{found} F0");
        }
        // 1e-12 (1 - e^24)
        for found in [compression::<f32>(-1e-12), compression::<f64>(-1e-12)] {
            assert!((found / -0.026_489 - 1.0).abs() < 1e-4, "{found} F0");
        }
    }
}
