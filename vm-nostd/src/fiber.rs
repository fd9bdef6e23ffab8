//! A fibre type of a built muscle.

use crate::equations::activation_frequency::ActivationFrequency;
use crate::equations::excitation::Excitation;
use crate::equations::force_length::ForceLength;
use crate::equations::force_velocity::ForceVelocity;
use crate::equations::sag::Sag;
use crate::equations::yielding::Yielding;
use crate::params::FiberParams;
use crate::scalar::Scalar;
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

summed! {
    /// The coefficients of one fibre type.
    #[derive(Clone, Copy, Debug)]
    #[doc(hidden)]
    pub struct Fiber<S: Scalar> {
        pub(crate) excitation: Excitation<S>,
        pub(crate) sag: Sag<S>,
        pub(crate) yielding: Yielding<S>,
        pub(crate) activation: ActivationFrequency<S>,
        pub(crate) force_length: ForceLength<S>,
        pub(crate) force_velocity: ForceVelocity<S>,
    }
}

impl<S: Scalar> Fiber<S> {
    pub(crate) fn new(params: &FiberParams, domain: (f64, f64), step: TimeStep) -> Self {
        let t = &params.fiber_type;
        Self {
            excitation: Excitation::new(&t.excitation, step),
            sag: Sag::new(t.sag.as_ref(), step),
            yielding: Yielding::new(t.yielding.as_ref(), step),
            activation: ActivationFrequency::new(&t.activation),
            force_length: ForceLength::new(&t.force_length, domain),
            force_velocity: ForceVelocity::new(&t.force_velocity),
        }
    }
}
