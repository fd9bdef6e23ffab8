//! Flags of a tick.

use model::Status;

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

/// The flags are the model's, and complete.
macro_rules! same {
    ($($name:ident = $flag:ident,)*) => {
        $(const _: () = assert!($name == Status::$flag.bits());)*
        const _: () = {
            let all = 0 $(| $name)*;
            // The only flag that no tick sets.
            assert!(all == Status::all().bits() & !Status::FORCE_UNREACHABLE.bits());
        };
    };
}

same! {
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
}
