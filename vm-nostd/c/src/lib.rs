//! vm-nostd for C.
//!
//! What C passes is looked at before it is used: no pointer may be null, sizes must be those of this library, and
//! a muscle must have been built. The only `unsafe` is in the names of functions, and where a muscle's bytes are
//! taken for what [`slot`] has built there.
#![cfg_attr(target_os = "none", no_std)]

mod f32;
mod fixed;
mod params;
mod result;
mod slot;
mod status;

/// Where nothing can go wrong, nothing has to be done.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
