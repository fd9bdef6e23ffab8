//! The device's end of the link, at the lowest priority.

use crate::between::guarded::Guarded;
use crate::between::link_queues::{Bank, LinkEnds, Order, Outcome, Row, Stimuli};
use crate::between::motion::{AngleReading, Target};
use crate::between::permission::Permission;
use crate::between::stimulus::within;
use crate::config::{CHANNELS, MUSCLES, TYPES};
use crate::link::randomness::Randomness;
use crate::link::storage::SlotBuffer;
use crate::link::uploads::{Stored, Uploads};
use crate::link::{
    Answer, ControlUpload, Info, LinkError, MOST_FRAME, Message, NO_SESSION, Receiver, Refusal,
    Request, Session, SessionNumber, Upload, encode,
};
use embedded_storage::nor_flash::MultiwriteNorFlash;
use heapless::{Deque, Vec};
use vm_nostd::TimeStep;

/// Recipient of an order's outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Waiting {
    /// No order is pending.
    No,
    /// The order at boot, without a request.
    Boot,
    /// The request of a sequence number.
    Request(u16),
}

/// Memory of a [`Server`]: large, built in place.
pub struct ServerRoom {
    receiver: Receiver,
    stored: SlotBuffer,
    uploads: Stored,
    built: Bank,
    out: Out,
}

/// Bytes for the host: at most an answer and a message of traces.
type Out = Deque<u8, { 2 * MOST_FRAME }>;

impl Default for ServerRoom {
    fn default() -> Self {
        Self::new()
    }
}

impl ServerRoom {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            receiver: Receiver::new(),
            stored: [0; _],
            uploads: Stored::NOTHING,
            built: Bank::new(),
            out: Deque::new(),
        }
    }
}

/// Receives and sends bytes and gives orders to the tick.
pub struct Server<'q, F, R> {
    receiver: &'q mut Receiver,
    session: Session,
    ends: LinkEnds<'q>,
    permission: &'q Permission,
    uploads: Uploads<'q, F>,
    step: TimeStep,
    waiting: Waiting,
    /// Number of the next row.
    row: u32,
    sequence: u16,
    /// Polls since boot, for randomness without a generator.
    polls: u32,
    randomness: R,
    out: &'q mut Out,
}

impl<'q, F: MultiwriteNorFlash, R: Randomness> Server<'q, F, R> {
    /// Restores the stored muscles and gives them to the tick.
    pub fn new(
        room: &'q mut ServerRoom,
        ends: LinkEnds<'q>,
        permission: &'q Permission,
        memory: F,
        randomness: R,
        step: TimeStep,
    ) -> Self {
        let ServerRoom { receiver, stored, uploads, built, out } = room;
        let mut server = Self {
            receiver,
            session: Session::new(),
            ends,
            permission,
            uploads: Uploads::restore(memory, stored, uploads, built, step),
            step,
            waiting: Waiting::Boot,
            row: 0,
            sequence: 0,
            polls: 0,
            randomness,
            out,
        };
        if let Some(bank) = server.ends.spare.take() {
            *bank = *server.uploads.built();
            server.give(Order::Rest(bank));
        }
        server
    }

    /// Returns the memory.
    pub fn into_memory(self) -> F {
        self.uploads.into_memory()
    }

    /// Whether current may flow.
    pub fn is_armed(&self) -> bool {
        self.permission.is_open()
    }

    /// Whether it can take a byte: not before the last request is answered.
    pub fn is_ready(&self) -> bool {
        self.waiting == Waiting::No && self.has_room()
    }

    /// Takes a byte from the line.
    pub fn receive(&mut self, byte: u8) {
        let (armed, session) = (self.is_armed(), self.session.number());
        let Some(received) = self.receiver.push(byte, session) else { return };
        let sequence = received.map_or(0, |frame| frame.sequence);
        let begin = |nonce| {
            if armed {
                return Err(LinkError::NoSession);
            }
            let number = self.randomness.number(self.polls).ok_or(LinkError::NoRandomNumber)?;
            Ok(session_number(number, nonce, session))
        };
        match self.session.admit(received, begin) {
            Err(error) => self.refuse_frame(error),
            Ok(request) => {
                self.permission.set_heard();
                if let Some(answer) = self.act(sequence, request).transpose() {
                    self.answer(sequence, &answer.unwrap_or_else(Answer::Refused));
                }
            }
        }
    }

