//! All that a host has sent since boot, recorded, and sent again to a device that has booted again.

use firmware::link::Request;
use firmware::safety::{CHANNELS, Fault, State};
use firmware::{PollCount, Randomness};
use std::io::{Read, Result, Write};
use stimulator_tests::client::Client;
use stimulator_tests::device::{InProcess, LIMITS, Memory, Numbers};
use stimulator_tests::host::{Host, READINGS, STIMULUS, report};

/// A line that keeps what a host sends, and in which tick.
struct Taped {
    device: InProcess<Memory>,
    tape: Vec<(u32, Vec<u8>)>,
}

impl Read for Taped {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        self.device.read(bytes)
    }
}

impl Write for Taped {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.tape.push((self.device.ticks(), bytes.to_vec()));
        self.device.write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn booted(randomness: Box<dyn Randomness>) -> InProcess<Memory> {
    InProcess::boot_of(Memory::new(), LIMITS, randomness)
}

/// A session that stimulates: the tape of it, and its number.
fn recorded(randomness: Box<dyn Randomness>) -> (Vec<(u32, Vec<u8>)>, u32) {
    let mut host = Client::new(Taped { device: booted(randomness), tape: Vec::new() });
    host.greet().expect("a greeting");
    let session = host.session().0;
    host.order(&Request::Readings(READINGS)).expect("readings");
    host.order(&Request::Drive([Some(STIMULUS), None, None, None])).expect("a stimulus");
    host.order(&Request::Acknowledge(Fault::Boot)).expect("its name");
    host.order(&Request::Arm).expect("nothing is wrong");
    for _ in 0..20 {
        host.order(&Request::Readings(READINGS)).expect("readings");
    }
    let Taped { mut device, tape } = host.into_line();
    assert!(device.flowed() > 0, "a tape of nothing");
    (tape, session)
}

/// Plays a tape to a device that has just booted, each byte in the tick in which it came: the most
/// counts that flow.
fn played(tape: &[(u32, Vec<u8>)], randomness: Box<dyn Randomness>) -> (u16, InProcess<Memory>) {
    let mut device = booted(randomness);
    for (tick, bytes) in tape {
        while device.ticks() < *tick {
            device.drain();
            device.tick();
        }
        device.drain();
        device.write_all(bytes).expect("a line");
    }
    for _ in 0..100 {
        device.drain();
        device.tick();
    }
    device.drain();
    (device.flowed(), device)
}

/// The host's nonce is that on the tape; the device has booted again, and its numbers are others.
#[test]
fn a_tape_played_after_a_reset_at_the_same_tick_does_nothing() {
    let (tape, _) = recorded(Box::new(Numbers(1)));
    for seed in 2..50 {
        let (flowed, device) = played(&tape, Box::new(Numbers(seed)));
        assert_eq!(flowed, 0, "seed {seed}");
        let mut host = Client::new(device);
        host.greet().expect("a greeting");
        let report = report(&mut host);
        assert_eq!(report.state, State::Latched(Fault::Boot));
        // All but the greetings: 4 requests, and 20 times the readings.
        assert_eq!(report.frames.broken, 24, "seed {seed}");
    }
    // The same numbers again, and the tape is what the device waits for: it is the numbers that
    // keep it out.
    assert!(played(&tape, Box::new(Numbers(1))).0 > 0);
}

/// What an emulator has instead is no more than it says: to the poll the same boot, and the tape
/// plays.
#[test]
fn without_a_generator_a_boot_that_is_repeated_to_the_poll_repeats_its_session() {
    let (tape, session) = recorded(Box::new(PollCount));
    assert!(played(&tape, Box::new(PollCount)).0 > 0, "better than it is said to be");
    // One poll more, and it is another session.
    let mut late = tape.clone();
    late.iter_mut().for_each(|(tick, _)| *tick += 1);
    assert_eq!(played(&late, Box::new(PollCount)).0, 0);
    // Another host adds another nonce.
    assert_ne!(session_with(0xA0_0007, 1), session);
    assert_ne!(session_with(1, 1), session_with(2, 1));
    // Every bit of the nonce counts, but for the one that is always set.
    for bit in 1..32 {
        assert_ne!(session_with(1 << bit, 1), session_with(0, 1), "bit {bit}");
    }
}

/// The number of the session that a greeting with a nonce begins after so many ticks.
fn session_with(nonce: u32, ticks: u32) -> u32 {
    use firmware::link::{Answer, Message, NO_SESSION, Receiver, encode};
    let mut device = booted(Box::new(PollCount));
    (0..ticks).for_each(|_| device.tick());
    let hello = encode(NO_SESSION, 0, &Request::Hello { nonce }).expect("a frame");
    device.write_all(&hello).expect("a line");
    let (mut byte, mut receiver) = ([0], Receiver::new());
    while device.read(&mut byte).is_ok() {
        if let Some(Ok(frame)) = receiver.push(byte[0], NO_SESSION)
            && let Ok(Message::Answer { answer: Answer::Info(info), .. }) =
                postcard::from_bytes(frame.content)
        {
            return info.session;
        }
    }
    panic!("no session")
}

/// A generator that gives nothing begins no session, and says why; one that does again, does.
#[test]
fn without_a_random_number_no_session_begins() {
    struct Broken(u32);
    impl Randomness for Broken {
        fn number(&mut self, _polls: u32) -> Option<u32> {
            self.0 = self.0.saturating_sub(1);
            (self.0 == 0).then_some(7)
        }
    }
    let mut host = Client::new(booted(Box::new(Broken(3))));
    assert!(host.ask(&Request::Arm).is_err());
    let hello = |host: &mut Host| host.ask(&Request::Hello { nonce: 1 });
    for _ in 0..2 {
        let error = hello(&mut host).expect_err("no number");
        assert_eq!(format!("{error:?}"), "NotActedUpon(NoRandomNumber)");
        assert!(host.ask(&Request::Drive([None; CHANNELS])).is_err());
    }
    host.greet().expect("a number");
}

/// Odd whatever it is made of, and never that of the session before.
#[test]
fn no_session_has_the_number_of_none_or_of_the_one_before() {
    struct Always(u32);
    impl Randomness for Always {
        fn number(&mut self, _polls: u32) -> Option<u32> {
            Some(self.0)
        }
    }
    // Together with the nonce 0, 1 and 2.
    for with in 0..3 {
        let number = Always(stimulator_tests::client::NONCE ^ with);
        let mut host = Client::new(booted(Box::new(number)));
        let mut before = 0;
        for _ in 0..5 {
            host.greet().expect("a greeting");
            let number = host.session().0;
            assert_eq!(number % 2, 1);
            assert_ne!(number, before);
            before = number;
        }
    }
}
