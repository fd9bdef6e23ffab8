//! Non-volatile storage in two slots, of which one is always intact.
//!
//! A slot is a header (magic, generation, length, CRC-32 of the rest) and a content. Storing erases
//! the older slot, writes its content and then its header, which makes it the newer one. If power
//! is lost on the way, the other slot stays valid. After an error, a slot that may not hold its
//! content is invalidated.

use crate::link::VERSION;
use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use serde::{Deserialize, Serialize};

/// Longest content, bytes.
pub const MOST_STORED: usize = 2048;
const HEADER: usize = 16;
/// Of a slot.
const MOST_SLOT: usize = HEADER + MOST_STORED;
/// Most bytes that storing writes: a slot, and another header after an error.
pub(crate) const MOST_WRITTEN: usize = MOST_SLOT + HEADER;
/// Magic number with the protocol's version, on which the layout depends.
const MAGIC: u32 = 0x4D53_4D00 + VERSION as u32;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why a content was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotStored {
    /// It is longer than [`MOST_STORED`].
    TooLong,
    /// Reading failed; nothing was erased.
    Read,
    /// Erasing failed.
    Erase,
    /// Writing failed.
    Write,
    /// Verification failed: it reads back differently.
    Kept,
    /// Memory failed more than once: the next boot may restore this content or the one before.
    Unknown,
}

/// An intact slot.
#[derive(Clone, Copy, Debug)]
struct Whole {
    slot: u32,
    generation: u32,
    length: usize,
}

/// Buffer of a slot.
pub type SlotBuffer = [u8; MOST_SLOT];

/// Two slots in the halves of a memory, each of whole pages.
#[derive(Debug)]
pub struct Slots<'b, F> {
    memory: F,
    buffer: &'b mut SlotBuffer,
}

impl<'b, F: MultiwriteNorFlash> Slots<'b, F> {
    /// Takes over a memory with its contents.
    pub fn new(memory: F, buffer: &'b mut SlotBuffer) -> Self {
        Self { memory, buffer }
    }

    /// Returns the memory.
    pub fn into_memory(self) -> F {
        self.memory
    }

    /// The content stored last, if any.
    pub fn load(&mut self) -> Option<&[u8]> {
        let Whole { slot, length, .. } = self.newest().ok()??;
        // The buffer may hold the other slot.
        self.whole(slot).ok()??;
        self.buffer.get(HEADER..HEADER + length)
    }

    /// Stores a content. Until it is complete, and after an error other than
    /// [`NotStored::Unknown`], the content before stays valid.
    pub fn store(&mut self, content: &[u8]) -> Result<(), NotStored> {
        if content.len() > MOST_STORED {
            return Err(NotStored::TooLong);
        }
        // An unreadable memory may hold a valid content.
        let newest = self.newest()?;
        let (slot, generation) =
            newest.map_or((0, 0), |newest| (1 - newest.slot, newest.generation.wrapping_add(1)));
        let padded = content.len().next_multiple_of(F::WRITE_SIZE);
        self.buffer.fill(0xff);
        let place =
            self.buffer.get_mut(HEADER..HEADER + content.len()).ok_or(NotStored::TooLong)?;
        place.copy_from_slice(content);
        // Fits the buffer.
        let length = content.len() as u32;
        let fields = [MAGIC, generation, length];
        for (place, field) in self.buffer.chunks_exact_mut(4).zip(fields) {
            place.copy_from_slice(&field.to_le_bytes());
        }
        let crc = checksum(self.buffer, content.len()).ok_or(NotStored::TooLong)?;
        self.buffer
            .get_mut(12..HEADER)
            .ok_or(NotStored::TooLong)?
            .copy_from_slice(&crc.to_le_bytes());

        let start = slot * self.half();
        self.memory.erase(start, start + self.half()).map_err(|_| NotStored::Erase)?;
        let written = self.buffer.get(HEADER..HEADER + padded).ok_or(NotStored::TooLong)?;
        self.memory.write(start + HEADER as u32, written).map_err(|_| NotStored::Write)?;
        // The header makes it valid.
        self.seal(start, slot, generation, content)
            .map_err(|error| if self.unseal(start, slot) { error } else { NotStored::Unknown })
    }

    /// Writes the header and verifies everything, because a worn page may fail.
    fn seal(
        &mut self,
        start: u32,
        slot: u32,
        generation: u32,
        content: &[u8],
    ) -> Result<(), NotStored> {
        let header = self.buffer.get(..HEADER).ok_or(NotStored::TooLong)?;
        self.memory.write(start, header).map_err(|_| NotStored::Write)?;
        let kept = self.whole(slot)?.ok_or(NotStored::Kept)?;
        let same = self.buffer.get(HEADER..HEADER + kept.length) == Some(content);
        if kept.generation == generation && same { Ok(()) } else { Err(NotStored::Kept) }
    }

    /// Invalidates a slot by clearing its header. Whether that is certain.
    fn unseal(&mut self, start: u32, slot: u32) -> bool {
        let _what_is_read_decides = self.memory.write(start, &[0; HEADER]);
        matches!(self.whole(slot), Ok(None))
    }

    fn half(&self) -> u32 {
        // Addresses have 32 bits.
        (self.memory.capacity() / 2) as u32
    }

    fn newest(&mut self) -> Result<Option<Whole>, NotStored> {
        Ok(match (self.whole(0)?, self.whole(1)?) {
            (Some(first), Some(second)) => {
                // Generations wrap around.
                let ahead = second.generation.wrapping_sub(first.generation);
                Some(if ahead < 0x8000_0000 { second } else { first })
            }
            (first, second) => first.or(second),
        })
    }

    /// Reads a slot into the buffer; its description if it is intact.
    fn whole(&mut self, slot: u32) -> Result<Option<Whole>, NotStored> {
        self.memory.read(slot * self.half(), self.buffer).map_err(|_| NotStored::Read)?;
        let mut fields = [0; 4];
        for (field, bytes) in fields.iter_mut().zip(self.buffer.chunks_exact(4)) {
            *field = bytes.try_into().map_or(0, u32::from_le_bytes);
        }
        let [magic, generation, length, crc] = fields;
        let length = length as usize;
        let whole = magic == MAGIC && checksum(self.buffer, length) == Some(crc);
        Ok(whole.then_some(Whole { slot, generation, length }))
    }
}

/// Checksum of the header's first three fields and the content; none if that is too long.
fn checksum(slot: &[u8], length: usize) -> Option<u32> {
    let mut digest = CRC.digest();
    digest.update(slot.get(..12)?);
    digest.update(slot.get(HEADER..HEADER.checked_add(length)?)?);
    Some(digest.finalize())
}
