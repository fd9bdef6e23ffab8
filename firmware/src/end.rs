//! How a program on a board ends.

use cortex_m_semihosting::debug;

/// Tells the host whether all went well, and sleeps where no host listens.
pub fn finish(succeeded: bool) -> ! {
    debug::exit(if succeeded { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    sleep()
}

/// Sleeps for good.
pub fn sleep() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
