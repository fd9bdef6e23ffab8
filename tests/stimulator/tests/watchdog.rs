//! Failures of the chip's watchdog, per its manual: registers in this process that take a change
//! late or never.

use firmware::flash::{MOST_ERASE_MS, MOST_STORE_MS};
use firmware::watchdog::{
    ARMED, DISARMED, MOST_CHANGE_MS, Stuck, Timeout, Watchdog, WatchdogRegisters,
};
use std::cell::Cell;

/// A watchdog whose registers take an update after some polls.
#[derive(Debug)]
struct Registers {
    runs: bool,
    /// Looks until a change has arrived; each polls a while, or is one of a tick.
    looks: u32,
    left: Cell<u32>,
    coming: Option<Timeout>,
    in_force: Timeout,
    fed_with: Option<Timeout>,
    changes: u32,
}

/// As after a reset of the part.
const RESET: Timeout = Timeout { prescaler: 0, reload: 4095 };

impl Registers {
    fn new(looks: u32) -> Self {
        let left = Cell::new(0);
        Self { runs: false, looks, left, coming: None, in_force: RESET, fed_with: None, changes: 0 }
    }

    fn arrive(&mut self) {
        if self.left.get() == 0
            && let Some(timeout) = self.coming.take()
        {
            self.in_force = timeout;
        }
    }
}

impl WatchdogRegisters for &mut Registers {
    fn start(&mut self) {
        self.runs = true;
    }

    fn is_changing(&self) -> bool {
        let left = self.left.get();
        self.left.set(left.saturating_sub(1));
        left > 0
    }

    fn change(&mut self, timeout: Timeout) {
        self.arrive();
        assert!(self.coming.is_none(), "changed while a change is under way");
        assert!(self.runs, "without its oscillator no change arrives");
        self.coming = Some(timeout);
        self.left.set(self.looks);
        self.changes += 1;
    }

    fn feed(&mut self) {
        self.arrive();
        self.fed_with = Some(self.in_force);
    }
}

#[test]
fn the_watchdogs_registers_are_changed_one_after_the_other_and_fed_when_a_change_has_arrived() {
    for looks in [0, 1, 2, 5] {
        let mut registers = Registers::new(looks);
        let mut dog = Watchdog::start(&mut registers, 1000, 10).expect("it takes changes");
        let mut armed = true;
        for tick in 0..200 {
            // Somebody who arms and stops as fast as can be.
            if tick % 7 == 0 || (50..60).contains(&tick) {
                armed = !armed;
            }
            assert_eq!(dog.feed(armed), Ok(()), "{looks} looks, tick {tick}");
            assert!(!(armed && dog.allows_flash()), "flash allowed while armed, tick {tick}");
        }
        // The reported timeout is in force.
        for armed in [false, true, false] {
            // The change before may still be under way.
            for _ in 0..2 * looks + 3 {
                dog.feed(armed).expect("it takes changes");
            }
            assert_eq!(dog.allows_flash(), !armed);
        }
        assert_eq!(registers.fed_with, Some(DISARMED));
        assert!(registers.changes > 20);
    }
}

/// Flash is allowed only once the part was fed with the long timeout, whenever the change arrives.
#[test]
fn flash_is_never_begun_under_the_armed_timeout() {
    for looks in 0..10 {
        let mut registers = Registers::new(looks);
        let mut dog = Watchdog::start(&mut registers, 1000, 20).expect("it takes changes");
        (0..30).for_each(|_| dog.feed(true).expect("a change"));
        let mut ticks = 0;
        while !dog.allows_flash() {
            dog.feed(false).expect("a change");
            ticks += 1;
        }
        assert_eq!(registers.fed_with, Some(DISARMED), "{looks} looks");
        assert!(ticks <= looks + 2, "{looks} looks, {ticks} ticks");
    }
}

#[test]
fn a_watchdog_that_takes_no_change_is_found_out() {
    let mut registers = Registers::new(u32::MAX);
    assert_eq!(Watchdog::start(&mut registers, 1000, 1000).err(), Some(Stuck));
    // One whose bits stay from before.
    let mut registers = Registers::new(0);
    registers.left.set(u32::MAX);
    assert_eq!(Watchdog::start(&mut registers, 1000, 1000).err(), Some(Stuck));
    for (tick_us, most) in [(500, 2 * MOST_CHANGE_MS + 1), (2000, MOST_CHANGE_MS.div_ceil(2) + 1)] {
        let mut registers = Registers::new(0);
        registers.looks = 1_000_000;
        let mut dog = Watchdog::start(&mut registers, tick_us, 2_000_000).expect("slow, not stuck");
        assert_eq!(dog.feed(true), Ok(()));
        let ticks = (1..10_000).find(|_| dog.feed(true) == Err(Stuck)).expect("in the end");
        assert_eq!(ticks, most + 1, "{tick_us}");
        assert!(!dog.allows_flash());
    }
}

/// Each timeout lasts as long as is said over all of the oscillator's tolerance, 17 to 47 kHz.
#[test]
fn a_timeout_is_long_enough_at_the_fastest_oscillator() {
    let ms = |timeout: Timeout, hz: f64| {
        1e3 * f64::from(4 << timeout.prescaler) * (f64::from(timeout.reload) + 1.0) / hz
    };
    assert!(ms(DISARMED, 47e3) > f64::from(MOST_STORE_MS) + 99.0);
    assert!(ms(ARMED, 47e3) >= 6.0 && ms(ARMED, 17e3) < 20.0);
    for most in (1..22_000).step_by(7) {
        let timeout = Timeout::at_least(most);
        assert!(ms(timeout, 47e3) >= f64::from(most), "{most} ms");
        assert!(ms(timeout, 47e3) < 1.02 * f64::from(most) + 0.1, "{most} ms");
        assert!(timeout.reload <= 4095 && timeout.prescaler <= 6);
        assert_eq!(timeout.least_ms(), ms(timeout, 47e3).floor() as u32);
        assert_eq!(timeout.most_ms(), ms(timeout, 17e3).ceil() as u32);
    }
}

/// Of two that last equally long, the one that counts finer.
#[test]
fn a_timeout_counts_as_fine_as_it_can() {
    assert_eq!(Timeout::at_least(5_577), Timeout { prescaler: 4, reload: 4095 });
    assert_eq!(Timeout::at_least(5_578), Timeout { prescaler: 5, reload: 2048 });
}

/// The README has these numbers.
#[test]
fn the_readme_has_these_numbers() {
    let readme = include_str!("../../../firmware/README.md");
    let readme = readme.split_whitespace().collect::<Vec<_>>().join(" ");
    let tenths = |ms: u32| format!("{:.1}", f64::from(ms) / 1e3);
    for sentence in [
        format!("{} s at most for a sector of 128 KB", MOST_ERASE_MS / 1000),
        format!("{} s until a muscle is stored", tenths(MOST_STORE_MS)),
        format!("{} to {} ms while current may flow", ARMED.least_ms(), ARMED.most_ms()),
        format!("{} to {} s otherwise", tenths(DISARMED.least_ms()), tenths(DISARMED.most_ms())),
        format!("within {MOST_CHANGE_MS} ms"),
    ] {
        assert!(readme.contains(&sentence), "not in firmware/README.md: {sentence}");
    }
}
