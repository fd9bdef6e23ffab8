//! Inputs and outputs of a tick.

mod integers;

use crate::scalar::Scalar;
use crate::status::Status;

/// Inputs of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input<S: Scalar> {
    /// Activation U (natural modes) or strength of the stimulus (FES), 0..1, constant during the
    /// tick.
    pub activation: S,
    /// Musculotendon path length L_mt at the end of the tick, in m (in fixed point: µm); it changes
    /// linearly during the tick.
    pub path_length: S::PathLength,
    /// Stimulation frequency f_stim, pps, 0..500, constant during the tick (FES only).
    pub stimulation_frequency: S::Quantity,
}

/// Outputs of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Output<S: Scalar> {
    /// Tendon force F0 F_se, in N (in fixed point: mN); never negative. Only the tendon's stiffness
    /// bounds it: a jump of the path, as from a faulty sensor, stretches the tendon by the whole
    /// jump. Such a tick has [`Status::MECHANICS_UNSETTLED`]: a controller that acts on forces
    /// should keep the last one while it is set.
    pub force: S::Force,
    /// The same relative to F0, F_se. In fixed point with a resolution of 6e-8 F0; that of `force`
    /// is 1 mN.
    pub relative_force: S,
    /// Fascicle length L, L_ce0.
    pub fascicle_length: S,
    /// Fascicle velocity V, L_ce0/s, positive when lengthening.
    pub fascicle_velocity: S,
    /// Flags.
    pub status: Status,
}