    /// Bytes were lost or damaged on the line.
    pub fn lost(&mut self) {
        self.receiver.lost();
    }

    /// Polls the tick.
    pub fn poll(&mut self) {
        self.polls = self.polls.wrapping_add(1);
        if let Some(outcome) = self.ends.outcomes.dequeue() {
            let answer = self.of_outcome(outcome);
            if let Waiting::Request(to) = self.waiting {
                self.answer(to, &answer);
            }
            self.waiting = Waiting::No;
        }
        if self.has_room() && self.ends.traces.ready() {
            let mut traces = Vec::new();
            while !traces.is_full()
                && let Some(traced) = self.ends.traces.dequeue()
            {
                let _there_is_room = traces.push(traced);
            }
            self.send(&Message::Traces(traces));
        }
    }

    /// The next byte for the line.
    pub fn transmit(&mut self) -> Option<u8> {
        self.out.pop_front()
    }

    /// Whether nothing is pending.
    pub fn is_idle(&self) -> bool {
        self.out.is_empty() && self.waiting == Waiting::No && !self.ends.traces.ready()
    }

    /// Sends a message.
    fn has_room(&self) -> bool {
        self.out.capacity() - self.out.len() >= MOST_FRAME
    }

    /// Executes a request; returns the answer, or none if the tick gives it.
    fn act(
        &mut self,
        sequence: u16,
        request: Request,
    ) -> Result<Option<Answer<'static>>, Refusal<'static>> {
        let order = match request {
            Request::Hello { .. } => return Ok(Some(Answer::Info(self.info()))),
            Request::Upload { place, upload } => self.upload(place, upload)?,
            Request::Rest(paths) => self.rest(&paths)?,
            Request::Rows { first, rows } => {
                self.rows(first, &rows)?;
                return Ok(Some(Answer::Done));
            }
            Request::KeepAlive => return Ok(Some(Answer::Done)),
            Request::Drive(stimuli) => self.drive(stimuli)?,
            Request::Readings(readings) => Order::Readings(readings),
            Request::Acknowledge(fault) => Order::Acknowledge(fault),
            Request::Arm => Order::Arm,
            Request::Stop => Order::Stop,
            Request::Report => Order::Report,
            Request::State { place } => {
                check_place(place)?;
                Order::Words(place.into())
            }
            Request::Control(control) => self.control(control)?,
            Request::Target(target) => {
                self.uploads.check_target(&target)?;
                Order::Target(Guarded::new(target))
            }
            Request::Angle(reading) => {
                self.angle(reading)?;
                return Ok(Some(Answer::Done));
            }
            Request::Step { target, reading } => self.step_once(target, reading)?,
        };
        self.give(order);
        self.waiting = Waiting::Request(sequence);
        Ok(None)
    }

    /// Gives an order; there is room, since the last outcome was taken.
    fn give(&mut self, order: Order) {
        if let Err(Order::Load(_, bank) | Order::Control(bank) | Order::Rest(bank)) =
            self.ends.orders.enqueue(order)
        {
            self.ends.spare = Some(bank);
        }
    }

