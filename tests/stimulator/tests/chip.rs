//! Failures of the chip's flash, watchdog and noise generator, per their manual:
//! parts in this process that stay busy, keep flags of old errors, or never take a change.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use firmware::flash::{Flash, FlashController, FlashError, MOST_ERASE_MS, MOST_STORE_MS};
use firmware::watchdog::{
    ARMED, DISARMED, MOST_CHANGE_MS, Patience, Stuck, Watchdog, WatchdogRegisters,
};
use firmware::{Noise, NoiseGenerator, NoiseStatus, NotStored, Randomness, Slots};
use std::cell::Cell;
use std::collections::{HashMap, VecDeque};

/// Of the part in this process.
const BYTES: usize = 16_384;
const SECTOR: usize = BYTES / 2;

/// A part's flash.
struct Part {
    kept: Vec<u8>,
    /// LinkQueues of its data cache, sixteen bytes each.
    cached: std::cell::RefCell<HashMap<usize, Vec<u8>>>,
    /// Its clock, which advances when polled.
    counts: Cell<u32>,
    clock_runs: bool,
    busy_until: u32,
    /// Flags of errors; those that cannot be cleared.
    error: bool,
    stuck_error: bool,
    patient_from: u32,
    /// Failures of the next operations.
    fails: VecDeque<Fails>,
    operations: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Fails {
    Not,
    /// A flag says so.
    WithFlag,
    /// It is said to be done, and is not.
    Silently,
    /// The call says so, without a flag.
    WithoutFlag,
    /// It never ends.
    Never,
}

impl Part {
    fn new() -> Self {
        Self {
            kept: vec![0x5a; BYTES],
            cached: std::cell::RefCell::default(),
            counts: Cell::new(u32::MAX - 1000),
            clock_runs: true,
            busy_until: u32::MAX - 1000,
            error: false,
            stuck_error: false,
            patient_from: u32::MAX - 1000,
            fails: VecDeque::new(),
            operations: 0,
        }
    }

    fn is_reached(&self, time: u32) -> bool {
        self.counts.get().wrapping_sub(time) < 0x8000_0000
    }

    fn operate(&mut self, operation: impl FnOnce(&mut Vec<u8>)) -> bool {
        self.operations += 1;
        let fails = self.fails.pop_front().unwrap_or(Fails::Not);
        self.error |= fails == Fails::WithFlag;
        // As the part: with a flag of an error nothing is begun.
        if self.error {
            return false;
        }
        if fails == Fails::Never {
            self.busy_until = self.counts.get().wrapping_add(0x7fff_ffff);
        }
        if fails == Fails::WithoutFlag {
            return false;
        }
        if fails == Fails::Not {
            operation(&mut self.kept);
        }
        true
    }
}

impl FlashController for Part {
    const COUNTS_PER_MS: u32 = 10;
    const BYTES: usize = BYTES;
    const SECTOR: usize = SECTOR;

    fn counts(&self) -> u32 {
        if self.clock_runs {
            self.counts.set(self.counts.get().wrapping_add(1));
        }
        self.counts.get()
    }

    fn is_watchdog_patient(&self) -> bool {
        self.is_reached(self.patient_from)
    }

    fn is_busy(&self) -> bool {
        !self.is_reached(self.busy_until)
    }

    fn has_error(&self) -> bool {
        self.error
    }

    fn clear_flags(&mut self) {
        self.error = self.stuck_error;
    }

    fn erase_sector(&mut self, from: u32) -> bool {
        let from = from as usize;
        self.operate(|kept| kept[from..from + SECTOR].fill(0xff))
    }

    fn write(&mut self, from: u32, bytes: &[u8]) -> bool {
        let from = from as usize;
        self.operate(|kept| {
            kept[from..].iter_mut().zip(bytes).for_each(|(kept, byte)| *kept &= byte);
        })
    }

    fn read(&self, from: u32, bytes: &mut [u8]) {
        let mut cached = self.cached.borrow_mut();
        for (address, byte) in (from as usize..).zip(bytes) {
            let line = address / 16;
            let held = cached
                .entry(line)
                .or_insert_with(|| self.kept[line * 16..(line + 1) * 16].to_vec());
            *byte = held[address % 16];
        }
    }

