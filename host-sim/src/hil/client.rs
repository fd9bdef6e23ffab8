//! Client of the link: the host's end.

use firmware::NotStored;
use firmware::flash::MOST_STORE_MS;
use firmware::link::{
    Answer, Frame, Info, LinkError, Message, NO_SESSION, Receiver, Refusal, Request, SessionNumber,
    Traced, encode,
};
use firmware::watchdog::DISARMED;
use std::collections::VecDeque;
use std::hash::{BuildHasher, RandomState};
use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// A byte stream with a read timeout (`TimedOut` or `WouldBlock`).
pub trait Line: Read + Write {}
impl<L: Read + Write + ?Sized> Line for L {}

/// Why hardware in the loop failed.
#[derive(Debug, thiserror::Error)]
pub enum HilError {
    /// The port could not be opened.
    #[error("--port {port}: {message}")]
    Port {
        /// Name of the port.
        port: String,
        /// The system's error.
        message: String,
    },
    /// The firmware could not be built or emulated.
    #[error(transparent)]
    Target(#[from] crate::target::TargetError),
    /// The line failed.
    #[error("serial line: {0}")]
    Line(#[from] std::io::Error),
    /// No answer.
    #[error("no answer to {request} within {TIMEOUT:?}")]
    Silence {
        /// The request.
        request: &'static str,
    },
    /// The device refused the request.
    #[error("the device refuses {request}: {reason}")]
    Refused {
        /// The request.
        request: &'static str,
        /// Field, value and limit.
        reason: String,
        /// The device has no room for rows at the moment.
        no_room: bool,
    },
    /// Host and device use different versions of the protocol.
    #[error(
        "the device has version {device} of the link's protocol, this program version {host}: \
         flash the firmware of this program's version"
    )]
    OtherVersion {
        /// The device's version.
        device: u8,
        /// This program's version.
        host: u8,
    },
    /// The device ignored the frame.
    #[error("the device ignored {request}: {}", why(*error))]
    NotActedUpon {
        /// The request.
        request: &'static str,
        /// Why.
        error: LinkError,
    },
    /// The answer is of another kind.
    #[error("answer of an unexpected kind to {request}")]
    OtherAnswer {
        /// The request.
        request: &'static str,
    },
    /// The device does not support this muscle or these inputs.
    #[error("{what} = {value}: {limit}")]
    Unfit {
        /// Quantity.
        what: &'static str,
        /// Its value.
        value: String,
        /// Its limit.
        limit: String,
    },
    /// The host's own controller was refused.
    #[error(transparent)]
    Joint(#[from] vm_nostd::control::JointError),
    /// The host's own run failed.
    #[error(transparent)]
    Run(#[from] crate::engine::RunError),
    /// The device's bits differ from the host's.
    #[error("{0}")]
    Differs(String),
}

/// Longest wait for an answer.
const TIMEOUT: Duration = Duration::from_secs(20);
/// A request is repeated after this time without an answer: longer than the device takes to store
/// a muscle.
const AGAIN: Duration = Duration::from_millis(MOST_STORE_MS as u64 + 1_000);
// If flash hangs, the watchdog restarts the device, which then reports that it has no session.
const _: () = assert!(TIMEOUT.as_millis() > DISARMED.most_ms() as u128 + AGAIN.as_millis());

/// Repetition time of the greeting.
const GREET_AGAIN: Duration = Duration::from_millis(300);

/// Sends requests to a device, one at a time.
pub struct Client<L> {
    line: L,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    /// Traces received between answers.
    traces: VecDeque<Traced>,
}

/// A received message, owned.
enum Heard {
    Answer(u16, Result<Answer<'static>, (String, bool)>),
    NotActedUpon(LinkError),
    Nothing,
}

impl<L: Line> Client<L> {
    /// A client on a line, without a session.
    pub fn new(line: L) -> Self {
        Self {
            line,
            receiver: Receiver::new(),
            session: NO_SESSION,
            sequence: 0,
            traces: VecDeque::new(),
        }
    }

    /// The line.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }

    /// Returns the line.
    pub fn into_line(self) -> L {
        self.line
    }

    /// Next received output of a row.
    pub fn next_trace(&mut self) -> Option<Traced> {
        self.traces.pop_front()
    }

    /// Reads until the line times out.
    pub fn listen(&mut self) -> Result<(), HilError> {
        self.hear().map(|_| ())
    }

    /// Sends bytes as they are, framed or not.
    pub fn send_raw(&mut self, bytes: &[u8]) -> Result<(), HilError> {
        self.line.write_all(bytes)?;
        Ok(self.line.flush()?)
    }

    /// Session and sequence number of the next request.
    pub fn session(&self) -> (SessionNumber, u16) {
        (self.session, self.sequence)
    }

    /// Sends a request, repeats it if it was damaged, and waits for the answer.
    pub fn ask(&mut self, request: &Request) -> Result<Answer<'static>, HilError> {
        let name = name(request);
        let sequence = self.sequence;
        let Some(frame) = encode(self.session, sequence, request) else {
            let limit = "must fit into a frame".to_owned();
            return Err(HilError::Unfit { what: "request", value: name.to_owned(), limit });
        };
        self.sequence = sequence.wrapping_add(1);
        self.send_raw(&frame)?;
        let (started, mut sent) = (Instant::now(), Instant::now());
        while started.elapsed() < TIMEOUT {
            match self.hear()? {
                Heard::Answer(to, answer) if to == sequence => {
                    return answer.map_err(|(reason, no_room)| HilError::Refused {
                        request: name,
                        reason,
                        no_room,
                    });
                }
                // Answer to the first copy of a repeated request.
                Heard::Answer(..) => (),
                Heard::NotActedUpon(LinkError::Replayed { sequence: old }) if old != sequence => (),
                Heard::NotActedUpon(
                    LinkError::Checksum
                    | LinkError::Malformed
                    | LinkError::TooLong
                    | LinkError::TooShort,
                ) => {
                    self.send_raw(&frame)?;
                    sent = Instant::now();
                }
                Heard::NotActedUpon(error) => return Err(not_acted_upon(name, error)),
                Heard::Nothing if sent.elapsed() > AGAIN => {
                    self.send_raw(&frame)?;
                    sent = Instant::now();
                }
                Heard::Nothing => (),
            }
        }
        Err(HilError::Silence { request: name })
    }

    /// Begins a session. The greeting is repeated, since a booting device does not hear it.
    pub fn greet(&mut self) -> Result<Info, HilError> {
        // `RandomState` is seeded from the system's random numbers.
        let nonce = RandomState::new().hash_one(self.sequence) as u32;
        let started = Instant::now();
        let mut sent: Option<Instant> = None;
        let mut refused = None;
        while started.elapsed() < TIMEOUT {
            if sent.is_none_or(|sent| sent.elapsed() > GREET_AGAIN) {
                let sequence = self.sequence;
                self.sequence = sequence.wrapping_add(1);
                // A zero ends a partial frame on the line.
                self.send_raw(&[0])?;
                let hello = encode(NO_SESSION, sequence, &Request::Hello { nonce });
                self.send_raw(&hello.unwrap_or_default())?;
                sent = Some(Instant::now());
            }
            match self.hear()? {
                // A later greeting ends the session of an earlier one.
                Heard::Answer(to, Ok(Answer::Info(info)))
                    if to.wrapping_add(1) == self.sequence =>
                {
                    self.session = info.session;
                    return Ok(info);
                }
                Heard::NotActedUpon(error @ LinkError::Version { .. }) => {
                    return Err(not_acted_upon("hello", error));
                }
                // Transient: a damaged partial frame, or a device that is still armed.
                Heard::NotActedUpon(error) => refused = Some(error),
                Heard::Answer(..) | Heard::Nothing => (),
            }
        }
        Err(refused
            .map_or(HilError::Silence { request: "hello" }, |error| not_acted_upon("hello", error)))
    }

    /// Sends a request whose answer is `Done`.
    pub fn order(&mut self, request: &Request) -> Result<(), HilError> {
        match self.ask(request)? {
            Answer::Done => Ok(()),
            _ => Err(HilError::OtherAnswer { request: name(request) }),
        }
    }

    /// Next message other than traces, or nothing on a timeout.
    fn hear(&mut self) -> Result<Heard, HilError> {
        let mut byte = [0];
        loop {
            match self.line.read(&mut byte) {
                Ok(0) => return Err(std::io::Error::from(ErrorKind::UnexpectedEof).into()),
                Ok(_) => (),
                Err(error)
                    if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) =>
                {
                    return Ok(Heard::Nothing);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(error.into()),
            }
            let content = match self.receiver.push(byte[0], NO_SESSION) {
                Some(Ok(Frame { content, .. })) => content,
                // Messages of another version cannot be parsed.
                Some(Err(LinkError::Version { got, known })) => {
                    return Err(HilError::OtherVersion { device: got, host: known });
                }
                // A damaged frame: the request is repeated after a timeout.
                Some(Err(_)) | None => continue,
            };
            match postcard::from_bytes::<Message<'_>>(content) {
                Ok(Message::Answer { to, answer }) => return Ok(Heard::Answer(to, owned(answer))),
                Ok(Message::NotActedUpon(error)) => return Ok(Heard::NotActedUpon(error)),
                Ok(Message::Traces(traces)) => self.traces.extend(traces),
                Err(_) => (),
            }
        }
    }
}

fn not_acted_upon(request: &'static str, error: LinkError) -> HilError {
    match error {
        LinkError::Version { got, known } => HilError::OtherVersion { device: known, host: got },
        error => HilError::NotActedUpon { request, error },
    }
}

fn why(error: LinkError) -> String {
    match error {
        LinkError::TooLong => "longer than the longest frame".to_owned(),
        LinkError::TooShort => "shorter than the shortest frame".to_owned(),
        LinkError::Malformed => "not a frame".to_owned(),
        LinkError::Checksum => "wrong checksum".to_owned(),
        LinkError::Version { got, known } => format!("version {got}, the device has {known}"),
        LinkError::NoSession => "no session; none begins while stimulation is armed".to_owned(),
        LinkError::Replayed { sequence } => {
            format!("sequence number {sequence} was acted upon before")
        }
        LinkError::OutOfOrder { got, due } => format!("sequence number {got}, expected {due}"),
        LinkError::NotAMessage => "not a message".to_owned(),
        LinkError::NoRandomNumber => "the device's random number generator failed".to_owned(),
    }
}

fn owned(answer: Answer<'_>) -> Result<Answer<'static>, (String, bool)> {
    Ok(match answer {
        Answer::Done => Answer::Done,
        Answer::Info(info) => Answer::Info(info),
        Answer::Report(report) => Answer::Report(report),
        Answer::State(words) => Answer::State(words),
        Answer::Stepped(command) => Answer::Stepped(command),
        Answer::Refused(refusal) => {
            return Err((reason(&refusal), matches!(refusal, Refusal::NoRoom { .. })));
        }
    })
}

fn reason(refusal: &Refusal<'_>) -> String {
    match refusal {
        Refusal::Parameter { muscle, field, fiber, value, limit } => {
            let muscle = muscle.map_or_else(String::new, |index| format!("muscles[{index}]."));
            let fiber = fiber.map_or_else(String::new, |index| format!("fibers[{index}]."));
            format!("{muscle}{fiber}{field} = {value}: {limit}")
        }
        Refusal::Number { field, value, least, most } => {
            format!("{field} = {value}: must be {least} to {most}")
        }
        Refusal::Armed => "stimulation is armed".to_owned(),
        Refusal::Empty => "no muscle in this slot".to_owned(),
        Refusal::NoRoom { room } => format!("room for {room} rows"),
        Refusal::NotStored(NotStored::Unknown) => {
            "flash failed twice: the next boot restores these muscles or those stored before"
                .to_owned()
        }
        Refusal::NotStored(reason) => {
            let reason = match reason {
                NotStored::TooLong => "too long",
                NotStored::Read => "read failed",
                NotStored::Erase => "erase failed",
                NotStored::Write => "write failed",
                NotStored::Kept | NotStored::Unknown => "verification failed",
            };
            format!("flash: {reason}; the muscles stored before are kept")
        }
        Refusal::NotArmed(reason) => format!("{reason:?}"),
        Refusal::ChannelTaken { channel, place } => {
            format!("channel {channel} belongs to the electrode of muscle {place}")
        }
        Refusal::NotControllable { place } => {
            format!("a controller needs a muscle in FES with an electrode in slot {place}")
        }
        Refusal::NoController => "no controller".to_owned(),
        Refusal::Controlled => "the controller has the electrodes".to_owned(),
    }
}

fn name(request: &Request) -> &'static str {
    match request {
        Request::Hello { .. } => "hello",
        Request::KeepAlive => "keep alive",
        Request::Upload { .. } => "the upload of a muscle",
        Request::Rest(_) => "rest",
        Request::Rows { .. } => "rows",
        Request::Drive(_) => "drive",
        Request::Readings(_) => "readings",
        Request::Acknowledge(_) => "acknowledge",
        Request::Arm => "arm",
        Request::Stop => "stop",
        Request::Report => "report",
        Request::State { .. } => "state",
        Request::Control(_) => "the upload of a controller",
        Request::Target(_) => "target",
        Request::Angle(_) => "angle",
        Request::Step { .. } => "step",
    }
}
