//! The chip: its registers, clock and reset, and whether it is emulated.

pub use stm32f4xx_hal::pac;
use stm32f4xx_hal::pac::RCC;

/// Core clock of the part and of the emulator, Hz.
pub const CORE_CLOCK: u32 = 168_000_000;

/// Whether this is QEMU, whose reset and clock control reads 0. On a real part a bit of the PLL
/// configuration is always 1.
pub fn is_emulated(rcc: &RCC) -> bool {
    rcc.cr().read().bits() == 0 && rcc.pllcfgr().read().bits() == 0
}

/// Resets the chip: everything is off at boot.
pub fn reset() -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
