//! Non-volatile storage: the last two sectors of flash.

use super::chip::CORE_CLOCK;
use super::chip::pac::{DWT, FLASH};
use super::watchdog;
use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};
use firmware::RamFlash;
use firmware::flash::{Flash, FlashController};
use stm32f4xx_hal::flash::FlashExt;

/// Where the last two sectors of flash begin; `memory.x` keeps the program out of them.
const STORAGE: u32 = 768 * 1024;
const STORAGE_BYTES: usize = 256 * 1024;
const SECTOR: usize = STORAGE_BYTES / 2;

/// The part's flash, from [`STORAGE`] on. It waits in `stm32f4xx-hal` during an operation: the core
/// stalls then in any case, and the watchdog ends an operation that hangs.
pub struct Controller(FLASH);

impl Controller {
    pub(super) fn new(flash: FLASH) -> Self {
        Self(flash)
    }
}

impl FlashController for Controller {
    const COUNTS_PER_MS: u32 = CORE_CLOCK / 1000;
    const BYTES: usize = STORAGE_BYTES;
    const SECTOR: usize = SECTOR;

    fn counts(&self) -> u32 {
        DWT::cycle_count()
    }

    fn watchdog_allows_flash(&self) -> bool {
        watchdog::allows_flash()
    }

    fn is_busy(&self) -> bool {
        self.0.sr().read().bsy().bit_is_set()
    }

    fn has_error(&self) -> bool {
        let flags = self.0.sr().read();
        flags.operr().bit_is_set()
            || flags.wrperr().bit_is_set()
            || flags.pgaerr().bit_is_set()
            || flags.pgperr().bit_is_set()
            || flags.pgserr().bit_is_set()
    }

    fn clear_flags(&mut self) {
        self.0.sr().write(|w| {
            w.eop().clear_bit_by_one();
            w.operr().clear_bit_by_one();
            w.wrperr().clear_bit_by_one();
            w.pgaerr().clear_bit_by_one();
            w.pgperr().clear_bit_by_one();
            w.pgserr().clear_bit_by_one()
        });
    }

    fn erase_sector(&mut self, from: u32) -> bool {
        let Some(sector) = self.0.sector((STORAGE + from) as usize) else { return false };
        self.0.unlocked().erase(sector.number).is_ok()
    }

    fn write(&mut self, from: u32, bytes: &[u8]) -> bool {
        self.0.unlocked().program((STORAGE + from) as usize, bytes.iter()).is_ok()
    }

    fn read(&self, from: u32, bytes: &mut [u8]) {
        let from = (STORAGE + from) as usize;
        let stored = FlashExt::read(&self.0).get(from..from + bytes.len());
        bytes.iter_mut().zip(stored.unwrap_or_default()).for_each(|(to, byte)| *to = *byte);
    }

    fn flush_caches(&mut self) {
        // Only while they are off.
        let acr = self.0.acr();
        acr.modify(|_, w| w.dcen().clear_bit().icen().clear_bit());
        acr.modify(|_, w| w.dcrst().set_bit().icrst().set_bit());
        acr.modify(|_, w| w.dcrst().clear_bit().icrst().clear_bit());
        acr.modify(|_, w| w.dcen().set_bit().icen().set_bit());
    }
}

/// RAM in place of flash in QEMU.
pub type EmulatedFlash = RamFlash<8192>;

/// Non-volatile memory; in QEMU, volatile.
pub enum Memory {
    /// Two sectors.
    Flash(Flash<Controller>),
    /// The same in small.
    Ram(&'static mut EmulatedFlash),
}

/// Memory failed.
#[derive(Debug)]
pub struct MemoryError;

impl NorFlashError for MemoryError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Memory {
    type Error = MemoryError;
}

impl ReadNorFlash for Memory {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), MemoryError> {
        match self {
            Self::Flash(flash) => flash.read(offset, bytes).map_err(|_| MemoryError),
            Self::Ram(ram) => ram.read(offset, bytes).map_err(|_| MemoryError),
        }
    }

    fn capacity(&self) -> usize {
        match self {
            Self::Flash(flash) => flash.capacity(),
            Self::Ram(ram) => ram.capacity(),
        }
    }
}

impl NorFlash for Memory {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), MemoryError> {
        match self {
            Self::Flash(flash) => flash.erase(from, to).map_err(|_| MemoryError),
            Self::Ram(ram) => ram.erase(from, to).map_err(|_| MemoryError),
        }
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), MemoryError> {
        match self {
            Self::Flash(flash) => flash.write(offset, bytes).map_err(|_| MemoryError),
            Self::Ram(ram) => ram.write(offset, bytes).map_err(|_| MemoryError),
        }
    }
}

impl MultiwriteNorFlash for Memory {}
