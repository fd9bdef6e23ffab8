//! Frames: where one ends, and whether it is whole.

use crate::link::LinkError;
use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use serde::Serialize;

/// Of this format and its messages: other versions are refused.
pub const VERSION: u8 = 2;
/// Longest message, bytes.
pub const MOST_CONTENT: usize = 1024;
/// Version, and sequence number in little endian.
const HEADER: usize = 3;
/// CRC-32 of header and content, in little endian.
const TRAILER: usize = 4;
/// A whole frame before COBS.
const MOST_WHOLE: usize = HEADER + MOST_CONTENT + TRAILER;
/// Longest frame on the line, bytes: COBS adds one in 254, and there is the zero.
pub const MOST_FRAME: usize = cobs::max_encoding_length(MOST_WHOLE) + 1;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What a frame's checksum begins with: another number for each session, so that frames of another one are none of
/// this, but for one in 2^31; [`NO_SESSION`] for greetings, and for all that the device says.
pub type SessionNumber = u32;
/// See [`SessionNumber`].
pub const NO_SESSION: SessionNumber = 0;

/// A whole frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The session it belongs to, or [`NO_SESSION`].
    pub session: SessionNumber,
    /// Sequence number.
    pub sequence: u16,
    /// A message by postcard.
    pub content: &'a [u8],
}

/// Makes a frame of a message, its zero included; none if the message is longer than [`MOST_CONTENT`].
pub fn encode(
    session: SessionNumber,
    sequence: u16,
    message: &impl Serialize,
) -> Option<Vec<u8, MOST_FRAME>> {
    let mut whole = [0; MOST_WHOLE];
    let (header, rest) = whole.split_at_mut(HEADER);
    let [low, high] = sequence.to_le_bytes();
    header.copy_from_slice(&[VERSION, low, high]);
    let room = rest.get_mut(..MOST_CONTENT)?;
    let length = HEADER + postcard::to_slice(message, room).ok()?.len();
    let crc = checksum(session, whole.get(..length)?);
    whole.get_mut(length..length + TRAILER)?.copy_from_slice(&crc.to_le_bytes());

    let mut frame = Vec::new();
    frame.resize(MOST_FRAME, 0).ok()?;
    let encoded = cobs::try_encode(whole.get(..length + TRAILER)?, &mut frame).ok()?;
    // The encoder may have written behind its end, where a run of 254 bytes ends there.
    frame.truncate(encoded);
    frame.push(0).ok()?;
    Some(frame)
}

fn checksum(session: SessionNumber, covered: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(&session.to_le_bytes());
    digest.update(covered);
    digest.finalize()
}

/// Collects the bytes of a line until a frame is whole.
#[derive(Debug, Default)]
pub struct Receiver {
    /// Of a frame, without the zero that ends it.
    bytes: Vec<u8, { MOST_FRAME - 1 }>,
    /// The frame that was whole last is still in `bytes`.
    taken: bool,
    /// More bytes came than a frame has.
    too_long: bool,
    /// A byte of this frame did not arrive.
    incomplete: bool,
}

impl Receiver {
    /// Nothing has arrived.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), taken: false, too_long: false, incomplete: false }
    }

    /// A byte was lost on the line, or arrived as none: what has begun, or begins next, is no frame.
    pub fn lost(&mut self) {
        self.incomplete = true;
    }

    /// Takes a byte. Where it ends a frame, of this session or of none, that is what comes back, or why it is none.
    pub fn push(
        &mut self,
        byte: u8,
        session: SessionNumber,
    ) -> Option<Result<Frame<'_>, LinkError>> {
        if core::mem::take(&mut self.taken) {
            self.bytes.clear();
        }
        if byte != 0 {
            self.too_long |= self.bytes.push(byte).is_err();
            return None;
        }
        self.taken = true;
        let incomplete = core::mem::take(&mut self.incomplete);
        if core::mem::take(&mut self.too_long) {
            return Some(Err(LinkError::TooLong));
        }
        if incomplete {
            return Some(Err(LinkError::Malformed));
        }
        // Zeros between frames are no frames: a sender may begin with one to be sure.
        if self.bytes.is_empty() { None } else { Some(whole(&mut self.bytes, session)) }
    }
}

/// The frame in the bytes between two zeros.
fn whole(bytes: &mut [u8], session: SessionNumber) -> Result<Frame<'_>, LinkError> {
    let length = cobs::decode_in_place(bytes).map_err(|_| LinkError::Malformed)?;
    let bytes = bytes.get(..length).ok_or(LinkError::Malformed)?;
    let (covered, crc) = bytes.split_last_chunk::<TRAILER>().ok_or(LinkError::TooShort)?;
    let (&[version, low, high], content) =
        covered.split_first_chunk::<HEADER>().ok_or(LinkError::TooShort)?;
    let crc = u32::from_le_bytes(*crc);
    let session = [session, NO_SESSION]
        .into_iter()
        .find(|session| checksum(*session, covered) == crc)
        .ok_or(LinkError::Checksum)?;
    if version != VERSION {
        return Err(LinkError::Version { got: version, known: VERSION });
    }
    Ok(Frame { session, sequence: u16::from_le_bytes([low, high]), content })
}
