//! Flash behind its controller (RM0090 3.6, DS8626).
//!
//! Error flags are cleared before an operation, which fails otherwise. Every wait is bounded.
//! Caches are flushed after erasing and writing.

pub use super::flash_times::{MOST_ERASE_MS, MOST_STORE_MS};
use crate::hard_tick::watchdog::MOST_CHANGE_MS;
use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Longest wait for the watchdog's disarmed timeout, ms.
const MOST_TIMEOUT_CHANGE_MS: u32 = MOST_CHANGE_MS + 10;

/// Flash controller: flags, operations and a clock.
pub trait FlashController {
    /// Counts of its clock per ms.
    const COUNTS_PER_MS: u32;
    /// Size, bytes.
    const BYTES: usize;
    /// Size of a sector, bytes.
    const SECTOR: usize;

    /// Its clock, which wraps around.
    fn counts(&self) -> u32;
    /// Whether the watchdog's timeout exceeds an erase.
    fn watchdog_allows_flash(&self) -> bool;
    /// Whether an operation is running.
    fn is_busy(&self) -> bool;
    /// Whether an error flag is set.
    fn has_error(&self) -> bool;
    /// Clears the error flags and the end-of-operation flag.
    fn clear_flags(&mut self);
    /// Erases the sector at an address. Success is in the flags and in the result.
    fn erase_sector(&mut self, from: u32) -> bool;
    /// Writes bytes; as for erasing.
    fn write(&mut self, from: u32, bytes: &[u8]) -> bool;
    /// Reads bytes.
    fn read(&self, from: u32, bytes: &mut [u8]);
    /// Flushes the caches.
    fn flush_caches(&mut self);
}

/// Why an operation failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashError {
    /// Address out of range.
    Outside,
    /// It stays busy too long, or the watchdog does not take the disarmed timeout.
    Busy,
    /// An error flag is set, or cannot be cleared.
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
    /// Takes over a controller.
    pub const fn new(controller: C) -> Self {
        Self(controller)
    }

    /// The controller.
    pub fn controller(&mut self) -> &mut C {
        &mut self.0
    }

    /// Waits for a condition for at most `ms`. A stopped clock does not block: each poll counts as
    /// at least one count.
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

    /// Runs one operation with cleared flags.
    fn operate(&mut self, operation: impl FnOnce(&mut C) -> bool) -> Result<(), FlashError> {
        self.within(MOST_TIMEOUT_CHANGE_MS, C::watchdog_allows_flash)?;
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
