//! Steady state under natural continuous recruitment: the activation that holds a force.
//!
//! In steady state V = 0, Y = 1, U_eff = U, f_eff = f_env(U), and the fascicles carry
//! F_se = max(0, Σ U W_i Af_i FL_i + F_pe1 + Σ U W_i Af_i F_pe2).
//! The wanted force gives the tendon's length and with it the fascicles'; U follows by bisection.

use crate::equations::activation_frequency::curves;
use crate::equations::force_length::{self, Distance};
use crate::equations::tendon::TendonInverse;
use crate::error::ParameterError;
use crate::io::Input;
use crate::muscle::ContinuousMuscle;
use crate::params::MuscleParams;
use crate::scalar::Scalar;
use crate::status::Status;
use crate::tick::time_step::TimeStep;

/// Bisections of the activation: to 2^-24.
const HALVINGS: usize = 24;
/// Tolerance within which a force counts as reachable, F0.
const ROUNDING: f64 = 1e-4;

/// The inverse of a muscle under natural continuous recruitment.
///
/// ```
/// use vm_nostd::control::{KNEE, SteadyNatural};
/// let inverse = SteadyNatural::<f32, 2>::build(&KNEE.muscles[1].params())?;
/// // 0.2 F0 near the optimal length.
/// let (activation, status) = inverse.nearest_activation(0.2, 0.32);
/// assert!(status.is_empty() && (0.1..0.8).contains(&activation), "{activation}");
/// # Ok::<(), vm_nostd::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct SteadyNatural<S: Scalar, const N: usize> {
    muscle: ContinuousMuscle<S, N>,
    inverse: TendonInverse<S>,
    rounding: S,
    frequency: S::Quantity,
}

impl<S: Scalar, const N: usize> SteadyNatural<S, N> {
    /// Builds from the parameters of a muscle; refuses what [`ContinuousMuscle`] refuses.
    pub fn build(params: &MuscleParams<N>) -> Result<Self, ParameterError> {
        // The time step has no effect on what is used.
        let muscle = ContinuousMuscle::build(params, TimeStep::MILLISECOND)?;
        let (fascicle, tendon) = (params.fascicle_length, params.tendon_length);
        Ok(Self {
            muscle,
            inverse: TendonInverse::new(&params.elements.tendon, fascicle, tendon),
            rounding: S::from_f64(ROUNDING),
            frequency: S::quantity(0.0),
        })
    }

    /// The least activation whose steady force (F0) on a path is the wanted one; 0 or 1 with
    /// [`Status::FORCE_UNREACHABLE`] where none holds it. Always 24 bisections. A path that is NaN
    /// counts as the longest.
    pub fn nearest_activation(&self, wanted: S, path_length: S::PathLength) -> (S, Status) {
        let m = &self.muscle;
        let input =
            Input { activation: S::ONE, path_length, stimulation_frequency: self.frequency };
        let (input, mut status) = m.domain.admit(input, m.domain.path_length.most);
        let wanted = wanted.max(S::ZERO);
        let tendon = &m.contraction.tendon;
        let extension = self.inverse.extension(wanted);
        let length = tendon.fascicle_length(input.path_length, extension);
        let (length, _) = m.domain.fascicle_length.clip(length);
        let (inside, _) = m.domain.filaments.clip(length);
        let distance = Distance::new(inside);
        let reciprocal = inside.reciprocal();
        let types = m.fibers.each_ref();
        let overlaps = force_length::at(types.map(|t| &t.force_length), &distance);
        let curves = curves(types.map(|t| &t.activation), reciprocal);
        let parallel = m.parallel.at(length).0;
        let compression = m.compression.at(length).0;
        let pull = |activation: S| {
            let mut sum = parallel;
            let steady = m.recruitment.steady(activation);
            for ((((weight, frequency), curve), overlap), fiber) in
                steady.into_iter().zip(&curves).zip(&overlaps).zip(&m.fibers)
            {
                let sag = m.recruitment.steady_sag(fiber, frequency);
                sum = sum + weight * curve.at(frequency * sag) * (*overlap + compression);
            }
            sum
        };
        let (mut least, mut most) = (S::ZERO, S::ONE);
        for _ in 0..HALVINGS {
            let middle = (least + most).half();
            if pull(middle) < wanted { least = middle } else { most = middle }
        }
        let too_much = wanted > S::ZERO && pull(S::ZERO) > wanted + self.rounding;
        let too_little = pull(S::ONE) < wanted - self.rounding;
        status.set(Status::FORCE_UNREACHABLE, too_much || too_little);
        let enough = wanted <= S::ZERO || pull(S::ZERO) >= wanted;
        (if enough { S::ZERO } else { most }, status)
    }
}
