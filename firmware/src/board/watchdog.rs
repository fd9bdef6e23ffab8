//! The independent watchdog.

use super::chip::pac::IWDG;
use super::chip::reset;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use firmware::watchdog::{self, MOST_CHANGE_MS, Timeout, WatchdogRegisters};

/// Whether its timeout exceeds an erase, which stalls the core: set by the tick, asked by the link.
static ALLOWS_FLASH: AtomicBool = AtomicBool::new(false);

/// See [`ALLOWS_FLASH`].
pub fn allows_flash() -> bool {
    ALLOWS_FLASH.load(Relaxed)
}

/// The part's registers.
struct Registers(IWDG);

impl WatchdogRegisters for Registers {
    fn start(&mut self) {
        self.0.kr().write(|w| w.key().start());
    }

    fn is_changing(&self) -> bool {
        let status = self.0.sr().read();
        status.pvu().bit_is_set() || status.rvu().bit_is_set()
    }

    fn change(&mut self, timeout: Timeout) {
        self.0.kr().write(|w| w.key().unlock());
        self.0.pr().write(|w| w.pr().set(timeout.prescaler));
        self.0.rlr().write(|w| w.rl().set(timeout.reload));
    }

    fn feed(&mut self) {
        self.0.kr().write(|w| w.key().feed());
    }
}

/// Polls that outlast any register update: at boot the core runs at 16 MHz, and a poll takes at
/// least four clocks.
const POLLS: u32 = MOST_CHANGE_MS * 16_000 / 4;

/// Restarts the chip when ticks stop coming.
pub struct Watchdog(watchdog::Watchdog<Registers>);

impl Watchdog {
    /// Starts it. If it does not start, the chip resets, in neutral, until it does.
    pub(super) fn start(registers: IWDG, tick_us: u32) -> Self {
        let Ok(watchdog) = watchdog::Watchdog::start(Registers(registers), tick_us, POLLS) else {
            reset()
        };
        Self(watchdog)
    }

    /// A tick has ended in time.
    pub fn feed(&mut self, armed: bool) {
        if self.0.feed(armed).is_err() {
            // Without it nothing would end a hang.
            reset()
        }
        ALLOWS_FLASH.store(self.0.allows_flash(), Relaxed);
    }
}
