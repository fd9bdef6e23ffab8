//! Flags of a tick.

use model::control::{ControlStatus, JointStatus, ProsthesisStatus};
use model::{PulseStatus, Status};

/// Activation was outside 0..1 and was clipped.
pub const VM_STATUS_ACTIVATION_CLIPPED: u16 = 1;
/// Activation was NaN (taken as 0) or infinite (clipped).
pub const VM_STATUS_ACTIVATION_NOT_FINITE: u16 = 2;
/// Stimulation frequency was outside 0..500 pps and was clipped.
pub const VM_STATUS_FREQUENCY_CLIPPED: u16 = 4;
/// Stimulation frequency was NaN (taken as 0) or infinite (clipped).
pub const VM_STATUS_FREQUENCY_NOT_FINITE: u16 = 8;
/// Path length was outside the muscle's range and was clipped.
pub const VM_STATUS_PATH_LENGTH_CLIPPED: u16 = 16;
/// Path length was NaN (the last one was kept) or infinite (clipped).
pub const VM_STATUS_PATH_LENGTH_NOT_FINITE: u16 = 32;
/// Fascicles left the validity range of the filaments' equations, which were evaluated at its edge.
pub const VM_STATUS_FASCICLE_OUTSIDE_DOMAIN: u16 = 64;
/// Fascicle length was clamped to the state range.
pub const VM_STATUS_FASCICLE_LENGTH_LIMITED: u16 = 128;
/// Fascicle velocity was clamped to the state range.
pub const VM_STATUS_FASCICLE_VELOCITY_LIMITED: u16 = 256;
/// The residual of the force balance was too large, as when the path jumps: the force is less
/// accurate.
pub const VM_STATUS_MECHANICS_UNSETTLED: u16 = 512;
/// Tendon force saturated in fixed point.
pub const VM_STATUS_TENDON_FORCE_LIMITED: u16 = 1024;
/// No activation holds the force that was asked for. Never set by a tick.
pub const VM_STATUS_FORCE_UNREACHABLE: u16 = 2048;

/// Amplitude was outside 0..500 mA, or beyond 100 times saturation, and was clipped.
pub const VM_PULSE_AMPLITUDE_CLIPPED: u16 = 1;
/// Amplitude was NaN (taken as 0) or infinite (clipped).
pub const VM_PULSE_AMPLITUDE_NOT_FINITE: u16 = 2;
/// Width was outside 0..5000 us and was clipped.
pub const VM_PULSE_WIDTH_CLIPPED: u16 = 4;
/// Width was NaN (taken as 0) or infinite (clipped).
pub const VM_PULSE_WIDTH_NOT_FINITE: u16 = 8;
/// Activation was outside 0..1 and was clipped.
pub const VM_PULSE_ACTIVATION_CLIPPED: u16 = 16;
/// Activation was NaN (taken as 0) or infinite (clipped).
pub const VM_PULSE_ACTIVATION_NOT_FINITE: u16 = 32;
/// No amplitude or width within these limits recruits so much: the answer is the greatest.
pub const VM_PULSE_UNREACHABLE: u16 = 64;

/// VmPosture: an angle was outside its range and was clipped.
pub const VM_JOINT_ANGLE_CLIPPED: u8 = 1;
/// VmPosture: an angle was NaN (taken in the middle of its range) or infinite (clipped).
pub const VM_JOINT_ANGLE_NOT_FINITE: u8 = 2;

/// An EMG sample was not a number, or beyond 8 times the range of its envelope.
pub const VM_PROSTHESIS_EMG_INVALID: u16 = 1;
/// The angle was outside the joint's range and was clipped.
pub const VM_PROSTHESIS_ANGLE_CLIPPED: u16 = 2;
/// The angle was not finite; that of the tick before was kept.
pub const VM_PROSTHESIS_ANGLE_NOT_FINITE: u16 = 4;
/// The torque was outside its limits.
pub const VM_PROSTHESIS_TORQUE_LIMITED: u16 = 8;
/// The torque changed faster than its rate limit.
pub const VM_PROSTHESIS_TORQUE_RATE_LIMITED: u16 = 16;
/// The stiffness was outside its limits; negative stiffness counts as the least.
pub const VM_PROSTHESIS_STIFFNESS_LIMITED: u16 = 32;
/// The stiffness changed faster than its rate limit.
pub const VM_PROSTHESIS_STIFFNESS_RATE_LIMITED: u16 = 64;
/// A muscle raised a VM_STATUS_ flag, in the command's `muscles`.
pub const VM_PROSTHESIS_MUSCLE: u16 = 128;

