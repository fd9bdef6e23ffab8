//! vm-nostd for C.
//!
//! Arguments are checked: no pointer may be null, sizes must be those of this library, and a muscle
//! must have been built. The only `unsafe` is in the exported names, and where [`slot`] reads a
//! muscle that it has built.
#![cfg_attr(target_os = "none", no_std)]

mod f32;
mod fixed;
mod params;
mod result;
mod slot;
mod status;

/// Unreachable: no code path panics.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
