//! The firmware's three levels on fakes, of which a higher one may run before each access of a
//! lower one to what they share. Whether it does is a choice of the explorer.

use crate::device::{Memory, Numbers};
use crate::electrodes::{Converter, Pin, SCALE, Shared, stage};
use crate::explorer::choose;
use firmware::link::{
    Answer, Info, Message, NO_SESSION, Receiver, Refusal, Request, SessionNumber, Traced, encode,
};
use firmware::safety::Fault;
use firmware::{
    Controller, Deadline, Device, Limits, LinkQueues, Permission, PlanQueue, Pulses, Server,
    ServerRoom, explore,
};
use self_cell::{MutBorrow, self_cell};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use vm_nostd::TimeStep;

/// A tick, µs.
pub const TICK: u32 = 1000;

/// Interrupt levels; a greater one interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    /// Set-up, which nothing interrupts.
    Alone,
    Pulse,
    Tick,
    Link,
}

/// The firmware's statics.
#[derive(Default)]
struct Statics {
    plans: PlanQueue,
    permission: Permission,
    link_queues: LinkQueues,
    room: ServerRoom,
}

struct Tasks<'q> {
    pulses: RefCell<Pulses<'q, Converter, Pin>>,
    device: RefCell<Device<'q>>,
    server: RefCell<Server<'q, Memory, Numbers>>,
}

self_cell!(
    struct Firmware {
        owner: MutBorrow<Statics>,
        #[not_covariant]
        dependent: Tasks,
    }
);

/// All three levels, the electrodes, and violations.
pub struct Levels {
    firmware: Firmware,
    /// The electrodes.
    pub electrodes: Shared,
    level: Cell<Level>,
    /// Interrupts that may still come where they are chosen to.
    pulse_interrupts: Cell<u32>,
    tick_interrupts: Cell<u32>,
    /// The tick calls for the pulse timer's interrupt where it has to; else a bug was planted.
    attends: bool,
    ticks: Cell<u32>,
    timer_us: Cell<u32>,
    step_us: Cell<u32>,
    /// Since a tick that was not armed, and the interrupt it called for.
    neutral: Cell<bool>,
    late: Cell<bool>,
    /// Counts of the currents that have flowed since this was asked last.
    flowed: RefCell<Vec<u16>>,
    problem: RefCell<Option<String>>,
    receiver: RefCell<Receiver>,
    session: Cell<SessionNumber>,
    sequence: Cell<u16>,
    /// Messages to the host, in order.
    pub answers: RefCell<Vec<(u16, Answer<'static>)>>,
    /// A request found no room: the host may send it again.
    pub refused_for_room: Cell<bool>,
    /// Outputs of rows, in order.
    pub traces: RefCell<Vec<Traced>>,
}

thread_local! {
    static CURRENT: RefCell<Option<Rc<Levels>>> = const { RefCell::new(None) };
}

fn before_each_access() {
    if let Some(levels) = CURRENT.with_borrow(Clone::clone) {
        levels.may_be_interrupted();
    }
}

impl Levels {
    /// At boot, greeted.
    pub fn boot(limits: Limits, attends: bool) -> Rc<Self> {
        explore::before_each_access(None);
        let (stage, electrodes) = stage();
        let firmware = Firmware::new(MutBorrow::new(Statics::default()), |statics| {
            let Statics { plans, permission, link_queues, room } = statics.borrow_mut();
            let permission = &*permission;
            let (give, take) = plans.split();
            let (tick_ends, link_ends) = link_queues.split(Box::leak(Box::default()));
            let controller = Controller::new(limits, TICK, Fault::Boot, SCALE, give, permission)
                .expect("valid limits");
            let server = Server::new(
                room,
                link_ends,
                permission,
                Memory::new(),
                Numbers(1),
                TimeStep::MILLISECOND,
            );
            Tasks {
                pulses: RefCell::new(Pulses::new(stage, take, permission, TICK)),
                device: RefCell::new(Device::new(controller, tick_ends, Deadline::new(TICK, 1))),
                server: RefCell::new(server),
            }
        });
        let levels = Rc::new(Self {
            firmware,
            electrodes,
            level: Cell::new(Level::Alone),
            pulse_interrupts: Cell::new(0),
            tick_interrupts: Cell::new(0),
            attends,
            ticks: Cell::new(0),
            timer_us: Cell::new(0),
            step_us: Cell::new(Pulses::<Converter, Pin>::FIRST_US),
            neutral: Cell::new(true),
            late: Cell::new(false),
            flowed: RefCell::default(),
            problem: RefCell::default(),
            receiver: RefCell::default(),
            session: Cell::new(NO_SESSION),
            sequence: Cell::new(0),
            answers: RefCell::default(),
            refused_for_room: Cell::new(false),
            traces: RefCell::default(),
        });
        CURRENT.set(Some(Rc::clone(&levels)));
        explore::before_each_access(Some(before_each_access));
        levels.pass(1);
        levels.ask(&Request::Hello { nonce: 1 });
        levels
    }

