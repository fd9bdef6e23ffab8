//! Flags of a tick.

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
