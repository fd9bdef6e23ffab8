//! What the core cannot go on after ends in a reset, and so in neutral, whatever state the stack is
//! in.
//!
//! The stack is below everything else in RAM: what overflows it meets no memory, and the core's
//! fault handler is called with a stack pointer that is of no use. Neither handler uses it.
#![allow(unsafe_code)]

use core::arch::naked_asm;

/// The core's application interrupt and reset control register.
const AIRCR: u32 = 0xE000_ED0C;
/// Its key, and the request of a reset.
const RESET: u32 = 0x05FA_0004;

/// What the core cannot go on after, in whatever it was doing.
///
/// Begins a stack of its own, for an interrupt that cannot be masked may still come.
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

/// What nobody has asked for; a crystal that has failed is among it.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn DefaultHandler() -> ! {
    naked_asm!("b.w {handler}", handler = sym HardFault)
}
