//! Sessions: frames are acted upon once and in order.

use super::error::{Counters, LinkError};
use super::frame::{Frame, NO_SESSION, SessionNumber};
use super::message::Request;

/// The receiving end of a link.
#[derive(Clone, Debug, Default)]
pub struct Session {
    /// Number of the session, after a greeting.
    number: SessionNumber,
    /// Expected sequence number.
    due: u16,
    counters: Counters,
}

impl Session {
    /// No session yet.
    pub const fn new() -> Self {
        let counters = Counters { accepted: 0, broken: 0, refused: 0 };
        Self { number: NO_SESSION, due: 0, counters }
    }

    /// Number of the session; [`NO_SESSION`] before there is one.
    pub fn number(&self) -> SessionNumber {
        self.number
    }

    /// Counts of frames.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// The request in a frame of a [`Receiver`](crate::link::Receiver), if it is to be acted upon.
    ///
    /// A greeting begins a session with any sequence number, of the number that `begin` makes of
    /// the host's nonce. Nothing else is acted upon that does not belong to a session.
    pub fn admit(
        &mut self,
        received: Result<Frame<'_>, LinkError>,
        begin: impl FnOnce(u32) -> Result<SessionNumber, LinkError>,
    ) -> Result<Request, LinkError> {
        let admitted = received.and_then(|frame| self.request(&frame, begin));
        let Counters { accepted, broken, refused } = &mut self.counters;
        let counter = match admitted {
            Ok(_) => accepted,
            Err(
                LinkError::TooLong
                | LinkError::TooShort
                | LinkError::Malformed
                | LinkError::Checksum,
            ) => broken,
            Err(_) => refused,
        };
        *counter = counter.saturating_add(1);
        admitted
    }

    fn request(
        &mut self,
        frame: &Frame<'_>,
        begin: impl FnOnce(u32) -> Result<SessionNumber, LinkError>,
    ) -> Result<Request, LinkError> {
        let parsed = match postcard::take_from_bytes::<Request>(frame.content) {
            Ok((request, [])) => Ok(request),
            _ => Err(LinkError::NotAMessage),
        };
        let (got, due) = (frame.sequence, self.due);
        if frame.session == NO_SESSION {
            let Ok(Request::Hello { nonce }) = parsed else { return Err(LinkError::NoSession) };
            self.number = begin(nonce)?;
        } else if got != due {
            // Half of all numbers are behind, the other half ahead.
            let is_behind = got.wrapping_sub(due) >= 0x8000;
            return Err(if is_behind {
                LinkError::Replayed { sequence: got }
            } else {
                LinkError::OutOfOrder { got, due }
            });
        }
        let request = parsed?;
        self.due = got.wrapping_add(1);
        Ok(request)
    }
}
