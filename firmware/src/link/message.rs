//! Messages between host and device. Appending to an enumeration keeps the version; any other
//! change raises it.

use super::control::{Commanded, ControlUpload};
use super::error::{Counters, LinkError};
use super::frame::SessionNumber;
use crate::between::fault::Fault;
use crate::between::motion::{AngleReading, Target};
use crate::between::stimulus::{Stimulus, StimulusError};
use crate::config::{CHANNELS, MUSCLES, TYPES};
use crate::hard_tick::safety::{NotArmed, State};
use crate::link::storage::NotStored;
use heapless::Vec;
use serde::{Deserialize, Serialize};
use vm_nostd::control::JointError;
use vm_nostd::{Limit, MuscleParams, ParameterError, RecruitmentCurveParams};

/// Most rows in a message.
pub const MOST_ROWS: usize = 8;
/// Most state words in a message.
pub const MOST_WORDS: usize = 24;

/// A request of the host. Each is answered by a [`Message::Answer`]; the next is sent after that.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
// A received request is taken apart at once.
#[allow(clippy::large_enum_variant)]
pub enum Request {
    /// Begins a session, from this sequence number on; not accepted while armed. Answer:
    /// [`Answer::Info`].
    Hello {
        /// The host's random number: the session number is made of this and of the device's.
        nonce: u32,
    },
    /// Keeps the host heard.
    KeepAlive,
    /// A muscle for a place: validated, stored, and put at rest. Refused while armed.
    Upload {
        /// 0 to [`MUSCLES`] - 1.
        place: u8,
        /// The muscle.
        upload: Upload,
    },
    /// Puts all muscles at rest on these path lengths (m); by default on
    /// `MuscleParams::middle_path`. Rows count from 0 again. Refused while armed.
    Rest([Option<f32>; MUSCLES]),
    /// Inputs of the next ticks, one row per tick; without a row the muscles wait. A row stimulates
    /// for [`Limits::rows_ms`](crate::Limits::rows_ms) at most. A fault or a stop while armed
    /// discards waiting rows.
    Rows {
        /// Number of the first.
        first: u32,
        /// Inputs of each tick.
        rows: Vec<[RowInputs; MUSCLES], MOST_ROWS>,
    },
    /// Stimuli of channels without an electrode, for
    /// [`Limits::drives_ms`](crate::Limits::drives_ms) at most: the host repeats them.
    Drive([Option<Stimulus>; CHANNELS]),
    /// Sensor readings. The path counts as missing when older than
    /// [`Limits::readings_ms`](crate::Limits::readings_ms).
    Readings(Readings),
    /// First step of arming: names the latched fault.
    Acknowledge(Fault),
    /// Second step of arming.
    Arm,
    /// Everything off; latches [`Fault::Stopped`] unless another fault is latched.
    Stop,
    /// Answer: [`Answer::Report`].
    Report,
    /// Answer: [`Answer::State`].
    State {
        /// 0 to [`MUSCLES`] - 1.
        place: u8,
    },
    /// A controller of the joint that both muscles move, or none: validated, stored, and at rest.
    /// Uploading a muscle later removes it. With a controller rows are refused. Refused while
    /// armed.
    Control(Option<ControlUpload>),
    /// What the controller is to do, for [`Limits::targets_ms`](crate::Limits::targets_ms) at most.
    /// It steps every tick while armed, and begins anew with the first target after arming. Refused
    /// beyond the joint's limits.
    Target(Target),
    /// A reading of the joint's angle, for [`Limits::angle_ms`](crate::Limits::angle_ms) at most.
    /// Answered at once, without a tick between.
    Angle(AngleReading),
    /// Steps the controller once by a target and a reading, without a prediction: to compare its
    /// bits. Nothing is stimulated; refused while armed. Answer: [`Answer::Stepped`].
    Step {
        /// The target.
        target: Target,
        /// The reading.
        reading: AngleReading,
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
    /// Recruitment.
    pub mode: Mode,
    /// Parameters.
    pub muscle: MuscleParams<TYPES>,
    /// Electrode, if rows stimulate as well (FES only).
    pub electrode: Option<Electrode>,
}

/// Electrode of a muscle: each row's activation and frequency become pulses of its channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Electrode {
    /// 0 to [`CHANNELS`] - 1.
    pub channel: u8,
    /// Recruitment by amplitude.
    pub curve: RecruitmentCurveParams,
    /// See [`Stimulus::width_us`].
    pub width_us: u16,
    /// See [`Stimulus::gap_us`].
    pub gap_us: u16,
    /// See [`Stimulus::recovery`].
    pub recovery: u8,
}

/// Inputs of a muscle in a tick; clipped to their ranges and flagged. For a muscle with an
/// electrode, an activation or a frequency that is not finite is [`Fault::Request`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RowInputs {
    /// Activation U (OpenSim, MuJoCo: excitation or control), 0..1.
    pub activation: f32,
    /// L_mt at the tick's end, m.
    pub path_length: f32,
    /// f_stim, pps.
    pub stimulation_frequency: f32,
}