    /// From now on so many interrupts of the pulse timer, and of the tick, come where they are
    /// chosen to.
    pub fn explore(&self, pulse_interrupts: u32, tick_interrupts: u32) {
        self.pulse_interrupts.set(pulse_interrupts);
        self.tick_interrupts.set(tick_interrupts);
    }

    /// Violation, if any.
    pub fn problem(&self) -> Option<String> {
        self.problem.borrow().clone()
    }

    /// Counts of all currents that have flowed since this was asked last.
    pub fn flowed(&self) -> Vec<u16> {
        self.flowed.take()
    }

    fn fault(&self, problem: impl FnOnce() -> String) {
        self.problem.borrow_mut().get_or_insert_with(problem);
    }

    /// Lets a higher level run, as often as it is chosen to.
    fn may_be_interrupted(&self) {
        let level = self.level.get();
        loop {
            // The time of this tick has to be long enough for it.
            let pulse = level > Level::Pulse
                && self.pulse_interrupts.get() > 0
                && self.timer_us.get() < self.ticks.get() * TICK;
            let tick = level > Level::Tick && self.tick_interrupts.get() > 0;
            let options = 1 + u8::from(pulse) + u8::from(tick);
            let choice = if options > 1 { choose(options) } else { 0 };
            match (choice, pulse) {
                (0, _) => return,
                (1, true) => {
                    self.pulse_interrupts.update(|left| left - 1);
                    self.pulse();
                }
                _ => {
                    self.tick_interrupts.update(|left| left - 1);
                    self.tick();
                }
            }
        }
    }