/// The measured value was not finite: the last one was kept.
pub const VM_CONTROL_MEASURED_NOT_FINITE: u16 = 1;
/// The target was not finite (the last angle was kept, without motion) or outside its range, for
/// torques 10,240 N m (clipped).
pub const VM_CONTROL_TARGET_INVALID: u16 = 2;
/// The measured angle was outside the joint's range, or the torque beyond 10,240 N m, and was
/// clipped.
pub const VM_CONTROL_MEASURED_CLIPPED: u16 = 4;
/// The torque was clipped to its limits.
pub const VM_CONTROL_TORQUE_LIMITED: u16 = 8;
/// No activation makes the torque: a muscle is stimulated fully.
pub const VM_CONTROL_UNREACHABLE: u16 = 16;
/// The lead asked for stimulation outside of 0..1.
pub const VM_CONTROL_LEAD_CLIPPED: u16 = 32;
/// The gain would have left its range: the update was refused.
pub const VM_CONTROL_GAIN_REFUSED: u16 = 64;
/// The gain is frozen: too little torque, or saturated.
pub const VM_CONTROL_GAIN_FROZEN: u16 = 128;
/// No pulse recruits what was asked for.
pub const VM_CONTROL_PULSE_UNREACHABLE: u16 = 256;

/// The flags are the model's, and complete.
macro_rules! same {
    ($of:ident: $($name:ident = $flag:ident,)*) => {
        $(const _: () = assert!($name == $of::$flag.bits());)*
        const _: () = assert!((0 $(| $name)*) == $of::all().bits());
    };
}

same! {
    Status:
    VM_STATUS_ACTIVATION_CLIPPED = ACTIVATION_CLIPPED,
    VM_STATUS_ACTIVATION_NOT_FINITE = ACTIVATION_NOT_FINITE,
    VM_STATUS_FREQUENCY_CLIPPED = FREQUENCY_CLIPPED,
    VM_STATUS_FREQUENCY_NOT_FINITE = FREQUENCY_NOT_FINITE,
    VM_STATUS_PATH_LENGTH_CLIPPED = PATH_LENGTH_CLIPPED,
    VM_STATUS_PATH_LENGTH_NOT_FINITE = PATH_LENGTH_NOT_FINITE,
    VM_STATUS_FASCICLE_OUTSIDE_DOMAIN = FASCICLE_OUTSIDE_DOMAIN,
    VM_STATUS_FASCICLE_LENGTH_LIMITED = FASCICLE_LENGTH_LIMITED,
    VM_STATUS_FASCICLE_VELOCITY_LIMITED = FASCICLE_VELOCITY_LIMITED,
    VM_STATUS_MECHANICS_UNSETTLED = MECHANICS_UNSETTLED,
    VM_STATUS_TENDON_FORCE_LIMITED = TENDON_FORCE_LIMITED,
    VM_STATUS_FORCE_UNREACHABLE = FORCE_UNREACHABLE,
}

same! {
    PulseStatus:
    VM_PULSE_AMPLITUDE_CLIPPED = AMPLITUDE_CLIPPED,
    VM_PULSE_AMPLITUDE_NOT_FINITE = AMPLITUDE_NOT_FINITE,
    VM_PULSE_WIDTH_CLIPPED = WIDTH_CLIPPED,
    VM_PULSE_WIDTH_NOT_FINITE = WIDTH_NOT_FINITE,
    VM_PULSE_ACTIVATION_CLIPPED = ACTIVATION_CLIPPED,
    VM_PULSE_ACTIVATION_NOT_FINITE = ACTIVATION_NOT_FINITE,
    VM_PULSE_UNREACHABLE = UNREACHABLE,
}

same! {
    JointStatus:
    VM_JOINT_ANGLE_CLIPPED = ANGLE_CLIPPED,
    VM_JOINT_ANGLE_NOT_FINITE = ANGLE_NOT_FINITE,
}

same! {
    ProsthesisStatus:
    VM_PROSTHESIS_EMG_INVALID = EMG_INVALID,
    VM_PROSTHESIS_ANGLE_CLIPPED = ANGLE_CLIPPED,
    VM_PROSTHESIS_ANGLE_NOT_FINITE = ANGLE_NOT_FINITE,
    VM_PROSTHESIS_TORQUE_LIMITED = TORQUE_LIMITED,
    VM_PROSTHESIS_TORQUE_RATE_LIMITED = TORQUE_RATE_LIMITED,
    VM_PROSTHESIS_STIFFNESS_LIMITED = STIFFNESS_LIMITED,
    VM_PROSTHESIS_STIFFNESS_RATE_LIMITED = STIFFNESS_RATE_LIMITED,
    VM_PROSTHESIS_MUSCLE = MUSCLE,
}

same! {
    ControlStatus:
    VM_CONTROL_MEASURED_NOT_FINITE = MEASURED_NOT_FINITE,
    VM_CONTROL_TARGET_INVALID = TARGET_INVALID,
    VM_CONTROL_MEASURED_CLIPPED = MEASURED_CLIPPED,
    VM_CONTROL_TORQUE_LIMITED = TORQUE_LIMITED,
    VM_CONTROL_UNREACHABLE = UNREACHABLE,
    VM_CONTROL_LEAD_CLIPPED = LEAD_CLIPPED,
    VM_CONTROL_GAIN_REFUSED = GAIN_REFUSED,
    VM_CONTROL_GAIN_FROZEN = GAIN_FROZEN,
    VM_CONTROL_PULSE_UNREACHABLE = PULSE_UNREACHABLE,
}
