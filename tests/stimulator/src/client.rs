//! The host's end of a line to a device in this process: no clock, and what is refused is named as
//! the device says.

use firmware::link::{
    Answer, Frame, Info, LinkError, Message, NO_SESSION, Receiver, Refusal, Request, SessionNumber,
    Traced, encode,
};
use std::collections::VecDeque;
use std::io::{Read, Write};

/// Why a request was not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClientError {
    /// It was understood, and refused.
    Refused {
        /// Field, value and limit.
        reason: String,
        /// A device that has no room for rows, which passes.
        no_room: bool,
    },
    /// It was not understood.
    NotActedUpon(LinkError),
    /// The answer is of another kind.
    OtherAnswer,
    /// Nothing came back.
    Silence,
}

/// Asks a device, one request at a time.
pub struct Client<L> {
    line: L,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    traces: VecDeque<Traced>,
}

enum Heard {
    Answer(u16, Result<Answer<'static>, ClientError>),
    NotActedUpon(LinkError),
    Nothing,
}

/// This host's nonce: constant, as in a recording.
pub const NONCE: u32 = 0x5EED_1E55;
/// How often a greeting is repeated.
const GREETINGS: usize = 10;

impl<L: Read + Write> Client<L> {
    /// On a line.
    pub fn new(line: L) -> Self {
        let traces = VecDeque::new();
        Self { line, receiver: Receiver::new(), session: NO_SESSION, sequence: 0, traces }
    }

    /// The line.
    pub fn line(&mut self) -> &mut L {
        &mut self.line
    }

    /// The line, without the client.
    pub fn into_line(self) -> L {
        self.line
    }

    /// Next received output of a row.
    pub fn next_trace(&mut self) -> Option<Traced> {
        self.traces.pop_front()
    }

    /// Reads until nothing comes or an answer has come.
    pub fn listen(&mut self) {
        self.hear();
    }

    /// Sends bytes that need not be a frame.
    pub fn send_raw(&mut self, bytes: &[u8]) {
        self.line.write_all(bytes).expect("a line");
    }

    /// The session, and the number of its next request.
    pub fn session(&self) -> (SessionNumber, u16) {
        (self.session, self.sequence)
    }

    /// Sends a request, and waits for its answer.
    pub fn ask(&mut self, request: &Request) -> Result<Answer<'static>, ClientError> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        let frame = encode(self.session, sequence, request).expect("fits into a frame");
        self.send_raw(&frame);
        loop {
            match self.hear() {
                Heard::Answer(to, answer) if to == sequence => return answer,
                Heard::Answer(..) => (),
                Heard::NotActedUpon(error) => return Err(ClientError::NotActedUpon(error)),
                Heard::Nothing => return Err(ClientError::Silence),
            }
        }
    }

    /// The same where there is nothing to be said but that it was done.
    pub fn order(&mut self, request: &Request) -> Result<(), ClientError> {
        match self.ask(request)? {
            Answer::Done => Ok(()),
            _ => Err(ClientError::OtherAnswer),
        }
    }

    /// Begins a session.
    pub fn greet(&mut self) -> Result<Info, ClientError> {
        for _ in 0..GREETINGS {
            let sequence = self.sequence;
            self.sequence = sequence.wrapping_add(1);
            // A zero ends a partial frame on the line.
            self.send_raw(&[0]);
            self.send_raw(
                &encode(NO_SESSION, sequence, &Request::Hello { nonce: NONCE }).expect("a frame"),
            );
            loop {
                match self.hear() {
                    Heard::Answer(to, Ok(Answer::Info(info))) if to == sequence => {
                        self.session = info.session;
                        return Ok(info);
                    }
                    Heard::Nothing => break,
                    _ => (),
                }
            }
        }
        Err(ClientError::Silence)
    }

    /// The next message that is no trace, or nothing where nothing comes any more.
    fn hear(&mut self) -> Heard {
        let mut byte = [0];
        while self.line.read(&mut byte).is_ok() {
            let Some(Ok(Frame { content, .. })) = self.receiver.push(byte[0], NO_SESSION) else {
                continue;
            };
            match postcard::from_bytes::<Message<'_>>(content).expect("a message") {
                Message::Answer { to, answer } => return Heard::Answer(to, owned(answer)),
                Message::NotActedUpon(error) => return Heard::NotActedUpon(error),
                Message::Traces(traces) => self.traces.extend(traces),
            }
        }
        Heard::Nothing
    }
}

fn owned(answer: Answer<'_>) -> Result<Answer<'static>, ClientError> {
    Ok(match answer {
        Answer::Done => Answer::Done,
        Answer::Info(info) => Answer::Info(info),
        Answer::Report(report) => Answer::Report(report),
        Answer::State(words) => Answer::State(words),
        Answer::Stepped(command) => Answer::Stepped(command),
        Answer::Refused(refusal) => {
            let no_room = matches!(refusal, Refusal::NoRoom { .. });
            return Err(ClientError::Refused { reason: reason(&refusal), no_room });
        }
    })
}

/// Field, value and limit of a number; otherwise the name.
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
        Refusal::NotArmed(reason) => format!("{reason:?}"),
        other => format!("{other:?}"),
    }
}
