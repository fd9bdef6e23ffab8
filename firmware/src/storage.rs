//! What has to outlast a loss of power: two slots, of which one is always whole.
//!
//! A slot is a header (magic, generation, length, CRC-32 of the rest) and a content. Storing erases the slot that
//! does not count, writes its content and then its header; only that makes it the newer one. Wherever power is
//! lost, the slot that counted before still does. Whatever fails on the way, a slot that is not known to hold what it
//! should is made not to count before an error is returned.

use crate::link::VERSION;
use crc::{CRC_32_ISO_HDLC, Crc};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use serde::{Deserialize, Serialize};

/// Longest content, bytes.
pub const MOST_STORED: usize = 2048;
const HEADER: usize = 16;
/// Of a slot.
const MOST_SLOT: usize = HEADER + MOST_STORED;
/// Bytes that storing writes at most: a slot, and another header where that fails.
pub(crate) const MOST_WRITTEN: usize = MOST_SLOT + HEADER;
/// Whose it is, and of which messages: other versions lay a muscle out in another way.
const MAGIC: u32 = 0x4D53_4D00 + VERSION as u32;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why memory did not take or keep a content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum NotStored {
    /// It is longer than [`MOST_STORED`].
    TooLong,
    /// What is stored could not be read: nothing was erased.
    Read,
    /// The slot for it was not erased.
    Erase,
    /// It was not written.
    Write,
    /// It was written, and is not what is read.
    Kept,
    /// Memory failed more than once: what the next boot restores may be this or what was stored before.
    Unknown,
}

/// A slot that is whole.
#[derive(Clone, Copy, Debug)]
struct Whole {
    slot: u32,
    generation: u32,
    length: usize,
}

/// What a slot is read to and written from.
pub type SlotBuffer = [u8; MOST_SLOT];

/// Two slots in a memory of two equal halves, each of whole pages of it.
#[derive(Debug)]
pub struct Slots<'b, F> {
    memory: F,
    buffer: &'b mut SlotBuffer,
}

impl<'b, F: MultiwriteNorFlash> Slots<'b, F> {
    /// Takes over a memory, as it is.
    pub fn new(memory: F, buffer: &'b mut SlotBuffer) -> Self {
        Self { memory, buffer }
    }

    /// Gives the memory back.
    pub fn into_memory(self) -> F {
        self.memory
    }

    /// What was stored last, if anything.
    pub fn load(&mut self) -> Option<&[u8]> {
        let Whole { slot, length, .. } = self.newest().ok()??;
        // Both were in the buffer; it may hold the other one.
        self.whole(slot).ok()??;
        self.buffer.get(HEADER..HEADER + length)
    }

    /// Stores a content; what was stored before counts until this is whole, and after an error still does, unless that
    /// is [`NotStored::Unknown`].
    pub fn store(&mut self, content: &[u8]) -> Result<(), NotStored> {
        if content.len() > MOST_STORED {
            return Err(NotStored::TooLong);
        }
        // A memory that cannot be read may hold a content that counts.
        let newest = self.newest()?;
        let (slot, generation) =
            newest.map_or((0, 0), |newest| (1 - newest.slot, newest.generation.wrapping_add(1)));
        let padded = content.len().next_multiple_of(F::WRITE_SIZE);
        self.buffer.fill(0xff);
        let place =
            self.buffer.get_mut(HEADER..HEADER + content.len()).ok_or(NotStored::TooLong)?;
        place.copy_from_slice(content);
        // No longer than the buffer.
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
        // With its header it counts.
        self.seal(start, slot, generation, content)
            .map_err(|error| if self.unseal(start, slot) { error } else { NotStored::Unknown })
    }

    /// Writes the header, and reads everything again: a worn page may keep something else.
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

    /// Clears every bit of a header. Whether it is known that the slot does not count.
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
                // Generations go round.
                let ahead = second.generation.wrapping_sub(first.generation);
                Some(if ahead < 0x8000_0000 { second } else { first })
            }
            (first, second) => first.or(second),
        })
    }

    /// Reads a slot into the buffer, and says what it holds if it is whole.
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

/// Of the header's first three fields and a content of so many bytes; none if that is too long.
fn checksum(slot: &[u8], length: usize) -> Option<u32> {
    let mut digest = CRC.digest();
    digest.update(slot.get(..12)?);
    digest.update(slot.get(HEADER..HEADER.checked_add(length)?)?);
    Some(digest.finalize())
}
