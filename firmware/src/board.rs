//! The chip: STM32F405, as QEMU's netduinoplus2 has it. No other file names one.

use cortex_m::Peripherals;
use cortex_m::peripheral::syst::SystClkSource;

/// Core clock of the emulated part, Hz. (A real one starts at 16 MHz, until its PLL is set.)
const CORE_CLOCK: u32 = 168_000_000;
/// Ticks per second.
const TICK_RATE: u32 = 1_000;

/// Starts the tick interrupt.
pub fn start_tick(peripherals: Peripherals) {
    let mut timer = peripherals.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(CORE_CLOCK / TICK_RATE - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}
