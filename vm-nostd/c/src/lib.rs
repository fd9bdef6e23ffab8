//! vm-nostd for C.
//!
//! Arguments are checked: pointers are neither null nor misaligned, memory is large enough, the
//! header is of this version, and a muscle has been built and has a state. The only `unsafe` is in
//! the exported names, in [`pointer`], which reads and writes what C owns, and in [`slot`], which
//! reads what it has built.
#![cfg_attr(target_os = "none", no_std)]

mod arithmetic;
mod choice;
mod control;
mod control_functions;
mod derived;
mod extra_functions;
mod extras;
mod f32;
#[cfg(feature = "f64")]
mod f64;
mod fixed;
mod floating;
mod functions;
mod kinds;
mod muscle;
mod names;
mod outcome;
mod params;
mod pointer;
mod presets;
mod result;
mod sizes;
mod slot;
mod status;
mod template;
mod units;

/// Unreachable: no code path panics.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
