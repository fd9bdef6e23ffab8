//! From a torque to the stimulation of two antagonists: the model's inverse, in four steps.
//!
//! Torque -> forces (moment arms, co-contraction) -> rested forces (fitness) -> steady
//! activations ([`SteadyFes`]) -> stimulation (the lead that cancels excitation).

use super::lead::{Lead, LeadState};
use crate::beyond_paper::fatigue::{Fatigue, FatigueState};
use crate::beyond_paper::steady::SteadyFes;
use crate::scalar::Scalar;
use crate::status::Status;
use crate::summed::summed;

/// Least activation that is worth a pulse of a muscle that is no longer wanted. What is left in its
/// lead decays for seconds, and would give pulses at the threshold of its electrode all the while.
pub(super) const LEAST_ACTIVATION: f64 = 1e-3;

summed! {
    /// What one muscle needs for the inverse.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Inverse<S: Scalar, const N: usize> {
        pub(super) steady: SteadyFes<S, N>,
        pub(super) lead: Lead<S>,
        pub(super) fatigue: Option<Fatigue<S>>,
        /// Fitness that is made up for at most.
        pub(super) least_fitness: S,
        /// [`LEAST_ACTIVATION`].
        pub(super) least_activation: S,
    }

    sum only
}

/// State of the inverse of one muscle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct InverseState<S: Scalar> {
    pub(super) lead: LeadState<S>,
    pub(super) fatigue: Option<FatigueState<S>>,
}

impl<S: Scalar> InverseState<S> {
    pub(super) fn words(&self) -> impl Iterator<Item = S::Bits> {
        let tired = self.fatigue.iter().flat_map(FatigueState::words);
        self.lead.words().chain(tired)
    }
}

summed! {
    /// The coefficients that do not belong to a muscle.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct CoContraction<S> {
        /// Torque that each muscle makes against the other.
        pub(super) torque: S,
    }
}

impl<S: Scalar> CoContraction<S> {
    /// Torques of flexor and extensor, each with its sign, that together make a torque.
    pub(super) fn shares(&self, torque: S) -> [S; 2] {
        let flexion = torque.max(S::ZERO) + self.torque;
        let extension = torque.min(S::ZERO) - self.torque;
        [flexion, extension]
    }
}

/// Stimulation of one muscle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stimulated<S> {
    /// 0..1.
    pub(super) activation: S,
    pub(super) status: Status,
    /// No activation holds the torque: it is the greatest.
    pub(super) at_most: bool,
    /// The lead asked for less than 0 or more than 1.
    pub(super) lead_clipped: bool,
}

impl<S: Scalar, const N: usize> Inverse<S, N> {
    /// The stimulation with which the muscle makes a force (F0), of which the feed-forward wants
    /// `forward`, on a path.
    ///
    /// Fatigue is made up for in the feed-forward alone: in the feedback it would multiply the
    /// loop's gain, and a patient who tires less than the model says would oscillate.
    pub(super) fn step(
        &self,
        state: &mut InverseState<S>,
        force: S,
        forward: S,
        path: S::PathLength,
        frequency: S::Quantity,
    ) -> Stimulated<S> {
        let fitness = state.fatigue.map_or(S::ONE, |fatigue| fatigue.fitness());
        let strength = fitness.max(self.least_fitness);
        let forward = forward.min(force);
        let force = force + (forward.ratio(strength) - forward);
        let (wanted, status) = self.steady.nearest_activation(force, path, frequency);
        let ahead = self.lead.step(&mut state.lead, wanted);
        let within = ahead.max(S::ZERO).min(S::ONE);
        let is_over = wanted <= S::ZERO && within < self.least_activation;
        let activation = if is_over { S::ZERO } else { within };
        if let (Some(fatigue), Some(tired)) = (&self.fatigue, &mut state.fatigue) {
            fatigue.advance(tired, activation, frequency);
        }
        Stimulated { activation, status, at_most: wanted >= S::ONE, lead_clipped: within != ahead }
    }
}
