//! Steady state under intramuscular FES: the force of a stimulation, and the inverse.
//!
//! In steady state V = 0, Y = 1, FV = 1, f_eff = U, S = a_S2 of a firing type, and tendon and
//! fascicles are in equilibrium:
//!
//! F_se = max(0, U Σ pcsa_i Af_i FL_i + max(0, F_pe1 + Σ pcsa_i Af_i F_pe2)).
//!
//! The inverse of F_se gives the tendon length for a requested force, and with it the fascicle
//! length; then only U is unknown. The inverse model needs no search. If the force is unreachable,
//! the nearest one is found by bisection; if the tendon is so long that there may be several
//! equilibria, the result is checked by bisection.

use crate::domain::Domain;
use crate::equations::activation_frequency::{self, ActivationFrequency};
use crate::equations::force_length::{self, Distance, ForceLength};
use crate::equations::passive::{Compression, Parallel};
use crate::equations::sag::FIRING;
use crate::equations::tendon::{Tendon, TendonInverse};
use crate::error::ParameterError;
use crate::io::Input;
use crate::muscle::FesMuscle;
use crate::params::MuscleParams;
use crate::scalar::Scalar;
use crate::status::Status;
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

summed! {
    /// Steady state of a muscle under intramuscular FES.
    ///
    /// ```
    /// use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
    /// use vm_nostd::{Class, FiberParams, MuscleParams, Status, SteadyFes};
    /// use vm_nostd::{RecruitmentCurve, RecruitmentCurveParams};
    ///
    /// # let fibers = [
    /// #     FiberParams { fraction: 0.6, fiber_type: SLOW },
    /// #     FiberParams { fraction: 0.4, fiber_type: FAST },
    /// # ];
    /// # let params = MuscleParams {
    /// #     mass: 97.5e-3, fascicle_length: 0.11, tendon_length: 0.02, max_path_length: 0.184,
    /// #     recruitment_saturation: 0.8, class: Class::Standard, elements: ELEMENTS, fibers,
    /// # };
    /// let steady = SteadyFes::<f32, 2>::build(&params)?;
    /// let curve = RecruitmentCurve::<f32>::build(&RecruitmentCurveParams {
    ///     threshold: 1e-3,  // A
    ///     saturation: 6e-3, // A
    ///     chronaxie: 2e-4,  // s
    ///     slope: 2.0,
    /// })?;
    /// // Pulse width at 10 mA that holds 60 N at 16 cm and 20 pps.
    /// let wanted = steady.activation_for(60.0, 0.16, 20.0);
    /// assert_eq!(wanted.status, Status::empty());
    /// let (width, status) = curve.width_for(wanted.activation, 10.0);
    /// assert!(status.is_empty() && (50.0..200.0).contains(&width));
    /// // 500 N is more than this muscle can hold.
    /// assert_eq!(steady.activation_for(500.0, 0.16, 20.0).status, Status::FORCE_UNREACHABLE);
    /// # Ok::<(), vm_nostd::ParameterError>(())
    /// ```
    #[derive(Clone, Copy, Debug)]
    pub struct SteadyFes<S: Scalar, const N: usize> {
        domain: Domain<S>,
        fibers: [SteadyFiber<S>; N],
        parallel: Parallel<S>,
        compression: Compression<S>,
        tendon: Tendon<S>,
        tendon_inverse: TendonInverse<S>,
        rounding: S,
        /// Rounding tolerance of a force in N or mN: half a step.
        rounding_of_force: S,
        promised: S,
        /// There may be more than one equilibrium.
        ambiguous: bool,
        /// F0, and its reciprocal.
        force: S::Factor,
        per_force: S::Factor,
    }
}

summed! {
    #[derive(Clone, Copy, Debug)]
    struct SteadyFiber<S: Scalar> {
        fraction: S,
        activation: ActivationFrequency<S>,
        force_length: ForceLength<S>,
        /// S at rest and firing.
        sag: [S; 2],
        /// 1/f0.5, s.
        per_half_force_frequency: S::Factor,
    }
}

/// A steady state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady<S: Scalar> {
    /// Activation U, 0..1.
    pub activation: S,
    /// The tendon's force, N (in fixed point: mN).
    pub force: S::Force,
    /// Tendon force relative to F0: in fixed point with an ULP of 6e-8 F0.
    pub relative_force: S,
    /// L, L_ce0.
    pub fascicle_length: S,
    /// Flags; [`Status::FORCE_UNREACHABLE`] if no activation gives the requested force.
    pub status: Status,
}

/// Fascicles and their forces.
#[derive(Clone, Copy, Debug)]
struct Balance<S> {
    /// U Σ pcsa Af FL for U = 1, F0.
    active: S,
    /// max(0, F_pe1 + Σ pcsa Af F_pe2), F0.
    passive: S,
    /// F_se, F0, and whether it saturated.
    tendon: S,
    saturated: bool,
    fascicle_length: S,
}

