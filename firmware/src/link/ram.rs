//! Volatile memory in place of flash, for QEMU and tests.

use embedded_storage::nor_flash::{
    ErrorType, MultiwriteNorFlash, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// RAM that behaves like flash.
#[derive(Clone, Debug)]
pub struct RamFlash<const BYTES: usize>([u8; BYTES]);

impl<const BYTES: usize> Default for RamFlash<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const BYTES: usize> RamFlash<BYTES> {
    /// Erased.
    pub const fn new() -> Self {
        Self([0xff; BYTES])
    }

    fn part(&mut self, from: u32, length: usize) -> Result<&mut [u8], Outside> {
        let from = from as usize;
        let to = from.checked_add(length).ok_or(Outside)?;
        self.0.get_mut(from..to).ok_or(Outside)
    }
}

/// Address out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outside;

impl NorFlashError for Outside {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::OutOfBounds
    }
}

impl<const BYTES: usize> ErrorType for RamFlash<BYTES> {
    type Error = Outside;
}

impl<const BYTES: usize> ReadNorFlash for RamFlash<BYTES> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Outside> {
        bytes.copy_from_slice(self.part(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<const BYTES: usize> NorFlash for RamFlash<BYTES> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BYTES / 2;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Outside> {
        let length = to.checked_sub(from).ok_or(Outside)? as usize;
        self.part(from, length)?.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Outside> {
        // Writing can only clear bits.
        let place = self.part(offset, bytes.len())?;
        place.iter_mut().zip(bytes).for_each(|(kept, byte)| *kept &= byte);
        Ok(())
    }
}

impl<const BYTES: usize> MultiwriteNorFlash for RamFlash<BYTES> {}
