//! The link to a host: messages in frames over any line that carries bytes.
//!
//! A frame is COBS of (version, sequence number, message by postcard, CRC-32), and a zero. The CRC
//! begins with the number of the session, made of a random number of the device's and a nonce of
//! the host's (see [`Randomness`](crate::Randomness)); it keeps out frames of other sessions, but
//! does not authenticate the sender. Only a whole frame of this version with a good checksum, the
//! next sequence number and a complete message is acted upon; everything else is counted and
//! answered with a [`LinkError`].

mod control;
mod error;
pub mod flash;
pub(crate) mod flash_times;
mod frame;
mod message;
pub(crate) mod ram;
pub(crate) mod randomness;
pub(crate) mod server;
mod session;
pub(crate) mod storage;
pub(crate) mod uploads;

pub use crate::between::motion::{AngleReading, Target};
pub use control::{Commanded, ControlUpload, Modulation};
pub use error::{Counters, LinkError};
pub use frame::{
    Frame, MOST_CONTENT, MOST_FRAME, NO_SESSION, Receiver, SessionNumber, VERSION, encode,
};
pub use message::{
    Answer, Electrode, Info, MOST_ROWS, MOST_WORDS, Message, Mode, Readings, Refusal, Report,
    Request, RowInputs, RowOutputs, Traced, Upload,
};
pub use session::Session;
