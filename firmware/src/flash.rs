//! Flash that a controller writes, as its manual (RM0090, 3.6) and its data sheet (DS8626) have it.
//!
//! Flags of an earlier error are cleared before anything is begun, for with one of them set the next operation
//! fails, too. Each wait ends. What was erased or written is not read from a cache.

use crate::watchdog::MOST_CHANGE_MS;
use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Erasing a sector of 128 KB, ms: 2,000 typically, 4,000 at most where bytes are written one by one (x8), as any
/// supply allows and as `stm32f4xx-hal` does.
pub const MOST_ERASE_MS: u32 = 4_000;
/// Writing a byte, µs: 16 typically.
const MOST_WRITE_US: u32 = 100;
/// From the request to store something until that is done, ms, however little of its time the part leaves.
pub const MOST_STORE_MS: u32 =
    MOST_ERASE_MS + (crate::storage::MOST_WRITTEN as u32 * MOST_WRITE_US).div_ceil(1000);
/// Longest wait until a watchdog is patient, ms: ticks are 2 ms at most.
const MOST_PATIENCE_MS: u32 = MOST_CHANGE_MS + 10;

/// A controller of flash: its flags, what it does, and a clock.
pub trait FlashController {
    /// Of its clock in a ms.
    const COUNTS_PER_MS: u32;
    /// Bytes.
    const BYTES: usize;
    /// Bytes that are erased at once.
    const SECTOR: usize;

    /// What its clock has counted; goes round.
    fn counts(&self) -> u32;
    /// Whether a watchdog waits for as long as an erasure takes.
    fn is_watchdog_patient(&self) -> bool;
    /// An operation is under way.
    fn is_busy(&self) -> bool;
    /// Any flag of an error is set.
    fn has_error(&self) -> bool;
    /// Clears all flags of errors, and that of an operation's end.
    fn clear_flags(&mut self);
    /// Erases the sector that begins here. Whether it went well is in the flags, and in this.
    fn erase_sector(&mut self, from: u32) -> bool;
    /// Writes bytes; the same.
    fn write(&mut self, from: u32, bytes: &[u8]) -> bool;
    /// Reads bytes.
    fn read(&self, from: u32, bytes: &mut [u8]);
    /// Forgets what caches hold.
    fn flush_caches(&mut self);
}

/// Why flash did not do what it was to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Addresses that there are not.
    Outside,
    /// It stays busy for longer than any operation takes, or the watchdog does not become patient.
    Busy,
    /// A flag says that the operation failed, or a flag cannot be cleared.
    Failed,
}

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Outside => NorFlashErrorKind::OutOfBounds,
            Self::Busy | Self::Failed => NorFlashErrorKind::Other,
        }
    }
}

/// Flash behind a controller.
#[derive(Clone, Debug)]
pub struct Flash<C>(C);

impl<C: FlashController> Flash<C> {
    /// As the controller has it.
    pub const fn new(controller: C) -> Self {
        Self(controller)
    }

    /// The controller.
    pub fn controller(&mut self) -> &mut C {
        &mut self.0
    }

    /// Whether something comes true within so many ms. A clock that has stopped does not make it wait for ever: a
    /// look takes a count at least.
    fn within(&self, ms: u32, is_so: impl Fn(&C) -> bool) -> Result<(), FlashError> {
        let most = ms.saturating_mul(C::COUNTS_PER_MS);
        let begun = self.0.counts();
        for _ in 0..=most {
            if is_so(&self.0) {
                return Ok(());
            }
            if self.0.counts().wrapping_sub(begun) > most {
                break;
            }
        }
        Err(FlashError::Busy)
    }

    /// Does one thing between flags that are clear.
    fn operate(&mut self, operation: impl FnOnce(&mut C) -> bool) -> Result<(), FlashError> {
        self.within(MOST_PATIENCE_MS, C::is_watchdog_patient)?;
        self.within(MOST_ERASE_MS, |controller| !controller.is_busy())?;
        self.0.clear_flags();
        if self.0.has_error() {
            return Err(FlashError::Failed);
        }
        let done = operation(&mut self.0);
        self.within(MOST_ERASE_MS, |controller| !controller.is_busy())?;
        let done = done && !self.0.has_error();
        self.0.clear_flags();
        if done { Ok(()) } else { Err(FlashError::Failed) }
    }

    fn check(from: u32, length: usize) -> Result<(), FlashError> {
        let end = (from as usize).checked_add(length).ok_or(FlashError::Outside)?;
        if end <= C::BYTES { Ok(()) } else { Err(FlashError::Outside) }
    }
}

impl<C: FlashController> ErrorType for Flash<C> {
    type Error = FlashError;
}

impl<C: FlashController> ReadNorFlash for Flash<C> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        Self::check(offset, bytes.len())?;
        self.0.read(offset, bytes);
        Ok(())
    }

    fn capacity(&self) -> usize {
        C::BYTES
    }
}

impl<C: FlashController> NorFlash for Flash<C> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = C::SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let length = to.checked_sub(from).ok_or(FlashError::Outside)? as usize;
        Self::check(from, length)?;
        if !(from as usize).is_multiple_of(C::SECTOR) {
            return Err(FlashError::Outside);
        }
        for sector in (from..to).step_by(C::SECTOR) {
            let erased = self.operate(|controller| controller.erase_sector(sector));
            self.0.flush_caches();
            erased?;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        Self::check(offset, bytes.len())?;
        let written = self.operate(|controller| controller.write(offset, bytes));
        self.0.flush_caches();
        written
    }
}

/// Without checksums of its own: a byte that was written can lose more of its bits.
impl<C: FlashController> MultiwriteNorFlash for Flash<C> {}
