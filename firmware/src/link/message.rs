//! What host and device say to each other. Adding to an enumeration's end keeps the version; all else changes it.

use crate::configuration::{MUSCLES, TYPES};
use crate::link::{Counters, LinkError, SessionNumber};
use crate::safety::{CHANNELS, Fault, NotArmed, State};
use crate::stimulus::{Stimulus, StimulusError};
use crate::storage::NotStored;
use heapless::Vec;
use serde::{Deserialize, Serialize};
use vm_nostd::{Limit, MuscleParams, ParameterError, RecruitmentCurveParams};

/// Rows in a message.
pub const MOST_ROWS: usize = 8;
/// Words of a muscle's state that a message has room for.
pub const MOST_WORDS: usize = 16;

/// From the host. Each is answered by a [`Message::Answer`], and begins only when the one before is answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
// What arrives is taken apart at once.
#[allow(clippy::large_enum_variant)]
pub enum Request {
    /// Begins a session, from this sequence number on; not acted upon while armed. Answer: [`Answer::Info`].
    Hello {
        /// A number that the host makes up: the session's is made of this and of the device's.
        nonce: u32,
    },
    /// Nothing but that the host is there.
    KeepAlive,
    /// A muscle for a place: validated, stored, and put there at rest. Refused while armed.
    Upload {
        /// 0 to [`MUSCLES`] - 1.
        place: u8,
        /// What goes there.
        upload: Upload,
    },
    /// All muscles at rest on these path lengths (m), by themselves midway between the shortest path and the
    /// longest that morphometry says; rows are counted
    /// from 0 again. Refused while armed.
    Rest([Option<f32>; MUSCLES]),
    /// Inputs of the next ticks. The muscles' time is that of their rows: where none is there, they wait. What a row
    /// asks of an electrode is put out for [`Limits::rows_ms`](crate::Limits::rows_ms) at most. A fault,
    /// or a stop, while armed takes with it the rows that have not had their tick.
    Rows {
        /// Number of the first.
        first: u32,
        /// Inputs of each tick.
        rows: Vec<[RowInputs; MUSCLES], MOST_ROWS>,
    },
    /// Stimuli of the channels that no electrode of a muscle has. They are put out for
    /// [`Limits::drives_ms`](crate::Limits::drives_ms) at most: hosts repeat them.
    Drive([Option<Stimulus>; CHANNELS]),
    /// What sensors read. The path counts as missing once it is older than
    /// [`Limits::readings_ms`](crate::Limits::readings_ms).
    Readings(Readings),
    /// First step of arming: the fault that was seen.
    Acknowledge(Fault),
    /// Second step of arming.
    Arm,
    /// Everything off, latched as [`Fault::Stopped`] unless another fault is latched already.
    Stop,
    /// Answer: [`Answer::Report`].
    Report,
    /// Answer: [`Answer::State`].
    State {
        /// 0 to [`MUSCLES`] - 1.
        place: u8,
    },
}

/// How a muscle is recruited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Naturally, continuous.
    Continuous,
    /// By intramuscular FES.
    Fes,
}

/// A muscle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Upload {
    /// How it is recruited.
    pub mode: Mode,
    /// What it is.
    pub muscle: MuscleParams<TYPES>,
    /// What stimulates it, if rows are to do that as well: FES only.
    pub electrode: Option<Electrode>,
}

/// What stimulates a muscle: each row's activation and frequency become pulses of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Electrode {
    /// 0 to [`CHANNELS`] - 1.
    pub channel: u8,
    /// Which amplitude recruits how much.
    pub curve: RecruitmentCurveParams,
    /// See [`Stimulus::width_us`].
    pub width_us: u16,
    /// See [`Stimulus::gap_us`].
    pub gap_us: u16,
    /// See [`Stimulus::recovery`].
    pub recovery: u8,
}

/// Inputs of a muscle in a tick; outside of their ranges they are clipped and flagged. For a muscle with an electrode,
/// an activation or a frequency that is infinite or not a number is [`Fault::Request`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RowInputs {
    /// U, 0..1.
    pub activation: f32,
    /// L_mt at the tick's end, m.
    pub path_length: f32,
    /// f_stim, pps.
    pub stimulation_frequency: f32,
}

