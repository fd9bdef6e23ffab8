//! The host's end of the link.

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

/// A line that carries bytes; where none come for a while, reading says so (`TimedOut` or `WouldBlock`).
pub trait Line: Read + Write {}
impl<L: Read + Write + ?Sized> Line for L {}

/// Why the loop is not closed.
#[derive(Debug, thiserror::Error)]
pub enum HilError {
    /// The port could not be opened.
    #[error("--port {port}: {message}")]
    Port {
        /// Its name.
        port: String,
        /// What the system said.
        message: String,
    },
    /// Nothing is built or emulated.
    #[error(transparent)]
    Target(#[from] crate::target::TargetError),
    /// The line broke.
    #[error("the line to the device: {0}")]
    Line(#[from] std::io::Error),
    /// Nobody answers.
    #[error("the device does not answer to {request} within {PATIENCE:?}")]
    Silence {
        /// What was asked.
        request: &'static str,
    },
    /// It was understood, and refused.
    #[error("the device refuses {request}: {reason}")]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Field, value and limit.
        reason: String,
        /// A device that has no room for rows, which passes.
        no_room: bool,
    },
    /// Host and device were not made for each other.
    #[error(
        "the device speaks version {device} of the link's protocol, this program version {host}: \
         flash the firmware that belongs to this program"
    )]
    OtherVersion {
        /// The device's version.
        device: u8,
        /// The one of this program.
        host: u8,
    },
    /// It was not understood.
    #[error("the device does not act upon {request}: {}", why(*error))]
    NotActedUpon {
        /// What was asked.
        request: &'static str,
        /// Why.
        error: LinkError,
    },
    /// What came back answers something else.
    #[error("the device's answer to {request} is of another kind")]
    OtherAnswer {
        /// What was asked.
        request: &'static str,
    },
    /// The device is not one for this muscle or these inputs.
    #[error("{what} = {value}: {limit}")]
    Unfit {
        /// Of what.
        what: &'static str,
        /// Which value.
        value: String,
        /// What it must be.
        limit: String,
    },
    /// The host could not run the muscle itself.
    #[error(transparent)]
    Run(#[from] crate::engine::RunError),
    /// The device computes something else.
    #[error("{0}")]
    Differs(String),
}

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(20);
/// After so long without any byte, a request is sent again: not while the device may still be storing a muscle.
const AGAIN: Duration = Duration::from_millis(MOST_STORE_MS as u64 + 1_000);
// A device whose flash never ends is started again by its watchdog, and then says that it knows no session.
const _: () = assert!(PATIENCE.as_millis() > DISARMED.most_ms() as u128 + AGAIN.as_millis());

/// The same for a greeting.
const GREET_AGAIN: Duration = Duration::from_millis(300);

/// Asks a device, one request at a time.
pub struct Client<L> {
    line: L,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    /// What came between answers.
    traces: VecDeque<Traced>,
}

/// What a device said, with nothing borrowed.
enum Heard {
    Answer(u16, Result<Answer<'static>, (String, bool)>),
    NotActedUpon(LinkError),
    Nothing,
}

impl<L: Line> Client<L> {
    /// On a line.
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

    /// The line, without the client.
    pub fn into_line(self) -> L {
        self.line
    }

    /// What rows have led to, if that has come.
    pub fn next_trace(&mut self) -> Option<Traced> {
        self.traces.pop_front()
    }

    /// Reads what comes within a moment.
    pub fn listen(&mut self) -> Result<(), HilError> {
        self.hear().map(|_| ())
    }

    /// Sends bytes that need not be a frame.
    pub fn send_raw(&mut self, bytes: &[u8]) -> Result<(), HilError> {
        self.line.write_all(bytes)?;
        Ok(self.line.flush()?)
    }

    /// The session, and the number of its next request.
    pub fn session(&self) -> (SessionNumber, u16) {
        (self.session, self.sequence)
    }

