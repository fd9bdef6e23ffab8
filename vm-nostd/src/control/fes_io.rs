//! What goes into a tick of the FES controller, and what comes out.

use crate::beyond_paper::recruitment_curve::Pulse;
use crate::scalar::Scalar;
use crate::status::Status;

bitflags::bitflags! {
    /// What a tick of a controller had to saturate.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct ControlStatus: u16 {
        /// The measured value was not finite: the last one was kept.
        const MEASURED_NOT_FINITE = 1 << 0;
        /// The target was not finite (the last angle was kept, without motion) or outside its
        /// range, for torques 10,240 N m (clipped).
        const TARGET_INVALID = 1 << 1;
        /// The measured angle was outside the joint's range, or the torque beyond 10,240 N m, and
        /// was clipped.
        const MEASURED_CLIPPED = 1 << 2;
        /// The torque was clipped to its limits.
        const TORQUE_LIMITED = 1 << 3;
        /// No activation makes the torque: a muscle is stimulated fully.
        const UNREACHABLE = 1 << 4;
        /// The lead asked for stimulation outside of 0..1.
        const LEAD_CLIPPED = 1 << 5;
        /// The gain would have left its range: the update was refused.
        const GAIN_REFUSED = 1 << 6;
        /// The gain is frozen: too little torque, or saturated.
        const GAIN_FROZEN = 1 << 7;
        /// No pulse recruits what was asked for.
        const PULSE_UNREACHABLE = 1 << 8;
    }
}

/// What is wanted, in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<S: Scalar> {
    /// Angle, rad.
    pub angle: S,
    /// Its velocity, rad/s.
    pub velocity: S,
    /// Its acceleration, rad/s².
    pub acceleration: S,
    /// Torque, N m, in addition to that of the motion; with
    /// [`Measured::Torque`](super::Measured::Torque) the only one.
    pub torque: S::Quantity,
}

/// What is measured, in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors<S: Scalar> {
    /// Angle, rad.
    pub angle: S,
    /// Torque of the muscles, N m; only used with [`Measured::Torque`](super::Measured::Torque).
    pub torque: S::Quantity,
}

/// What is commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FesCommand<S: Scalar> {
    /// Stimulation of flexor and extensor, 0..1. 0 once less than 0.001 is left of a muscle that is
    /// no longer wanted.
    pub activations: [S; 2],
    /// The pulse that recruits it; for 0 the greatest that recruits nothing, which need not be
    /// given.
    pub pulses: [Pulse<S>; 2],
    /// Torque that was asked of the model's inverse, N m.
    pub torque: S::Quantity,
    /// Estimated gain of the muscles.
    pub gain: S,
    /// Flags of the inverse.
    pub muscles: [Status; 2],
    /// What had to be saturated.
    pub status: ControlStatus,
}