    fn flush_caches(&mut self) {
        self.cached.borrow_mut().clear();
    }
}

fn flash(change: impl FnOnce(&mut Part)) -> Flash<Part> {
    let mut part = Part::new();
    change(&mut part);
    Flash::new(part)
}

#[test]
fn a_flag_of_an_earlier_error_does_not_fail_what_comes_after_it() {
    let mut flash = flash(|part| part.error = true);
    assert_eq!(flash.erase(0, SECTOR as u32), Ok(()));
    flash.controller().error = true;
    assert_eq!(flash.write(16, &[1, 2, 3]), Ok(()));
    let mut bytes = [0; 4];
    flash.read(15, &mut bytes).expect("inside");
    assert_eq!(bytes, [0xff, 1, 2, 3]);
    // Its own error is reported once.
    flash.controller().fails = [Fails::WithFlag].into();
    assert_eq!(flash.write(32, &[4]), Err(FlashError::Failed));
    assert_eq!(flash.write(32, &[4]), Ok(()));
    flash.controller().fails = [Fails::WithoutFlag].into();
    assert_eq!(flash.write(33, &[5]), Err(FlashError::Failed));
}

#[test]
fn a_flag_that_cannot_be_cleared_is_an_error_before_anything_is_begun() {
    let mut flash = flash(|part| (part.error, part.stuck_error) = (true, true));
    assert_eq!(flash.erase(0, SECTOR as u32), Err(FlashError::Failed));
    assert_eq!(flash.write(0, &[0]), Err(FlashError::Failed));
    assert_eq!(flash.controller().operations, 0);
}

#[test]
fn flash_that_stays_busy_is_waited_for_as_long_as_its_data_sheet_says_and_no_longer() {
    let begun = Part::new().counts.get();
    // As long as erasing takes at most, from an operation that something else has begun.
    let mut slow = flash(|part| part.busy_until = begun.wrapping_add(MOST_ERASE_MS * 10 - 10));
    assert_eq!(slow.erase(0, SECTOR as u32), Ok(()));
    for clock_runs in [true, false] {
        let mut stuck = flash(|part| {
            part.busy_until = begun.wrapping_add(0x7fff_ffff);
            part.clock_runs = clock_runs;
        });
        assert_eq!(stuck.erase(0, SECTOR as u32), Err(FlashError::Busy));
        assert_eq!(stuck.write(0, &[0]), Err(FlashError::Busy));
        assert_eq!(stuck.controller().operations, 0);
        let waited = stuck.controller().counts.get().wrapping_sub(begun);
        assert!(waited <= 2 * (MOST_ERASE_MS * 10 + 20), "{waited}");
    }
    // One that is begun here and never ends.
    let mut endless = flash(|part| part.fails = [Fails::Never].into());
    assert_eq!(endless.erase(0, SECTOR as u32), Err(FlashError::Busy));
}

#[test]
fn nothing_is_begun_before_the_watchdog_is_patient() {
    let begun = Part::new().counts.get();
    let mut flash = flash(|part| part.patient_from = begun.wrapping_add(MOST_CHANGE_MS * 10));
    assert_eq!(flash.erase(0, SECTOR as u32), Ok(()));
    assert!(flash.controller().is_watchdog_patient());
    flash.controller().patient_from = begun.wrapping_add(0x7000_0000);
    assert_eq!(flash.erase(0, SECTOR as u32), Err(FlashError::Busy));
    assert_eq!(flash.controller().operations, 1);
}

#[test]
fn what_was_erased_is_not_read_from_a_cache() {
    let mut flash = flash(|_| ());
    let mut bytes = [0; 40];
    flash.read(0, &mut bytes).expect("inside");
    assert_eq!(bytes, [0x5a; 40]);
    flash.erase(0, SECTOR as u32).expect("a sector");
    flash.read(0, &mut bytes).expect("inside");
    assert_eq!(bytes, [0xff; 40]);
}

#[test]
fn addresses_that_there_are_not_are_refused() {
    let mut flash = flash(|_| ());
    let end = BYTES as u32;
    assert_eq!(flash.read(end - 3, &mut [0; 4]), Err(FlashError::Outside));
    assert_eq!(flash.write(end, &[0]), Err(FlashError::Outside));
    assert_eq!(flash.write(u32::MAX, &[0; 2]), Err(FlashError::Outside));
    assert_eq!(flash.erase(0, end + 1), Err(FlashError::Outside));
    assert_eq!(flash.erase(1, 0), Err(FlashError::Outside));
    assert_eq!(flash.erase(16, end), Err(FlashError::Outside));
    assert_eq!(flash.controller().operations, 0);
}

/// Each thing that can go wrong while storing has its name, and what was stored before is still
/// there; then it goes on.
#[test]
fn why_something_was_not_stored_is_named() {
    use Fails::{Never, Not, Silently, WithFlag};
    let cases = [
        (vec![WithFlag], NotStored::Erase),
        (vec![Never], NotStored::Erase),
        (vec![Not, WithFlag], NotStored::Write),
        (vec![Not, Never], NotStored::Write),
        (vec![Not, Not, WithFlag], NotStored::Write),
        (vec![Silently], NotStored::Kept),
        (vec![Not, Silently], NotStored::Kept),
        (vec![Not, Not, Silently], NotStored::Kept),
    ];
    for (fails, reason) in cases {
        let mut buffer = [0; _];
        let mut slots = Slots::new(flash(|_| ()), &mut buffer);
        slots.store(b"first").expect("a memory");
        let mut memory = slots.into_memory();
        memory.controller().fails = fails.clone().into();
        let mut buffer = [0; _];
        let mut slots = Slots::new(memory, &mut buffer);
        assert_eq!(slots.store(b"second"), Err(reason));
        let mut memory = slots.into_memory();
        memory.controller().busy_until = memory.controller().counts.get();
        let mut buffer = [0; _];
        let mut slots = Slots::new(memory, &mut buffer);
        assert_eq!(slots.load(), Some(&b"first"[..]), "{reason:?}");
        assert_eq!(slots.store(b"third"), Ok(()), "{reason:?}");
        assert_eq!(slots.load(), Some(&b"third"[..]));
    }
}

/// A watchdog whose registers take an update after some polls.
#[derive(Debug)]
struct Registers {
    runs: bool,
    /// Looks until a change has arrived; each polls a while, or is one of a tick.
    looks: u32,
    left: Cell<u32>,
    coming: Option<Patience>,
    in_force: Patience,
    fed_with: Option<Patience>,
    changes: u32,
}

/// As after a reset of the part.
const RESET: Patience = Patience { prescaler: 0, reload: 4095 };

impl Registers {
    fn new(looks: u32) -> Self {
        let left = Cell::new(0);
        Self { runs: false, looks, left, coming: None, in_force: RESET, fed_with: None, changes: 0 }
    }

