//! An independent watchdog, as RM0090 (21.3) wants it: its registers are changed only while no change is under way,
//! and a change counts when the part says that it has arrived.

/// Its oscillator, Hz, at the slowest and at the fastest (DS8626, LSI).
const SLOWEST_HZ: u32 = 17_000;
const FASTEST_HZ: u32 = 47_000;
/// Counts that it has at most.
const MOST_COUNTS: u32 = 4096;

/// How long a watchdog waits to be fed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Prescaler: the oscillator is divided by 4 * 2^this, 0 to 6.
    pub prescaler: u8,
    /// Counts, less one, 0 to 4095.
    pub reload: u16,
}

impl Patience {
    /// The shortest that lasts so many ms though the oscillator be at its fastest; 22,000 ms at most.
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

    /// With the oscillator at its fastest, ms.
    pub const fn least_ms(self) -> u32 {
        self.clocks() / (FASTEST_HZ / 1000)
    }

    /// With the oscillator at its slowest, ms.
    pub const fn most_ms(self) -> u32 {
        self.clocks().div_ceil(SLOWEST_HZ / 1000)
    }

    /// A change of a register takes 5 clocks; 6 of the divided clock are no less, ms.
    const fn change_ms(self) -> u32 {
        (6 * (4 << self.prescaler) as u32).div_ceil(SLOWEST_HZ / 1000)
    }
}

/// While current may flow: three of the longest ticks.
pub const ARMED: Patience = Patience::at_least(6);
/// While none may: longer than flash can hold up the core, see [`MOST_STORE_MS`](crate::flash::MOST_STORE_MS).
pub const DISARMED: Patience = Patience::at_least(crate::flash::MOST_STORE_MS + 100);
/// Longest change from one to the other, ms.
pub const MOST_CHANGE_MS: u32 = DISARMED.change_ms();

const _: () = assert!(ARMED.most_ms() < 20, "armed, too patient");
const _: () = assert!(DISARMED.least_ms() > crate::flash::MOST_STORE_MS);
const _: () = assert!(DISARMED.change_ms() >= ARMED.change_ms());

/// Registers of a watchdog.
pub trait WatchdogRegisters {
    /// It counts from now on, and cannot be stopped; its oscillator runs.
    fn start(&mut self);
    /// A change of its prescaler or of its reload has not arrived yet.
    fn is_changing(&self) -> bool;
    /// Changes both.
    fn change(&mut self, patience: Patience);
    /// Counts begin again, from the reload that has arrived.
    fn feed(&mut self);
}

/// Its registers do not take a change: its oscillator has stopped, and it watches nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stuck;

/// Restarts the chip when ticks stop coming.
#[derive(Clone, Debug)]
pub struct Watchdog<R> {
    registers: R,
    /// The last change.
    written: Patience,
    /// The last change has arrived, and was fed with.
    in_force: bool,
    /// Ticks that a change has been under way for, and the most that are taken.
    changing_ticks: u32,
    most_ticks: u32,
}

impl<R: WatchdogRegisters> Watchdog<R> {
    /// Starts it, patient: ticks of so many µs will feed it. Waits for its registers, for so many polls at most.
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

    /// A tick has ended in time. Does not wait: a change is begun by one tick and seen to have arrived by a later.
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

    /// Whether the core may be held up for as long as flash does: [`DISARMED`] is in force.
    pub fn is_patient(&self) -> bool {
        self.in_force && self.written == DISARMED
    }
}
