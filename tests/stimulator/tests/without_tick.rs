//! What the link's end answers by itself, before the tick has taken its first order.

use firmware::link::{Answer, Info, Request, RowInputs, Upload};
use firmware::{LinkQueues, MUSCLES, Permission, PollCount, Server, Slots, TICK_US, TickEnds};
use std::io::{Error, ErrorKind, Read, Result, Write};
use stimulator_tests::client::{Client, ClientError};
use stimulator_tests::device::Memory;
use stimulator_tests::host::fes;
use vm_nostd::TimeStep;

/// A server whose tick has not come yet: the order of the boot waits, and so do rows.
struct Alone {
    server: Server<'static, Memory, PollCount>,
    _tick: TickEnds<'static>,
}

impl Alone {
    fn booted() -> Self {
        let queues: &'static mut LinkQueues = Box::leak(Box::default());
        let (tick, ends) = queues.split(Box::leak(Box::default()));
        let permission: &'static Permission = Box::leak(Box::default());
        let room = Box::leak(Box::default());
        let step = TimeStep::MILLISECOND;
        let server = Server::new(room, ends, permission, Memory::new(), PollCount, step);
        Self { server, _tick: tick }
    }
}

impl Read for Alone {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        let Some(byte) = self.server.transmit() else {
            return Err(Error::from(ErrorKind::TimedOut));
        };
        bytes[0] = byte;
        Ok(1)
    }
}

impl Write for Alone {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        bytes.iter().for_each(|&byte| self.server.receive(byte));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn greeted() -> (Client<Alone>, Info) {
    let mut host = Client::new(Alone::booted());
    let info = host.greet().expect("a greeting");
    (host, info)
}

#[test]
fn a_greeting_says_what_the_device_is() {
    let (host, info) = greeted();
    let (session, _) = host.session();
    let (muscles, types, channels) = (2, 2, 4);
    let expected = Info {
        session,
        muscles,
        types,
        channels,
        tick_us: TICK_US,
        restored: 0,
        controlled: false,
    };
    assert_eq!((info, TICK_US), (expected, 1000));
}

/// 63 of them wait: a message that fits exactly is taken whole, any other not at all.
#[test]
fn rows_are_taken_until_there_is_no_room_for_a_message() {
    let (mut host, _) = greeted();
    let mut rows = |first: u32, count: usize| {
        let rows = std::iter::repeat_n([RowInputs::default(); MUSCLES], count).collect();
        host.ask(&Request::Rows { first, rows })
    };
    let no_room = |room: u32| {
        let reason = format!("NoRoom {{ room: {room} }}");
        Err(ClientError::Refused { reason, no_room: true })
    };
    for first in (0..56).step_by(8) {
        assert_eq!(rows(first, 8), Ok(Answer::Done), "{first}");
    }
    assert_eq!(rows(56, 8), no_room(7));
    assert_eq!(rows(56, 7), Ok(Answer::Done));
    assert_eq!(rows(63, 1), no_room(0));
}

/// What the tick has no bank for is refused before it is stored: a boot would restore it.
#[test]
fn what_the_tick_cannot_take_yet_is_not_stored() {
    let (mut host, _) = greeted();
    let upload = Upload { electrode: None, ..fes() };
    for request in
        [Request::Upload { place: 0, upload }, Request::Control(None), Request::Rest([None; 2])]
    {
        let reason = "NoRoom { room: 0 }".to_owned();
        let refused = Err(ClientError::Refused { reason, no_room: true });
        assert_eq!(host.ask(&request), refused, "{request:?}");
    }
    let mut buffer = [0; _];
    let memory = host.into_line().server.into_memory();
    assert_eq!(Slots::new(memory, &mut buffer).load(), None);
}