impl<S: Scalar> Steady<S> {
    fn unreachable(self, unreachable: bool) -> Self {
        let mut status = self.status;
        status.set(Status::FORCE_UNREACHABLE, unreachable);
        Self { status, ..self }
    }
}

/// Number of bisections that resolve a length to its last bit.
const HALVINGS: usize = 40;
/// Tolerance within which a force counts as reachable, F0: a tenth of the promised accuracy.
const ROUNDING: f64 = 1e-4;
/// Tolerance of the steady force, F0.
const PROMISED: f64 = 1e-3;
/// Above this tendon length, in fascicle lengths, the descending limb of FL may be steeper than the
/// tendon is stiff: there may be several equilibria, some unstable.
const LONGEST_PLAIN_TENDON: f64 = 5.0;

impl<S: Scalar, const N: usize> SteadyFes<S, N> {
    /// Builds from the parameters of a muscle; refuses what [`FesMuscle`] refuses.
    pub fn build(params: &MuscleParams<N>) -> Result<Self, ParameterError> {
        // The time step has no effect here.
        let step = TimeStep::MILLISECOND;
        FesMuscle::<S, N>::build(params, step)?;
        let elements = &params.elements;
        let newtons = params.max_isometric_force();
        let (fascicle, tendon) = (params.fascicle_length, params.tendon_length);
        Ok(Self {
            domain: Domain::new(params),
            fibers: params.fibers.map(|fiber| {
                let t = &fiber.fiber_type;
                let sag = t.sag.map_or([1.0; 2], |sag| [sag.resting_level, sag.firing_level]);
                SteadyFiber {
                    fraction: S::from_f64(fiber.fraction),
                    activation: ActivationFrequency::new(&t.activation),
                    force_length: ForceLength::new(&t.force_length, params.fascicle_domain()),
                    sag: sag.map(S::from_f64),
                    per_half_force_frequency: S::per_quantity(1.0 / t.half_force_frequency),
                }
            }),
            parallel: Parallel::new(&elements.parallel, params.maximum_fascicle_length(), step),
            compression: Compression::new(&elements.compression, step),
            tendon: Tendon::new(&elements.tendon, fascicle, tendon, step),
            tendon_inverse: TendonInverse::new(&elements.tendon, fascicle, tendon),
            rounding: S::from_f64(ROUNDING),
            rounding_of_force: S::from_f64(ROUNDING + 0.5 * S::FORCE_STEP / newtons),
            promised: S::from_f64(PROMISED),
            ambiguous: tendon > LONGEST_PLAIN_TENDON * fascicle,
            force: S::force_factor(newtons),
            per_force: S::per_newton(1.0 / newtons),
        })
    }

    /// Steady force of an input. A path that is NaN counts as the longest.
    pub fn force(&self, input: Input<S>) -> Steady<S> {
        let (input, status) = self.domain.admit(input, self.domain.path_length.most);
        self.settled(input, status)
    }

    /// Activation with a given steady force (N; in fixed point mN) on a path at a stimulation
    /// frequency, within 0.1 % of F0. If there is none, the status is flagged, and activation and
    /// force are the nearest ones. A force that is NaN counts as 0, a path as the longest.
    pub fn activation_for(
        &self,
        force: S::Force,
        path_length: S::PathLength,
        stimulation_frequency: S::Quantity,
    ) -> Steady<S> {
        let wanted = S::of_force(force, &self.per_force);
        let rounding = self.rounding_of_force;
        self.holding(wanted, rounding, path_length, stimulation_frequency)
    }

    /// The same for a force relative to F0. In fixed point its resolution is finer than 1 mN if F0
    /// is a few newtons.
    pub fn activation_for_relative(
        &self,
        wanted: S,
        path_length: S::PathLength,
        stimulation_frequency: S::Quantity,
    ) -> Steady<S> {
        self.holding(wanted, self.rounding, path_length, stimulation_frequency)
    }

    /// Activation whose steady force (F0) is nearest to the wanted one, from a single evaluation: 0
    /// or 1 with [`Status::FORCE_UNREACHABLE`] where no activation holds it at the length that the
    /// fascicles would have. For controllers, which ask in every tick; tendons as long as five
    /// fascicles may have other equilibria, which are not looked for.
    pub fn nearest_activation(
        &self,
        wanted: S,
        path_length: S::PathLength,
        stimulation_frequency: S::Quantity,
    ) -> (S, Status) {
        let input = Input { activation: S::ONE, path_length, stimulation_frequency };
        let (input, mut status) = self.domain.admit(input, self.domain.path_length.most);
        let wanted = wanted.max(S::ZERO);
        let extension = self.tendon_inverse.extension(wanted);
        let balance = self.balance(&input, extension);
        let missing = wanted - balance.passive;
        // No force is held by no activation, however slack.
        let unreachable = missing < -self.rounding && wanted > S::ZERO
            || missing > balance.active + self.rounding;
        status.set(Status::FORCE_UNREACHABLE, unreachable);
        let share = missing.max(S::ZERO).ratio(balance.active.max(self.rounding));
        (share.min(S::ONE), status)
    }