    fn arrive(&mut self) {
        if self.left.get() == 0
            && let Some(patience) = self.coming.take()
        {
            self.in_force = patience;
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

    fn change(&mut self, patience: Patience) {
        self.arrive();
        assert!(self.coming.is_none(), "changed while a change is under way");
        assert!(self.runs, "without its oscillator no change arrives");
        self.coming = Some(patience);
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
            assert!(!(armed && dog.is_patient()), "patient while armed, tick {tick}");
        }
        // The reported timeout is in force.
        for armed in [false, true, false] {
            // The change before may still be under way.
            for _ in 0..2 * looks + 3 {
                dog.feed(armed).expect("it takes changes");
            }
            assert_eq!(dog.is_patient(), !armed);
        }
        assert_eq!(registers.fed_with, Some(DISARMED));
        assert!(registers.changes > 20);
    }
}

/// It is patient only once the part was fed with that, whenever the change arrives.
#[test]
fn flash_is_never_begun_under_the_patience_of_a_tick() {
    for looks in 0..10 {
        let mut registers = Registers::new(looks);
        let mut dog = Watchdog::start(&mut registers, 1000, 20).expect("it takes changes");
        (0..30).for_each(|_| dog.feed(true).expect("a change"));
        let mut ticks = 0;
        while !dog.is_patient() {
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
        assert!(!dog.is_patient());
    }
}

/// Each patience lasts as long as is said over all of the oscillator's tolerance, 17 to 47 kHz.
#[test]
fn patience_is_enough_at_the_fastest_oscillator() {
    let ms = |patience: Patience, hz: f64| {
        1e3 * f64::from(4 << patience.prescaler) * (f64::from(patience.reload) + 1.0) / hz
    };
    assert!(ms(DISARMED, 47e3) > f64::from(MOST_STORE_MS) + 99.0);
    assert!(ms(ARMED, 47e3) >= 6.0 && ms(ARMED, 17e3) < 20.0);
    for most in (1..22_000).step_by(7) {
        let patience = Patience::at_least(most);
        assert!(ms(patience, 47e3) >= f64::from(most), "{most} ms");
        assert!(ms(patience, 47e3) < 1.02 * f64::from(most) + 0.1, "{most} ms");
        assert!(patience.reload <= 4095 && patience.prescaler <= 6);
        assert_eq!(patience.least_ms(), ms(patience, 47e3).floor() as u32);
        assert_eq!(patience.most_ms(), ms(patience, 17e3).ceil() as u32);
    }
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

/// A generator with scripted flags and numbers.
struct Script {
    looks: VecDeque<NoiseStatus>,
    numbers: VecDeque<u32>,
    restarts: u32,
    /// Flags after the script.
    then: NoiseStatus,
    looked: u32,
}

const READY: NoiseStatus = NoiseStatus { is_ready: true, clock_error: false, seed_error: false };
const SEED: NoiseStatus = NoiseStatus { seed_error: true, ..READY };
const CLOCK: NoiseStatus = NoiseStatus { clock_error: true, ..READY };

impl NoiseGenerator for &mut Script {
    fn status(&mut self) -> NoiseStatus {
        self.looked += 1;
        self.looks.pop_front().unwrap_or(self.then)
    }

    fn read(&mut self) -> u32 {
        self.numbers.pop_front().expect("a number that is there")
    }

    fn restart(&mut self) {
        self.restarts += 1;
    }
}

fn script(looks: &[NoiseStatus], numbers: &[u32], then: NoiseStatus) -> Script {
    let (looks, numbers) = (looks.iter().copied().collect(), numbers.iter().copied().collect());
    Script { looks, numbers, restarts: 0, then, looked: 0 }
}

#[test]
fn a_generators_first_number_is_not_used_and_none_follows_itself() {
    let mut generator = script(&[], &[1, 2, 3, 3, 4, 5], READY);
    let mut noise = Noise::new(&mut generator);
    assert_eq!(noise.number(0), Some(2));
    assert_eq!(noise.number(0), Some(3));
    // 3 again: it starts again, and 4 is its first.
    assert_eq!(noise.number(0), Some(5));
    assert_eq!(generator.restarts, 1);
}

#[test]
fn a_generator_that_errs_starts_again_and_its_number_is_not_used() {
    for error in [SEED, CLOCK] {
        let mut generator = script(&[READY, error, READY, READY], &[1, 2, 3], READY);
        assert_eq!(Noise::new(&mut generator).number(0), Some(3), "{error:?}");
        assert_eq!(generator.restarts, 1, "{error:?}");
    }
}

#[test]
fn a_generator_that_gives_nothing_is_not_waited_for_for_ever() {
    for then in [NoiseStatus::default(), SEED, CLOCK] {
        let mut generator = script(&[], &[], then);
        assert_eq!(Noise::new(&mut generator).number(0), None, "{then:?}");
        assert!(generator.looked <= 10_000, "{then:?}");
    }
    // Nothing but the same number.
    let mut generator = script(&[], &[7; 100], READY);
    assert_eq!(Noise::new(&mut generator).number(0), None);
}
