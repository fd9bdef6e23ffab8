//! Faults of the core end in a reset, and so in neutral, whatever the state of the stack.
//!
//! The stack is below everything else in RAM: an overflow leaves RAM, and the core's
//! fault handler is called with a stack pointer that is of no use. Neither handler uses it.
#![allow(unsafe_code)]

use core::arch::naked_asm;

/// The core's application interrupt and reset control register.
const AIRCR: u32 = 0xE000_ED0C;
/// Its key, and the request of a reset.
const RESET: u32 = 0x05FA_0004;

/// A fault of the core.
///
/// Starts its own stack, because a non-maskable interrupt may still come.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn HardFault() -> ! {
    naked_asm!(
        "movw r0, #:lower16:_stack_start",
        "movt r0, #:upper16:_stack_start",
        "msr msp, r0",
        "movw r0, #{aircr_low}",
        "movt r0, #{aircr_high}",
        "movw r1, #{reset_low}",
        "movt r1, #{reset_high}",
        "dsb",
        "2:",
        "str r1, [r0]",
        "dsb",
        "b 2b",
        aircr_low = const AIRCR & 0xffff,
        aircr_high = const AIRCR >> 16,
        reset_low = const RESET & 0xffff,
        reset_high = const RESET >> 16,
    )
}

/// Unexpected interrupts, a failed crystal among them.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn DefaultHandler() -> ! {
    naked_asm!("b.w {handler}", handler = sym HardFault)
}