/// Sensor readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Readings {
    /// Impedance of every channel, Ω; none if not measured yet.
    pub impedance_ohm: [Option<u32>; CHANNELS],
    /// Supply, mV.
    pub supply_mv: u32,
    /// Path length, µm; none without a valid reading.
    pub path_um: Option<i32>,
}

/// A message to the host.
// Built where it is sent, and taken apart where it arrives.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Message<'a> {
    /// Answer to a request.
    Answer {
        /// Sequence number of the request.
        to: u16,
        /// The answer.
        #[serde(borrow)]
        answer: Answer<'a>,
    },
    /// A frame was not acted upon.
    NotActedUpon(LinkError),
    /// Outputs of rows.
    Traces(Vec<Traced, MOST_ROWS>),
}

/// An answer to a request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer<'a> {
    /// Done.
    Done,
    /// Refused.
    Refused(#[serde(borrow)] Refusal<'a>),
    /// Answer to [`Request::Hello`].
    Info(Info),
    /// Answer to [`Request::Report`].
    Report(Report),
    /// Words of a muscle's state.
    State(Vec<u32, MOST_WORDS>),
    /// Answer to [`Request::Step`].
    Stepped(Commanded),
}

/// Why a request was refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal<'a> {
    /// A parameter of a muscle, recruitment curve, controller or target is out of range.
    Parameter {
        /// Place of the muscle, if a controller's muscle is refused.
        muscle: Option<u8>,
        /// See [`ParameterError::field`].
        field: &'a str,
        /// See [`ParameterError::fiber`].
        fiber: Option<u8>,
        /// See [`ParameterError::value`].
        value: f64,
        /// See [`ParameterError::limit`].
        limit: Limit,
    },
    /// A whole number is out of range.
    Number {
        /// Name of the field.
        field: &'a str,
        /// The refused value.
        value: u32,
        /// Least allowed value.
        least: u32,
        /// Greatest allowed value.
        most: u32,
    },
    /// Not allowed while armed.
    Armed,
    /// No muscle at that place.
    Empty,
    /// More rows than can wait.
    NoRoom {
        /// Free places.
        room: u32,
    },
    /// Memory did not keep what it was given. What was stored before still is, and the next boot
    /// restores it, unless the reason is [`NotStored::Unknown`].
    NotStored(NotStored),
    /// Supervision refused.
    NotArmed(NotArmed),
    /// Another muscle's electrode has the channel.
    ChannelTaken {
        /// The channel.
        channel: u8,
        /// Place of that muscle.
        place: u8,
    },
    /// A controller needs two muscles in FES with electrodes; that of this place is not so.
    NotControllable {
        /// 0 or 1.
        place: u8,
    },
    /// There is no controller.
    NoController,
    /// The controller has the electrodes: no rows.
    Controlled,
}

impl From<ParameterError> for Refusal<'static> {
    fn from(error: ParameterError) -> Self {
        let ParameterError { field, fiber, value, limit } = error;
        // There are few types.
        let fiber = fiber.map(|index| index as u8);
        Self::Parameter { muscle: None, field, fiber, value, limit }
    }
}

impl From<JointError> for Refusal<'static> {
    fn from(error: JointError) -> Self {
        let ParameterError { field, fiber, value, limit } = error.error;
        // There are few muscles and types.
        let [muscle, fiber] = [error.muscle, fiber].map(|index| index.map(|index| index as u8));
        Self::Parameter { muscle, field, fiber, value, limit }
    }
}

impl From<StimulusError> for Refusal<'static> {
    fn from(error: StimulusError) -> Self {
        let StimulusError { field, value, least, most } = error;
        Self::Number { field, value, least, most }
    }
}

/// Description of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Info {
    /// Places for muscles.
    pub muscles: u8,
    /// Fibre types of each.
    pub types: u8,
    /// Channels.
    pub channels: u8,
    /// Number of the session.
    pub session: SessionNumber,
    /// Tick time, µs.
    pub tick_us: u32,
    /// Muscles restored at boot.
    pub restored: u8,
    /// A controller is loaded.
    pub controlled: bool,
}

/// Status of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// State of supervision.
    pub state: State,
    /// Fault that is present now, if any.
    pub wrong: Option<Fault>,
    /// Ticks since boot.
    pub ticks: u32,
    /// Rows since the last rest.
    pub rows: u32,
    /// Longest time from a tick's due time to its end since boot, µs.
    pub longest_us: u32,
    /// Late ticks since boot.
    pub late: u32,
    /// Frames since boot.
    pub frames: Counters,
}

/// Outputs of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Traced {
    /// The row's number.
    pub row: u32,
    /// Outputs of each muscle; 0 without one.
    pub outputs: [RowOutputs; MUSCLES],
}

/// Outputs of a muscle in a tick, bit by bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RowOutputs {
    /// Force, N.
    pub force: f32,
    /// Fascicle length, L_ce0.
    pub fascicle_length: f32,
    /// Fascicle velocity, L_ce0/s.
    pub fascicle_velocity: f32,
    /// Status flags of the model.
    pub status: u16,
}