    /// Sends a request, again if it was broken on its way, and waits for its answer.
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
        while started.elapsed() < PATIENCE {
            match self.hear()? {
                Heard::Answer(to, answer) if to == sequence => {
                    return answer.map_err(|(reason, no_room)| HilError::Refused {
                        request: name,
                        reason,
                        no_room,
                    });
                }
                // To a request that was sent twice.
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

    /// Begins a session: greets until there is an answer, for a device that is booting hears nothing.
    pub fn greet(&mut self) -> Result<Info, HilError> {
        // A map's hash is keyed by the system's random numbers.
        let nonce = RandomState::new().hash_one(self.sequence) as u32;
        let started = Instant::now();
        let mut sent: Option<Instant> = None;
        let mut refused = None;
        while started.elapsed() < PATIENCE {
            if sent.is_none_or(|sent| sent.elapsed() > GREET_AGAIN) {
                let sequence = self.sequence;
                self.sequence = sequence.wrapping_add(1);
                // A zero ends what may have been left on the line.
                self.send_raw(&[0])?;
                let hello = encode(NO_SESSION, sequence, &Request::Hello { nonce });
                self.send_raw(&hello.unwrap_or_default())?;
                sent = Some(Instant::now());
            }
            match self.hear()? {
                // An answer to an earlier greeting would begin a session that a later one ends.
                Heard::Answer(to, Ok(Answer::Info(info)))
                    if to.wrapping_add(1) == self.sequence =>
                {
                    self.session = info.session;
                    return Ok(info);
                }
                Heard::NotActedUpon(error @ LinkError::Version { .. }) => {
                    return Err(not_acted_upon("hello", error));
                }
                // May pass: what was left on the line is broken, and what is armed will not be for ever.
                Heard::NotActedUpon(error) => refused = Some(error),
                Heard::Answer(..) | Heard::Nothing => (),
            }
        }
        Err(refused
            .map_or(HilError::Silence { request: "hello" }, |error| not_acted_upon("hello", error)))
    }

    /// The same where there is nothing to be said but that it was done.
    pub fn order(&mut self, request: &Request) -> Result<(), HilError> {
        match self.ask(request)? {
            Answer::Done => Ok(()),
            _ => Err(HilError::OtherAnswer { request: name(request) }),
        }
    }

    /// The next message that is no trace, or nothing where nothing comes for a moment.
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
                // Its messages cannot be read, whatever they are.
                Some(Err(LinkError::Version { got, known })) => {
                    return Err(HilError::OtherVersion { device: got, host: known });
                }
                // What is broken on its way here is asked for again after a while.
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
        LinkError::TooLong => "longer than any frame".to_owned(),
        LinkError::TooShort => "shorter than any frame".to_owned(),
        LinkError::Malformed => "not a frame".to_owned(),
        LinkError::Checksum => "its checksum is another one".to_owned(),
        LinkError::Version { got, known } => format!("of version {got}, not {known}"),
        LinkError::NoSession => {
            "it belongs to no session; none begins while stimulation is armed".to_owned()
        }
        LinkError::Replayed { sequence } => format!("number {sequence} was acted upon before"),
        LinkError::OutOfOrder { got, due } => format!("number {got} came where {due} was due"),
        LinkError::NotAMessage => "it is no message".to_owned(),
        LinkError::NoRandomNumber => "its random number generator gives none".to_owned(),
    }
}

fn owned(answer: Answer<'_>) -> Result<Answer<'static>, (String, bool)> {
    Ok(match answer {
        Answer::Done => Answer::Done,
        Answer::Info(info) => Answer::Info(info),
        Answer::Report(report) => Answer::Report(report),
        Answer::State(words) => Answer::State(words),
        Answer::Refused(refusal) => {
            return Err((reason(&refusal), matches!(refusal, Refusal::NoRoom { .. })));
        }
    })
}

fn reason(refusal: &Refusal<'_>) -> String {
    match refusal {
        Refusal::Parameter { field, fiber, value, limit } => {
            let fiber = fiber.map_or_else(String::new, |index| format!("fibers[{index}]."));
            format!("{fiber}{field} = {value}: {limit}")
        }
        Refusal::Number { field, value, least, most } => {
            format!("{field} = {value}: must be {least} to {most}")
        }
        Refusal::Armed => "stimulation is armed".to_owned(),
        Refusal::Empty => "no muscle is at that place".to_owned(),
        Refusal::NoRoom { room } => format!("room for {room} rows"),
        Refusal::NotStored(NotStored::Unknown) => {
            "memory failed twice; the next boot restores this or what was stored before".to_owned()
        }
        Refusal::NotStored(reason) => {
            let reason = match reason {
                NotStored::TooLong => "it has no room for it",
                NotStored::Read => "it could not be read",
                NotStored::Erase => "it was not erased",
                NotStored::Write => "it was not written",
                NotStored::Kept | NotStored::Unknown => "it did not keep it",
            };
            format!("memory: {reason}; what was stored before still is")
        }
        Refusal::NotArmed(reason) => format!("{reason:?}"),
        Refusal::ChannelTaken { channel, place } => {
            format!("channel {channel} is that of the electrode of muscle {place}")
        }
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
    }
}
