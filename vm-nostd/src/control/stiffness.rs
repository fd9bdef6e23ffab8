//! Static stiffness of a muscle: the slope of its steady tendon force by the path, at the
//! activation that it has.
//!
//! At V = 0 the fascicles pull F(L) = Σ w_i Af_i(L) FL_i(L) + F_pe1(L) + c F_pe2(L) with what is
//! recruited, w, the frequency of each type and the weight c of F_pe2 held. The tendon is in
//! series: dF_se/dL_mt = k_f k_t/(k_f + k_t), with k_f = dF/dL and the tendon's stiffness k_t.

use crate::equations::activation_frequency::curves;
use crate::equations::force_length::{self, Distance};
use crate::muscle::Muscle;
use crate::recruitment::{
    IntramuscularFes, LumpedState, NaturalContinuous, Recruitment, RecruitmentTick,
};
use crate::scalar::Scalar;
use crate::state::State;

/// Half the length over which the fascicles' slope is taken is 2^-7 L_ce0.
const STEP: u32 = 7;
/// FL, and Af, of less than 2^-10 count as none.
const LEAST_GAIN: u32 = 10;

/// 2^-n, without floating point.
fn half_to_the<S: Scalar>(n: u32) -> S {
    (0..n).fold(S::ONE, |power, _| power.half())
}

/// A mode that takes each fibre type as one unit: natural continuous recruitment and FES.
pub trait Lumped<S: Scalar, const N: usize>: Recruitment<S, N, State = LumpedState<S, N>> {
    /// Af of each type, from what is recruited times Af.
    #[doc(hidden)]
    fn activities(
        coefficients: &Self::Coefficients,
        state: &LumpedState<S, N>,
        active: &[S; N],
    ) -> [S; N];
}

impl<S: Scalar, const N: usize> Lumped<S, N> for NaturalContinuous {
    fn activities(_: &Self::Coefficients, state: &LumpedState<S, N>, _: &[S; N]) -> [S; N] {
        state.activities.map(|activity| activity.predicted)
    }
}

impl<S: Scalar, const N: usize> Lumped<S, N> for IntramuscularFes {
    fn activities(
        coefficients: &Self::Coefficients,
        state: &LumpedState<S, N>,
        active: &[S; N],
    ) -> [S; N] {
        let weights = coefficients.weights(state);
        core::array::from_fn(|i| active[i].ratio(weights[i].max(S::LEAST)).min(S::ONE))
    }
}

impl<S: Scalar, R: Lumped<S, N>, const N: usize> Muscle<S, R, N> {
    /// Slope of the steady force by the path at the state's activation, F0 per L_ce0; negative on
    /// the descending limb. How the force follows a motion is not in it: that is in
    /// [`step`](Self::step).
    pub fn stiffness(&self, state: &State<S, R, N>) -> S {
        let tendon = &self.contraction.tendon;
        let extension = S::of(state.tendon_extension);
        let length = tendon.fascicle_length(state.path_length, extension);
        let (length, _) = self.domain.filaments.clip(length);
        let step = half_to_the(STEP);
        let longer = self.pull_at(state, length, length + step);
        let shorter = self.pull_at(state, length, length - step);
        // Over 2^(1 - STEP).
        let fascicles = (1..STEP).fold(longer - shorter, |slope, _| slope + slope);
        // Both per L_ce0/s and tick: F0/L_ce0 of a taut tendon would saturate in fixed point.
        let stretched = tendon.pull(extension).stiffness;
        let of_fascicles = self.contraction.lengthening(fascicles);
        // Where the fascicles fall steeper than the tendon rises, there is no equilibrium.
        let both = (stretched + of_fascicles).max(stretched.half().half()).max(S::LEAST);
        fascicles * stretched.ratio(both)
    }

    /// F0 of the fascicles at a length, of what is active at the state's (both L_ce0).
    fn pull_at(&self, state: &State<S, R, N>, now: S, length: S) -> S {
        let (length, _) = self.domain.filaments.clip(length);
        let [here, there] = [now, length].map(Distance::new);
        let [reciprocal, moved] = [now, length].map(S::reciprocal);
        let types = self.fibers.each_ref();
        let [lengths, longer] =
            [here, there].map(|at| force_length::at(types.map(|t| &t.force_length), &at));
        let [curves, others] =
            [reciprocal, moved].map(|at| curves(types.map(|t| &t.activation), at));
        let least = half_to_the(LEAST_GAIN);
        // What is recruited times Af.
        let shares = core::array::from_fn(|i| state.gains[i].ratio(lengths[i].max(least)));
        let activities = R::activities(&self.recruitment, &state.recruitment, &shares);
        let mut active = S::ZERO;
        for i in 0..N {
            if activities[i] > least {
                let moved = curves[i].at_other_length(activities[i], &others[i]);
                let weight = shares[i].ratio(activities[i]);
                active = active + weight * moved * longer[i];
            }
        }
        let passive = self.parallel.at(length).0 + state.compressed * self.compression.at(length).0;
        let only_pulls = <R::Coefficients as RecruitmentTick<S, N>>::PASSIVE_ONLY_PULLS;
        let passive = if only_pulls { passive.max(S::ZERO) } else { passive };
        (active + passive).max(S::ZERO)
    }
}
