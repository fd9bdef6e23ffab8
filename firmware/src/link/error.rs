//! Why a frame was not acted upon.

use serde::{Deserialize, Serialize};

/// Why a frame was not acted upon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LinkError {
    /// Longer than the longest frame.
    TooLong,
    /// Shorter than the shortest frame.
    TooShort,
    /// Invalid COBS, or lost bytes.
    Malformed,
    /// Wrong checksum.
    Checksum,
    /// Another version of the protocol.
    Version {
        /// Its version.
        got: u8,
        /// The version of this side.
        known: u8,
    },
    /// No session: it begins with a greeting, which is not accepted while armed.
    NoSession,
    /// The frame was acted upon before.
    Replayed {
        /// Its sequence number.
        sequence: u16,
    },
    /// A frame is missing before this one.
    OutOfOrder {
        /// Its sequence number.
        got: u16,
        /// The expected sequence number.
        due: u16,
    },
    /// Not exactly one message.
    NotAMessage,
    /// A greeting, but the random number generator failed.
    NoRandomNumber,
}

/// Counts of frames since boot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Acted upon.
    pub accepted: u32,
    /// [`LinkError::TooLong`], [`LinkError::TooShort`], [`LinkError::Malformed`], or a wrong
    /// checksum.
    pub broken: u32,
    /// Intact, but refused for version, sequence or message.
    pub refused: u32,
}
