//! Curves of a built muscle: what its equations give at rates and lengths of the caller's choice.

use crate::domain::{Domain, velocities};
use crate::equations::activation_frequency;
use crate::equations::force_length::{self, Distance};
use crate::equations::passive::{Compression, Parallel};
use crate::equations::tendon::Tendon;
use crate::fiber::Fiber;
use crate::muscle::Muscle;
use crate::recruitment::Recruitment;
use crate::scalar::Scalar;

/// The curves of a muscle, as its ticks compute them: the same kernels, the same rounding. From
/// [`Muscle::curves`].
///
/// ```
/// use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
/// # use vm_nostd::{Class, ContinuousMuscle, FiberParams, MuscleParams, TimeStep};
/// # let params = MuscleParams {
/// #     mass: 97.5e-3, fascicle_length: 0.11, tendon_length: 0.02, max_path_length: 0.184,
/// #     recruitment_saturation: 0.8, class: Class::Standard, elements: ELEMENTS,
/// #     fibers: [
/// #         FiberParams { fraction: 0.6, fiber_type: SLOW },
/// #         FiberParams { fraction: 0.4, fiber_type: FAST },
/// #     ],
/// # };
/// let muscle = ContinuousMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND)?;
/// let curves = muscle.curves();
/// let slow = curves.fiber(0).expect("two types");
/// assert!((slow.force_length(1.0) - 1.0).abs() < 2e-6);
/// assert_eq!(slow.force_velocity(1.0, 0.0), 1.0);
/// assert!(slow.activation_frequency(1.0, 1.0) > 0.4); // at f0.5
/// # Ok::<(), vm_nostd::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Curves<'a, S: Scalar, const N: usize> {
    domain: &'a Domain<S>,
    fibers: &'a [Fiber<S>; N],
    parallel: &'a Parallel<S>,
    compression: &'a Compression<S>,
    tendon: &'a Tendon<S>,
}

impl<S: Scalar, R: Recruitment<S, N>, const N: usize> Muscle<S, R, N> {
    /// The curves of its elements and fibre types.
    pub fn curves(&self) -> Curves<'_, S, N> {
        Curves {
            domain: &self.domain,
            fibers: &self.fibers,
            parallel: &self.parallel,
            compression: &self.compression,
            tendon: &self.contraction.tendon,
        }
    }
}

impl<'a, S: Scalar, const N: usize> Curves<'a, S, N> {
    /// Elastic force F_pe1 of the parallel element at V = 0, in F0, at a fascicle length in L_ce0.
    /// Any length.
    #[doc(alias = "F_pe1")]
    pub fn passive(&self, fascicle_length: S) -> S {
        self.parallel.at(fascicle_length).0
    }

    /// Thick-filament compression F_pe2 at full activation, in F0 and at most 0, at a fascicle
    /// length in L_ce0. Any length.
    #[doc(alias = "F_pe2")]
    pub fn compression(&self, fascicle_length: S) -> S {
        self.compression.at(fascicle_length).0
    }

    /// Tendon force F_se, in F0 and at least 0, on a path in m (in fixed point: µm) with fascicles
    /// of a length in L_ce0: the tendon has the rest of the path.
    #[doc(alias = "F_se")]
    pub fn tendon(&self, path_length: S::PathLength, fascicle_length: S) -> S {
        self.tendon.pull(self.tendon.extension(path_length, fascicle_length)).force
    }

    /// The curves of a fibre type by its index, in the order of
    /// [`MuscleParams::fibers`](crate::MuscleParams::fibers); none beyond the last.
    pub fn fiber(&self, index: usize) -> Option<FiberCurves<'a, S>> {
        let fiber = self.fibers.get(index)?;
        Some(FiberCurves { domain: self.domain, fiber })
    }
}

/// The curves of one fibre type. Fascicle lengths are in L_ce0, and clamped to the
/// [validity range](crate::MuscleParams::fascicle_domain) of the muscle, as in a tick.
#[derive(Clone, Copy, Debug)]
pub struct FiberCurves<'a, S: Scalar> {
    domain: &'a Domain<S>,
    fiber: &'a Fiber<S>,
}

impl<S: Scalar> FiberCurves<'_, S> {
    fn clamped(&self, fascicle_length: S) -> S {
        self.domain.filaments.clip(fascicle_length).0
    }

    /// Force-length relation FL, 0..1.
    #[doc(alias = "FL")]
    pub fn force_length(&self, fascicle_length: S) -> S {
        let distance = Distance::new(self.clamped(fascicle_length));
        let [value] = force_length::at([&self.fiber.force_length], &distance);
        value
    }

    /// Force-velocity relation FV, at least 0: 1 at V = 0, 0 below V_max. The velocity is in
    /// L_ce0/s, positive when lengthening, and clamped to ±60.
    #[doc(alias = "FV")]
    pub fn force_velocity(&self, fascicle_length: S, fascicle_velocity: S) -> S {
        let (velocity, _) = velocities::<S>().clip(fascicle_velocity);
        let curve = self.fiber.force_velocity.at(self.clamped(fascicle_length), S::ZERO);
        if self.fiber.force_velocity.is_beyond(velocity) {
            return S::ZERO;
        }
        self.fiber.force_velocity.on(&curve, S::part(0.0), velocity).value(velocity)
    }

    /// Activation-frequency relation Af, 0..1, at a frequency in f0.5, at least 0: the effective
    /// one times sag and yield, Y S f.
    #[doc(alias = "Af")]
    pub fn activation_frequency(&self, fascicle_length: S, frequency: S) -> S {
        let reciprocal = self.clamped(fascicle_length).reciprocal();
        let [curve] = activation_frequency::curves([&self.fiber.activation], reciprocal);
        curve.at(frequency)
    }
}
