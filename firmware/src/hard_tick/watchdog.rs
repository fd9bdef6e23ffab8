//! Independent watchdog, per RM0090 21.3: registers are written only while no update is pending,
//! and an update counts when the part reports it.

use crate::link::flash_times::MOST_STORE_MS;

/// Range of its oscillator, Hz (DS8626, LSI).
const SLOWEST_HZ: u32 = 17_000;
const FASTEST_HZ: u32 = 47_000;
/// Greatest count.
const MOST_COUNTS: u32 = 4096;

/// Timeout of a watchdog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeout {
    /// Prescaler: the oscillator is divided by 4 * 2^this, 0 to 6.
    pub prescaler: u8,
    /// Reload: counts minus one, 0 to 4095.
    pub reload: u16,
}

impl Timeout {
    /// Shortest timeout of at least this many ms at the fastest oscillator; 22,000 ms at most.
    pub const fn at_least(ms: u32) -> Self {
        let mut prescaler = 0;
        loop {
            let counts = (ms * (FASTEST_HZ / 1000)).div_ceil(4 << prescaler);
            if counts <= MOST_COUNTS || prescaler == 6 {
                // No more than 4095.
                return Self { prescaler, reload: (counts.saturating_sub(1)) as u16 };
            }
            prescaler += 1;
        }
    }

    const fn clocks(self) -> u32 {
        (self.reload as u32 + 1) * (4 << self.prescaler)
    }

    /// At the fastest oscillator, ms.
    pub const fn least_ms(self) -> u32 {
        self.clocks() / (FASTEST_HZ / 1000)
    }

    /// At the slowest oscillator, ms.
    pub const fn most_ms(self) -> u32 {
        self.clocks().div_ceil(SLOWEST_HZ / 1000)
    }

    /// A change of a register takes 5 clocks; 6 of the divided clock are no less, ms.
    const fn change_ms(self) -> u32 {
        (6 * (4 << self.prescaler) as u32).div_ceil(SLOWEST_HZ / 1000)
    }
}

/// While current may flow: three of the longest tick times.
pub const ARMED: Timeout = Timeout::at_least(6);
/// While disarmed: longer than flash stalls the core, see
/// [`MOST_STORE_MS`].
pub const DISARMED: Timeout = Timeout::at_least(MOST_STORE_MS + 100);
/// Longest update from one to the other, ms.
pub const MOST_CHANGE_MS: u32 = DISARMED.change_ms();

const _: () = assert!(ARMED.most_ms() < 20, "armed, too long");
const _: () = assert!(DISARMED.least_ms() > MOST_STORE_MS);
const _: () = assert!(DISARMED.change_ms() >= ARMED.change_ms());

/// Registers of a watchdog.
pub trait WatchdogRegisters {
    /// Starts it and its oscillator; it cannot be stopped.
    fn start(&mut self);
    /// An update of prescaler or reload is pending.
    fn is_changing(&self) -> bool;
    /// Writes both.
    fn change(&mut self, timeout: Timeout);
    /// Restarts the count from the current reload.
    fn feed(&mut self);
}

/// A register update does not complete: its oscillator has stopped, and it does not guard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stuck;

/// Resets the chip when ticks stop.
#[derive(Clone, Debug)]
pub struct Watchdog<R> {
    registers: R,
    /// Last written timeout.
    written: Timeout,
    /// Whether it is in force.
    in_force: bool,
    /// Ticks since the update began, and their limit.
    changing_ticks: u32,
    most_ticks: u32,
}

impl<R: WatchdogRegisters> Watchdog<R> {
    /// Starts it with the disarmed timeout, for ticks of `tick_us` µs. Polls its registers a
    /// limited number of times.
    pub fn start(mut registers: R, tick_us: u32, most_polls: u32) -> Result<Self, Stuck> {
        // Without its oscillator, which this switches on, no change arrives.
        registers.start();
        let settle = |registers: &R| {
            (0..most_polls).any(|_| !registers.is_changing()).then_some(()).ok_or(Stuck)
        };
        settle(&registers)?;
        registers.change(DISARMED);
        settle(&registers)?;
        registers.feed();
        let most_ticks = (MOST_CHANGE_MS * 1000).div_ceil(tick_us.max(1)) + 1;
        Ok(Self { registers, written: DISARMED, in_force: true, changing_ticks: 0, most_ticks })
    }

    /// A tick has ended in time. Does not wait: one tick begins an update, a later one sees it
    /// complete.
    pub fn feed(&mut self, armed: bool) -> Result<(), Stuck> {
        let wanted = if armed { ARMED } else { DISARMED };
        if self.registers.is_changing() {
            self.in_force = false;
            self.changing_ticks = self.changing_ticks.saturating_add(1);
        } else {
            self.changing_ticks = 0;
            self.in_force = self.written == wanted;
            if !self.in_force {
                self.registers.change(wanted);
                self.written = wanted;
            }
        }
        self.registers.feed();
        if self.changing_ticks > self.most_ticks { Err(Stuck) } else { Ok(()) }
    }

    /// Whether flash may stall the core: [`DISARMED`] is in force.
    pub fn allows_flash(&self) -> bool {
        self.in_force && self.written == DISARMED
    }
}