/// What sensors read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Readings {
    /// Ω of every channel; none where it was not measured yet.
    pub impedance_ohm: [Option<u32>; CHANNELS],
    /// mV.
    pub supply_mv: u32,
    /// Path length, µm; none if the sensor gives no number.
    pub path_um: Option<i32>,
}

/// To the host.
// It is made where it is sent, and taken apart where it arrives.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Message<'a> {
    /// To a request.
    Answer {
        /// Its sequence number.
        to: u16,
        /// The answer.
        #[serde(borrow)]
        answer: Answer<'a>,
    },
    /// A frame was not acted upon.
    NotActedUpon(LinkError),
    /// What rows have led to.
    Traces(Vec<Traced, MOST_ROWS>),
}

/// To a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// It was done.
    Done,
    /// It was not.
    Refused(#[serde(borrow)] Refusal<'a>),
    /// See there.
    Info(Info),
    /// See there.
    Report(Report),
    /// All words of a muscle's state.
    State(Vec<u32, MOST_WORDS>),
}

/// Why a request was not done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal<'a> {
    /// A parameter of a muscle or of its recruitment curve.
    Parameter {
        /// See [`ParameterError::field`].
        field: &'a str,
        /// See [`ParameterError::fiber`].
        fiber: Option<u8>,
        /// See [`ParameterError::value`].
        value: f64,
        /// See [`ParameterError::limit`].
        limit: Limit,
    },
    /// A whole number.
    Number {
        /// Its field.
        field: &'a str,
        /// The refused value.
        value: u32,
        /// The least that is taken.
        least: u32,
        /// The most that is taken.
        most: u32,
    },
    /// Not while stimulation is armed.
    Armed,
    /// Nothing is at that place.
    Empty,
    /// Only so many rows of these can wait.
    NoRoom {
        /// How many.
        room: u32,
    },
    /// Memory did not keep what it was given. What was stored before still is, and the next boot restores it, unless the
    /// reason is [`NotStored::Unknown`].
    NotStored(NotStored),
    /// Supervision did not go along.
    NotArmed(NotArmed),
    /// The electrode of another muscle has that channel.
    ChannelTaken {
        /// The channel.
        channel: u8,
        /// The place of that muscle.
        place: u8,
    },
}

impl From<ParameterError> for Refusal<'static> {
    fn from(error: ParameterError) -> Self {
        let ParameterError { field, fiber, value, limit } = error;
        // Types of a muscle are few.
        Self::Parameter { field, fiber: fiber.map(|index| index as u8), value, limit }
    }
}

impl From<StimulusError> for Refusal<'static> {
    fn from(error: StimulusError) -> Self {
        let StimulusError { field, value, least, most } = error;
        Self::Number { field, value, least, most }
    }
}

/// What a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Info {
    /// Muscles it has places for.
    pub muscles: u8,
    /// Fibre types of each.
    pub types: u8,
    /// Channels.
    pub channels: u8,
    /// What frames of this session begin their checksums with.
    pub session: SessionNumber,
    /// Time between ticks, µs.
    pub tick_us: u32,
    /// Places that had a muscle in memory at boot.
    pub restored: u8,
}

/// How a device is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// Where supervision is.
    pub state: State,
    /// What is wrong with what it sees, if anything.
    pub wrong: Option<Fault>,
    /// Ticks since boot.
    pub ticks: u32,
    /// Rows since the muscles' rest.
    pub rows: u32,
    /// From when a tick was due until it had ended, the longest since boot, µs.
    pub longest_us: u32,
    /// Ticks that began or ended too late since boot.
    pub late: u32,
    /// Frames since boot.
    pub frames: Counters,
}

/// What a row has led to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Traced {
    /// The row's number.
    pub row: u32,
    /// Of each muscle; nothing where there is none.
    pub outputs: [RowOutputs; MUSCLES],
}

/// Outputs of a muscle in a tick, to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RowOutputs {
    /// N.
    pub force: f32,
    /// L_ce0.
    pub fascicle_length: f32,
    /// L_ce0/s.
    pub fascicle_velocity: f32,
    /// Bits of the model's status.
    pub status: u16,
}
