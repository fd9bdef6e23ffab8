//! What a tick had to saturate.

use model::Status;

/// Activation was outside 0..1 and was clipped.
pub const VM_STATUS_ACTIVATION_CLIPPED: u16 = 1;
/// Activation was not a number (taken as 0) or infinite (clipped).
pub const VM_STATUS_ACTIVATION_NOT_FINITE: u16 = 2;
/// Stimulation frequency was outside 0..500 pps and was clipped.
pub const VM_STATUS_FREQUENCY_CLIPPED: u16 = 4;
/// Stimulation frequency was not a number (taken as 0) or infinite (clipped).
pub const VM_STATUS_FREQUENCY_NOT_FINITE: u16 = 8;
/// Path length was outside the muscle's range and was clipped.
pub const VM_STATUS_PATH_LENGTH_CLIPPED: u16 = 16;
/// Path length was not a number (the one before was kept) or infinite (clipped).
pub const VM_STATUS_PATH_LENGTH_NOT_FINITE: u16 = 32;
/// Fascicles were where the filaments' equations do not hold; these were taken at the edge of their range.
pub const VM_STATUS_FASCICLE_OUTSIDE_DOMAIN: u16 = 64;
/// The fascicles were stopped at the least or greatest length the state can have.
pub const VM_STATUS_FASCICLE_LENGTH_LIMITED: u16 = 128;
/// The fascicles were held at the greatest speed the state can have.
pub const VM_STATUS_FASCICLE_VELOCITY_LIMITED: u16 = 256;
/// Forces were far out of balance, as when a path jumps: the force is less accurate.
pub const VM_STATUS_MECHANICS_UNSETTLED: u16 = 512;
/// The tendon's force was taken at the most that fixed point can tell.
pub const VM_STATUS_TENDON_FORCE_LIMITED: u16 = 1024;

/// That they are the model's, and all of them.
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
