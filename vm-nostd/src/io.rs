//! Inputs and outputs of a tick.

mod integers;

use crate::scalar::Scalar;
use crate::status::Status;

/// Inputs of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input<S: Scalar> {
    /// Activation U (natural modes) or strength of the stimulus (FES), 0..1, in force during
    /// the tick.
    pub activation: S,
    /// Musculotendon path length L_mt at the tick's end, in m (in fixed point: µm); it is taken
    /// to have changed linearly since the tick before.
    pub path_length: S::PathLength,
    /// Stimulation frequency f_stim, pps, 0..500, in force during the tick (FES only).
    pub stimulation_frequency: S::Quantity,
}

/// What one tick yields.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Output<S: Scalar> {
    /// Tendon force F0 F_se, in N (in fixed point: mN); never negative. It has no upper bound but
    /// the tendon's stiffness: a path that jumps, as a faulty sensor may, stretches the tendon by
    /// all of it.
    pub force: S::Force,
    /// The same relative to F0, F_se: in fixed point to 6e-8 F0, where `force` is told to 1 mN.
    pub relative_force: S,
    /// Fascicle length L, L_ce0.
    pub fascicle_length: S,
    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fascicle_velocity: S,
    /// What had to be saturated.
    pub status: Status,
}