    // Not inlined, like others below: their frames would add up.
    #[inline(never)]
    fn upload(&mut self, place: u8, upload: Upload) -> Result<Order, Refusal<'static>> {
        self.only_disarmed()?;
        check_place(place)?;
        self.only_with_spare()?;
        let index = usize::from(place);
        self.uploads.take(index, upload)?;
        Ok(Order::Load(index, self.spare()?))
    }

    #[inline(never)]
    fn control(&mut self, control: Option<ControlUpload>) -> Result<Order, Refusal<'static>> {
        self.only_disarmed()?;
        self.only_with_spare()?;
        self.uploads.take_control(control)?;
        Ok(Order::Control(self.spare()?))
    }

    /// A reading for the tick, if it takes them.
    fn angle(&mut self, reading: AngleReading) -> Result<(), Refusal<'static>> {
        if !self.uploads.is_controlled() {
            return Err(Refusal::NoController);
        }
        let given = self.ends.angles.enqueue(Guarded::new(reading));
        given.map_err(|_| Refusal::NoRoom { room: 0 })
    }

    fn step_once(
        &mut self,
        target: Target,
        reading: AngleReading,
    ) -> Result<Order, Refusal<'static>> {
        self.only_disarmed()?;
        self.uploads.check_target(&target)?;
        Ok(Order::Step(target, reading))
    }

    /// The spare bank, filled with all muscles at rest.
    fn spare(&mut self) -> Result<&'static mut Bank, Refusal<'static>> {
        let bank = self.ends.spare.take().ok_or(Refusal::NoRoom { room: 0 })?;
        *bank = *self.uploads.built();
        Ok(bank)
    }

    /// The spare bank, which the last outcome returned.
    fn only_with_spare(&self) -> Result<(), Refusal<'static>> {
        if self.ends.spare.is_some() { Ok(()) } else { Err(Refusal::NoRoom { room: 0 }) }
    }

    /// Drives are for channels without an electrode.
    fn drive(&mut self, stimuli: Stimuli) -> Result<Order, Refusal<'static>> {
        for (channel, stimulus) in (0..).zip(&stimuli) {
            if stimulus.is_some() {
                self.uploads.only_free(channel, None)?;
            }
        }
        Ok(Order::Drive(Guarded::new(stimuli)))
    }

    #[inline(never)]
    fn rest(&mut self, paths: &[Option<f32>; MUSCLES]) -> Result<Order, Refusal<'static>> {
        self.only_disarmed()?;
        let bank = self.spare()?;
        for (driven, path) in bank.muscles.iter_mut().zip(paths) {
            if let (Some(driven), Some(path)) = (driven, path)
                && let Err(refusal) = driven.rest(*path)
            {
                self.ends.spare = Some(bank);
                return Err(refusal);
            }
        }
        self.row = 0;
        Ok(Order::Rest(bank))
    }

    fn rows(&mut self, first: u32, rows: &[Row]) -> Result<(), Refusal<'static>> {
        if self.uploads.is_controlled() {
            return Err(Refusal::Controlled);
        }
        within("first", first, self.row, self.row)?;
        let room = self.ends.rows.room();
        if room < rows.len() {
            // At most the queue's length.
            return Err(Refusal::NoRoom { room: room as u32 });
        }
        for &row in rows {
            if self.ends.rows.enqueue(Guarded::new(row)).is_ok() {
                self.row = self.row.wrapping_add(1);
            }
        }
        Ok(())
    }

    fn only_disarmed(&self) -> Result<(), Refusal<'static>> {
        if self.is_armed() { Err(Refusal::Armed) } else { Ok(()) }
    }

    fn info(&self) -> Info {
        Info {
            session: self.session.number(),
            muscles: MUSCLES as u8,
            types: TYPES as u8,
            channels: CHANNELS as u8,
            // A tick is at most 2 ms.
            tick_us: (self.step.seconds() * 1e6 + 0.5) as u32,
            restored: self.uploads.restored(),
            controlled: self.uploads.is_controlled(),
        }
    }

    fn of_outcome(&mut self, outcome: Outcome) -> Answer<'static> {
        match outcome {
            Outcome::Done => Answer::Done,
            Outcome::Took(bank) => {
                self.ends.spare = Some(bank);
                Answer::Done
            }
            Outcome::NotArmed(reason) => Answer::Refused(Refusal::NotArmed(reason)),
            Outcome::Report(mut report) => {
                report.frames = self.session.counters();
                Answer::Report(report)
            }
            Outcome::Words(words) => Answer::State(words),
            Outcome::Stepped(command) => Answer::Stepped(command),
            Outcome::Empty => Answer::Refused(Refusal::Empty),
        }
    }

    fn answer(&mut self, to: u16, answer: &Answer<'_>) {
        self.send(&Message::Answer { to, answer: answer.clone() });
    }

    fn refuse_frame(&mut self, error: LinkError) {
        self.send(&Message::NotActedUpon(error));
    }

    fn send(&mut self, message: &Message<'_>) {
        let Some(frame) = encode(NO_SESSION, self.sequence, message) else { return };
        self.sequence = self.sequence.wrapping_add(1);
        for byte in frame {
            let _there_is_room = self.out.push_back(byte);
        }
    }
}

/// Session number from the device's random number and the host's nonce; never 0, and not the last
/// one.
fn session_number(random: u32, nonce: u32, before: SessionNumber) -> SessionNumber {
    let number = (random ^ nonce) | 1;
    if number == before { number.wrapping_add(2) } else { number }
}

fn check_place(place: u8) -> Result<(), Refusal<'static>> {
    Ok(within("place", place.into(), 0, MUSCLES as u32 - 1)?)
}