    /// Steady state at a force (F0); one outside the reachable range by up to `rounding` counts as
    /// reachable.
    fn holding(
        &self,
        wanted: S,
        rounding: S,
        path_length: S::PathLength,
        stimulation_frequency: S::Quantity,
    ) -> Steady<S> {
        let input = Input { activation: S::ONE, path_length, stimulation_frequency };
        let (input, status) = self.domain.admit(input, self.domain.path_length.most);
        match self.balanced(wanted, &input, status) {
            Some(found) if !self.ambiguous => found,
            Some(found) => {
                let held = self.settled(Input { activation: found.activation, ..input }, status);
                let error = (held.relative_force - wanted).abs();
                held.unreachable(error > self.promised)
            }
            None => {
                let none = self.settled(Input { activation: S::ZERO, ..input }, status);
                let all = self.settled(input, status);
                let [least, most] = [none, all].map(|end| end.relative_force);
                let (end, reached) =
                    if wanted - least > most - wanted { (all, most) } else { (none, least) };
                let near = (wanted - reached).abs() <= rounding;
                end.unreachable(!near)
            }
        }
    }

    /// Activation in equilibrium with a force, if there is one.
    fn balanced(&self, wanted: S, input: &Input<S>, status: Status) -> Option<Steady<S>> {
        let extension = self.tendon_inverse.extension(wanted);
        let length = self.tendon.fascicle_length(input.path_length, extension);
        let balance = self.balance(input, extension);
        let missing = wanted - balance.passive;
        // No tendon length for a force of 0, or for one that leaves no room for fascicles.
        let possible = wanted > S::ZERO && self.domain.fascicle_length.contains(length);
        if possible && missing >= S::ZERO && missing <= balance.active {
            let activation = missing.ratio(balance.active.max(S::LEAST)).min(S::ONE);
            Some(self.steady(activation, balance, status))
        } else {
            None
        }
    }

    fn steady(&self, activation: S, balance: Balance<S>, status: Status) -> Steady<S> {
        let outside = !self.domain.filaments.contains(balance.fascicle_length);
        let mut status = status;
        status.set(Status::FASCICLE_OUTSIDE_DOMAIN, outside);
        status.set(Status::TENDON_FORCE_LIMITED, balance.saturated);
        Steady {
            activation,
            force: balance.tendon.force(&self.force),
            relative_force: balance.tendon,
            fascicle_length: balance.fascicle_length,
            status,
        }
    }

    /// Equilibrium of an admitted input by bisection: the net force is monotonic in the extension,
    /// except with the longest tendons.
    fn settled(&self, input: Input<S>, status: Status) -> Steady<S> {
        let lengths = &self.domain.fascicle_length;
        let mut least = self.tendon.extension(input.path_length, lengths.most);
        let mut most = self.tendon.extension(input.path_length, lengths.least);
        // Whether each end has moved.
        let (mut longer, mut shorter) = (false, false);
        for _ in 0..HALVINGS {
            let extension = (least + most).half();
            let balance = self.balance(&input, extension);
            if balance.tendon > input.activation * balance.active + balance.passive {
                (most, longer) = (extension, true);
            } else {
                (least, shorter) = (extension, true);
            }
        }
        let balance = self.balance(&input, (least + most).half());
        let mut steady = self.steady(input.activation, balance, status);
        steady.status.set(Status::FASCICLE_LENGTH_LIMITED, !(longer && shorter));
        steady
    }

    /// Forces at a tendon extension.
    fn balance(&self, input: &Input<S>, extension: S) -> Balance<S> {
        let fascicle_length = self.tendon.fascicle_length(input.path_length, extension);
        let (length, _) = self.domain.fascicle_length.clip(fascicle_length);
        let (inside, _) = self.domain.filaments.clip(length);
        let reciprocal = inside.reciprocal();
        let distance = Distance::new(inside);
        let (mut active, mut compressed) = (S::ZERO, S::ZERO);
        for fiber in &self.fibers {
            let per = &fiber.per_half_force_frequency;
            let frequency = S::of_quantity(input.stimulation_frequency, per);
            let sag = fiber.sag[usize::from(frequency > S::constant(&FIRING))];
            let [curve] = activation_frequency::curves([&fiber.activation], reciprocal);
            let activation = curve.at(frequency * sag);
            let share = fiber.fraction * activation;
            let [force_length] = force_length::at([&fiber.force_length], &distance);
            active = active + share * force_length;
            compressed = compressed + share;
        }
        let passive = self.parallel.at(length).0 + compressed * self.compression.at(length).0;
        let pull = self.tendon.pull(extension);
        Balance {
            active,
            passive: passive.max(S::ZERO),
            tendon: pull.force,
            saturated: pull.saturated,
            fascicle_length,
        }
    }
}
