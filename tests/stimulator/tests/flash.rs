//! Failures of the chip's flash, per its manual: a part in this process that stays busy or keeps
//! flags of old errors.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use firmware::flash::{Flash, FlashController, FlashError, MOST_ERASE_MS};
use firmware::watchdog::MOST_CHANGE_MS;
use firmware::{NotStored, Slots};
use std::cell::{Cell, RefCell};
use std::collections::{HashMap, VecDeque};

/// Of the part in this process.
const BYTES: usize = 16_384;
const SECTOR: usize = BYTES / 2;

/// A part's flash.
struct Part {
    kept: Vec<u8>,
    /// Lines of its data cache, sixteen bytes each.
    cached: RefCell<HashMap<usize, Vec<u8>>>,
    /// Its clock, which advances by so many counts when polled.
    counts: Cell<u32>,
    clock_step: u32,
    busy_until: u32,
    /// Flags of errors; those that cannot be cleared.
    error: bool,
    stuck_error: bool,
    allowed_from: u32,
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
            cached: RefCell::default(),
            counts: Cell::new(u32::MAX - 1000),
            clock_step: 1,
            busy_until: u32::MAX - 1000,
            error: false,
            stuck_error: false,
            allowed_from: u32::MAX - 1000,
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
        self.counts.set(self.counts.get().wrapping_add(self.clock_step));
        self.counts.get()
    }

    fn watchdog_allows_flash(&self) -> bool {
        self.is_reached(self.allowed_from)
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
    // As long as erasing takes at most, from an operation that something else has begun; the clock
    // is read once for the watchdog before, and once when the wait begins.
    let begins = begun.wrapping_add(2);
    for (late, ends) in [(0, Ok(())), (1, Err(FlashError::Busy))] {
        let until = begins.wrapping_add(MOST_ERASE_MS * 10 + late);
        assert_eq!(flash(|part| part.busy_until = until).erase(0, SECTOR as u32), ends, "{late}");
    }
    // A clock of which every count is seen, one that runs faster, and one that stands still.
    for clock_step in [1, 7, 0] {
        let mut stuck = flash(|part| {
            part.busy_until = begun.wrapping_add(0x7fff_ffff);
            part.clock_step = clock_step;
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
fn nothing_is_begun_before_the_watchdog_allows_flash() {
    let begun = Part::new().counts.get();
    let mut flash = flash(|part| part.allowed_from = begun.wrapping_add(MOST_CHANGE_MS * 10));
    assert_eq!(flash.erase(0, SECTOR as u32), Ok(()));
    assert!(flash.controller().watchdog_allows_flash());
    flash.controller().allowed_from = begun.wrapping_add(0x7000_0000);
    let waits_from = flash.controller().counts.get();
    assert_eq!(flash.erase(0, SECTOR as u32), Err(FlashError::Busy));
    assert_eq!(flash.controller().operations, 1);
    // About as long as a change takes, and no longer.
    let waited = flash.controller().counts.get().wrapping_sub(waits_from);
    assert!(waited < 2 * MOST_CHANGE_MS * 10, "{waited}");
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