    fn at<T>(&self, level: Level, task: impl FnOnce(&Tasks<'_>) -> T) -> T {
        let before = self.level.replace(level);
        let done = self.firmware.with_dependent(|_, tasks| task(tasks));
        self.level.set(before);
        done
    }

    /// The pulse timer runs out.
    pub fn pulse(&self) {
        self.electrodes.borrow_mut().words = 0;
        let lasts_us = self.step_us.get();
        self.step_us.set(self.at(Level::Pulse, |tasks| tasks.pulses.borrow_mut().timer()));
        self.timer_us.update(|before| before + lasts_us);
        self.see();
    }

    /// The pulse timer ran out twice before its interrupt was through.
    pub fn overrun(&self) {
        self.electrodes.borrow_mut().words = 0;
        self.at(Level::Pulse, |tasks| tasks.pulses.borrow_mut().overran());
        self.see();
    }

    /// The next tick ends after the one that follows it was due.
    pub fn next_is_late(&self) {
        self.late.set(true);
    }

    /// A tick, with the pulse timer's steps before it and the interrupt it triggers.
    pub fn tick(&self) {
        self.catch_up();
        self.ticks.update(|before| before + 1);
        let armed = self.at(Level::Tick, |tasks| tasks.device.borrow_mut().tick(0));
        self.ended(armed);
        // Between the two the tick is interrupted as well.
        self.at(Level::Tick, |_| self.may_be_interrupted());
        let late = self.late.take();
        let in_time = self.at(Level::Tick, |tasks| tasks.device.borrow_mut().finish(100, late));
        self.ended(armed && in_time);
    }

    fn ended(&self, armed: bool) {
        self.neutral.set(!armed);
        if !armed && self.attends {
            self.electrodes.borrow_mut().words = 0;
            self.at(Level::Pulse, |tasks| tasks.pulses.borrow_mut().attend());
        }
        self.see();
    }

    /// The pulse timer runs out once, after the ticks that are due before.
    pub fn step(&self) {
        if self.timer_us.get() >= self.ticks.get() * TICK {
            self.tick();
        }
        self.pulse();
    }

    /// Ticks, with the pulse timer's steps between them.
    pub fn pass(&self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
        self.catch_up();
    }

    /// Until the pulse timer has come to the next tick.
    fn catch_up(&self) {
        while self.timer_us.get() < self.ticks.get() * TICK {
            self.pulse();
        }
    }

    /// When the next tick is due, µs.
    pub fn next_tick_us(&self) -> u32 {
        self.ticks.get() * TICK
    }

    /// When the pulse timer runs out next, µs.
    pub fn timer_us(&self) -> u32 {
        self.timer_us.get()
    }

    fn see(&self) {
        let electrodes = self.electrodes.borrow();
        if let Some(problem) = electrodes.problems.first() {
            self.fault(|| problem.clone());
        }
        let flows = electrodes.counts > 0 && (electrodes.cathodic || electrodes.anodic);
        if self.neutral.get() && (flows || electrodes.cathodic || electrodes.anodic) {
            self.fault(|| format!("current that no tick allows: {electrodes:?}"));
        }
        if flows {
            self.flowed.borrow_mut().push(electrodes.counts);
        }
    }

    /// A frame arrives. Its last byte is the one that does something: before the others, nothing is
    /// shared that is not before it.
    pub fn send(&self, request: &Request) {
        let hello = matches!(request, Request::Hello { .. });
        let session = if hello { NO_SESSION } else { self.session.get() };
        let frame = encode(session, self.sequence.get(), request).expect("a frame");
        self.sequence.update(|before| before.wrapping_add(1));
        let (last, first) = frame.split_last().expect("a zero");
        for &byte in first {
            self.at(Level::Alone, |tasks| tasks.server.borrow_mut().receive(byte));
        }
        self.at(Level::Link, |tasks| tasks.server.borrow_mut().receive(*last));
    }

    /// The link polls and sends.
    pub fn poll(&self) {
        self.at(Level::Link, |tasks| tasks.server.borrow_mut().poll());
        while let Some(byte) = self.at(Level::Alone, |tasks| tasks.server.borrow_mut().transmit()) {
            self.hear(byte);
        }
    }

    /// Whether the link takes a byte.
    pub fn is_ready(&self) -> bool {
        self.at(Level::Alone, |tasks| tasks.server.borrow_mut().is_ready())
    }

    fn hear(&self, byte: u8) {
        let mut receiver = self.receiver.borrow_mut();
        let Some(Ok(frame)) = receiver.push(byte, NO_SESSION) else { return };
        match postcard::from_bytes::<Message<'_>>(frame.content) {
            Ok(Message::Answer { to, answer }) => {
                let answer = match answer {
                    Answer::Done => Answer::Done,
                    Answer::Report(report) => Answer::Report(report),
                    Answer::State(words) => Answer::State(words),
                    Answer::Stepped(command) => Answer::Stepped(command),
                    Answer::Info(info) => {
                        let Info { session, .. } = info;
                        self.session.set(session);
                        Answer::Info(info)
                    }
                    Answer::Refused(Refusal::NoRoom { .. }) => {
                        self.refused_for_room.set(true);
                        return;
                    }
                    Answer::Refused(refusal) => {
                        self.fault(|| format!("{refusal:?}"));
                        return;
                    }
                };
                self.answers.borrow_mut().push((to, answer));
            }
            Ok(Message::Traces(traces)) => self.traces.borrow_mut().extend(traces),
            other => self.fault(|| format!("{other:?}")),
        }
    }

    /// A request, and ticks until it is answered.
    pub fn ask(&self, request: &Request) -> Answer<'static> {
        let sequence = self.sequence.get();
        self.send(request);
        for _ in 0..10 {
            self.poll();
            if let Some((to, answer)) = self.answers.borrow_mut().pop() {
                assert_eq!(to, sequence);
                return answer;
            }
            self.pass(1);
        }
        self.fault(|| format!("no answer to {request:?}"));
        Answer::Done
    }
}
