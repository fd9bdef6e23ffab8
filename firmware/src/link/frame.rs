//! Framing: COBS, CRC, version and sequence number.

use super::error::LinkError;
use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use serde::Serialize;

/// Version of the frame format and its messages; others are refused.
pub const VERSION: u8 = 4;
/// Longest message, bytes.
pub const MOST_CONTENT: usize = 1024;
/// Version, and sequence number in little endian.
const HEADER: usize = 3;
/// CRC-32 of header and content, in little endian.
const TRAILER: usize = 4;
/// Longest frame before COBS.
const MOST_WHOLE: usize = HEADER + MOST_CONTENT + TRAILER;
/// Longest frame on the line, bytes: COBS adds one in 254, and a zero ends it.
pub const MOST_FRAME: usize = cobs::max_encoding_length(MOST_WHOLE) + 1;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Initial value of a frame's checksum, different for each session, so that frames of another
/// session are refused, except one in 2^31. [`NO_SESSION`] for greetings and for all frames of the
/// device.
pub type SessionNumber = u32;
/// The number of no session, see [`SessionNumber`].
pub const NO_SESSION: SessionNumber = 0;

/// A whole frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// The session it belongs to, or [`NO_SESSION`].
    pub session: SessionNumber,
    /// Sequence number.
    pub sequence: u16,
    /// A message in postcard's format.
    pub content: &'a [u8],
}

/// Encodes a message as a frame, with its zero; none if it is longer than [`MOST_CONTENT`].
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
    // The encoder may write one byte beyond its end after a run of 254 bytes.
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

/// Collects the bytes of a line into frames.
#[derive(Debug, Default)]
pub struct Receiver {
    /// Bytes of a frame, without its zero.
    bytes: Vec<u8, { MOST_FRAME - 1 }>,
    /// `bytes` holds the last complete frame.
    taken: bool,
    /// More bytes than the longest frame.
    too_long: bool,
    /// A byte of this frame was lost.
    incomplete: bool,
}

impl Receiver {
    /// An empty receiver.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), taken: false, too_long: false, incomplete: false }
    }

    /// A byte was lost or damaged: the current or next frame is refused.
    pub fn lost(&mut self) {
        self.incomplete = true;
    }

    /// Takes a byte. If it ends a frame, returns the frame, of this session or of none, or an
    /// error.
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

/// Decodes the bytes between two zeros.
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
