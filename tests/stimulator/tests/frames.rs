//! Frames: what is wrong, old or noise is named and counted, and never acted upon.

use firmware::link::{
    Counters, LinkError, MOST_FRAME, Message, NO_SESSION, Receiver, Request, Session,
    SessionNumber, encode,
};
use firmware::safety::{CHANNELS, Fault, State};
use model_tests::muscles::config;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::io::{Read, Write};
use stimulator_tests::client::{Client, NONCE};
use stimulator_tests::device::{InProcess, Memory};
use stimulator_tests::host::{READINGS, STIMULUS, arm, booted, fes, report};

/// A greeting.
const HELLO: Request = Request::Hello { nonce: NONCE };

/// Sends bytes by themselves, and returns all that the device says to them.
fn reactions(device: &mut InProcess<Memory>, bytes: &[u8]) -> Vec<String> {
    device.write_all(bytes).expect("a line");
    let mut receiver = Receiver::new();
    let (mut byte, mut said) = ([0], Vec::new());
    while device.read(&mut byte).is_ok() {
        if let Some(Ok(frame)) = receiver.push(byte[0], NO_SESSION) {
            let message: Message<'_> = postcard::from_bytes(frame.content).expect("a message");
            said.push(match message {
                Message::NotActedUpon(error) => format!("{error:?}"),
                other => format!("{other:?}"),
            });
        }
    }
    said
}

/// The same of a frame, to which there is one thing to say.
fn reaction(device: &mut InProcess<Memory>, bytes: &[u8]) -> String {
    let mut said = reactions(device, bytes);
    assert_eq!(said.len(), 1, "{said:?}");
    said.remove(0)
}

#[test]
fn each_way_to_be_wrong_has_a_name_and_is_counted() {
    let mut device = InProcess::boot(Memory::new());
    let drive = Request::Drive([None; CHANNELS]);
    // Before a greeting, nothing is done.
    let early = encode(NO_SESSION, 0, &drive).expect("a frame");
    assert_eq!(reaction(&mut device, &early), "NoSession");
    let hello = encode(NO_SESSION, 65535, &HELLO).expect("a frame");
    let info = reaction(&mut device, &hello);
    let number = info.split("session: ").nth(1).and_then(|rest| rest.split(',').next());
    let session: SessionNumber = number.and_then(|number| number.parse().ok()).expect("a number");
    let frame = |sequence, request: &Request| encode(session, sequence, request).expect("a frame");
    let drive = |sequence| frame(sequence, &drive);
    assert!(reaction(&mut device, &drive(0)).contains("Done"));
    // The same frame again, and one of before.
    let said = reaction(&mut device, &drive(0));
    assert_eq!(said, "Replayed { sequence: 0 }");
    let said = reaction(&mut device, &drive(65535));
    assert_eq!(said, "Replayed { sequence: 65535 }");
    let said = reaction(&mut device, &drive(2));
    assert_eq!(said, "OutOfOrder { got: 2, due: 1 }");
    // Every bit that can flip in a frame, its last zero aside.
    let good = drive(1);
    let is_broken = |said: &str| ["Checksum", "Malformed", "TooShort"].contains(&said);
    let mut broken = 0;
    for index in 0..good.len() - 1 {
        for bit in 0..8 {
            let mut bad = good.clone();
            bad[index] ^= 1 << bit;
            // A byte that becomes 0 makes two frames of one.
            let said = reactions(&mut device, &bad);
            assert!(!said.is_empty(), "byte {index} bit {bit}");
            assert!(said.iter().all(|one| is_broken(one)), "byte {index} bit {bit}: {said:?}");
            broken += said.len();
        }
    }
    // Cut off anywhere.
    for length in 1..good.len() - 1 {
        let mut cut = good[..length].to_vec();
        cut.push(0);
        let said = reaction(&mut device, &cut);
        assert!(is_broken(&said), "{length}: {said}");
        broken += 1;
    }
    let endless: Vec<u8> = std::iter::repeat_n(1, 3 * MOST_FRAME).chain([0]).collect();
    assert_eq!(reaction(&mut device, &endless), "TooLong");
    // Whole, and no message; a message and a bit more.
    let said = reaction(&mut device, &encode(session, 1, &0xEE_u8).expect("a frame"));
    assert_eq!(said, "NotAMessage");
    let said = reaction(&mut device, &encode(session, 1, &(Request::Arm, 0_u8)).expect("a frame"));
    assert_eq!(said, "NotAMessage");
    // Another version, whole in itself.
    let said = reaction(&mut device, &of_version(firmware::link::VERSION + 1, session, 1, &[0]));
    assert_eq!(said, "Version { got: 5, known: 4 }");
    // None of it was acted upon: the frame that is due still is.
    assert!(reaction(&mut device, &good).contains("Done"));
    let report = reaction(&mut device, &frame(2, &Request::Report));
    // The endless one is broken, too.
    let broken = u32::try_from(broken + 1).expect("few");
    let counters = Counters { accepted: 4, broken, refused: 7 };
    assert!(report.contains(&format!("{counters:?}")), "{report}, not {counters:?}");
}

/// A frame as a host of another version makes it: the envelope is the same in all of them.
fn of_version(version: u8, session: SessionNumber, sequence: u16, content: &[u8]) -> Vec<u8> {
    let mut whole = vec![version];
    whole.extend(sequence.to_le_bytes());
    whole.extend(content);
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    digest.update(&session.to_le_bytes());
    digest.update(&whole);
    whole.extend(digest.finalize().to_le_bytes());
    let mut frame = vec![0; cobs::max_encoding_length(whole.len())];
    let length = cobs::encode(&whole, &mut frame);
    frame.truncate(length);
    frame.push(0);
    frame
}

/// A host of version 1 greets with nothing but the request's number, later ones with a nonce: each
/// is told which version the device has, and begins no session.
#[test]
fn hosts_of_older_versions_are_refused_by_name() {
    let mut device = InProcess::boot(Memory::new());
    for (version, greeting) in [(1, &[0][..]), (2, &[0, 7]), (3, &[0, 7])] {
        let greeting = of_version(version, NO_SESSION, 65535, greeting);
        let said = format!("Version {{ got: {version}, known: 4 }}");
        assert_eq!(reaction(&mut device, &greeting), said);
    }
    let keep_alive = encode(NO_SESSION, 0, &Request::KeepAlive).expect("a frame");
    assert_eq!(reaction(&mut device, &keep_alive), "NoSession");
}

/// What the line says that it has lost is never guessed at.
#[test]
fn a_frame_that_the_line_has_lost_a_byte_of_is_not_acted_upon() {
    let mut device = InProcess::boot(Memory::new());
    let hello = encode(NO_SESSION, 0, &HELLO).expect("a frame");
    for before in 0..hello.len() {
        device.receive_with_a_loss(&hello, before);
        assert_eq!(reaction(&mut device, &[]), "Malformed", "before byte {before}");
    }
    assert!(reaction(&mut device, &hello).contains("session: "));
}

/// A greeting cannot be used to begin again under current.
#[test]
fn a_greeting_while_armed_is_a_frame_like_any_other() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    let replayed = encode(NO_SESSION, 0, &HELLO).expect("a frame");
    host.send_raw(&replayed);
    host.listen();
    assert_eq!(report(&mut host).frames.refused, 1);
    assert_eq!(report(&mut host).state, State::Armed);
}

/// All that a host has sent in a session, sent again in another one.
#[test]
fn a_recorded_session_does_nothing_in_another_one() {
    let mut host = booted();
    let (session, first) = host.session();
    let requests = [
        Request::Readings(READINGS),
        Request::Drive([Some(STIMULUS), None, None, None]),
        Request::Acknowledge(Fault::Boot),
        Request::Arm,
    ];
    let recorded: Vec<u8> = (first..)
        .zip(&requests)
        .flat_map(|(sequence, one)| encode(session, sequence, one).expect("a frame"))
        .collect();
    for request in &requests {
        host.order(request).expect("done");
    }
    assert_eq!(report(&mut host).state, State::Armed);
    host.order(&Request::Stop).expect("a stop");
    host.order(&Request::Acknowledge(Fault::Stopped)).expect("its name");

    host.greet().expect("a greeting");
    assert_ne!(host.session().0, session);
    let before = report(&mut host).frames;
    host.line().flowed();
    host.send_raw(&recorded);
    (0..100).for_each(|_| host.line().tick());
    // Each is answered with its name.
    recorded.iter().filter(|&&byte| byte == 0).for_each(|_| host.listen());
    let after = report(&mut host);
    assert_eq!(after.frames.broken, before.broken + 4);
    assert!(matches!(after.state, State::Acknowledged { fault: Fault::Stopped, .. }));
    assert_eq!(host.line().flowed(), 0);
}

/// Frames that a fuzzer makes of good ones: cut, joined, flipped, swapped, of any length.
fn mutated() -> impl Strategy<Value = Vec<u8>> {
    let request = prop_oneof![
        any::<u32>().prop_map(|nonce| Request::Hello { nonce }),
        Just(Request::Arm),
        Just(Request::Stop),
        Just(Request::Rest([Some(0.1), None])),
        Just(Request::Upload { place: 0, upload: fes() }),
        any::<u32>().prop_map(|first| Request::Rows { first, rows: heapless::Vec::new() }),
    ];
    let good = (any::<u16>(), request).prop_map(|(sequence, request)| {
        encode(NO_SESSION, sequence, &request).expect("a frame").to_vec()
    });
    let noise = prop::collection::vec(any::<u8>(), 0..40);
    (good, noise, any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..5_u8).prop_map(
        |(mut bytes, noise, from, to, how)| {
            let (from, to) = (from.index(bytes.len()), to.index(bytes.len()));
            let (from, to) = (from.min(to), from.max(to));
            match how {
                0 => bytes.truncate(from),
                1 => drop(bytes.splice(from..to, noise)),
                2 => bytes = noise,
                3 => bytes[from..to].reverse(),
                _ => bytes[from] ^= noise.first().copied().unwrap_or(1).max(1),
            }
            bytes
        },
    )
}

/// How many frames the decoder is fed; more with `VM_FUZZ_FRAMES`.
fn frames() -> u32 {
    std::env::var("VM_FUZZ_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(10_000_000)
}

/// Number of the session.
const SESSION: SessionNumber = 0x1234_5679;

/// A cheap source of bytes that look random, for as many frames as there are to be.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, most: usize) -> usize {
        usize::try_from(self.next() >> 16).expect("48 bits") % most.max(1)
    }
}

/// Ten million frames, most of them good ones that something has happened to: the receiver gives a
/// frame only if it has the bytes of one that was sent, and the session a request only with the
/// number that is due.
#[test]
fn ten_million_frames_and_none_is_acted_upon_that_was_not_meant() {
    let requests = [
        Request::KeepAlive,
        Request::Arm,
        Request::Acknowledge(Fault::Boot),
        Request::Drive([Some(STIMULUS), None, Some(STIMULUS), None]),
        Request::Readings(READINGS),
        Request::Rest([Some(0.16), None]),
    ];
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let (mut receiver, mut session) = (Receiver::new(), Session::new());
    let (mut due, mut accepted, mut wrong) = (0_u16, 0_u32, 0_u32);
    session
        .admit(
            receiver_of(&mut receiver, &encode(NO_SESSION, u16::MAX, &HELLO).expect("a frame")),
            |_| Ok(SESSION),
        )
        .expect("a greeting");
    let good: Vec<Vec<u8>> =
        requests.iter().map(|one| encode(SESSION, 0, one).expect("a frame").to_vec()).collect();
    let old: Vec<Vec<u8>> =
        requests.iter().map(|one| encode(SESSION - 2, 0, one).expect("a frame").to_vec()).collect();
    let mut bytes = Vec::new();
    for _ in 0..frames() {
        let index = noise.below(requests.len());
        bytes.clear();
        let fate = noise.below(8);
        if fate == 0 {
            bytes.extend_from_slice(&encode(SESSION, due, &requests[index]).expect("a frame"));
        } else {
            bytes.extend_from_slice(&good[index]);
        }
        let place = noise.below(bytes.len() - 1);
        match fate {
            0 => (),
            1 => bytes[place] ^= 1 << noise.below(8),
            2 => drop(bytes.drain(place..bytes.len() - 1)),
            3 => {
                let other = noise.below(bytes.len() - 1);
                bytes.swap(place, other);
            }
            4 => bytes.insert(place, u8::try_from(noise.below(256)).expect("a byte")),
            5 => {
                let other = noise.below(requests.len());
                bytes.splice(place.., good[other].iter().copied());
            }
            6 => bytes[place..].fill_with(|| u8::try_from(noise.below(256)).expect("a byte")),
            // Of an earlier session, or with a number that is over.
            _ if noise.below(2) == 0 => bytes.clone_from(&old[index]),
            _ => (),
        }
        bytes.push(0);
        for &byte in &bytes {
            let Some(received) = receiver.push(byte, SESSION) else { continue };
            match session.admit(received, |_| Err(LinkError::NoSession)) {
                Ok(request) => {
                    assert!(requests.contains(&request), "{request:?}");
                    accepted += 1;
                    due = due.wrapping_add(1);
                }
                Err(_) => wrong += 1,
            }
        }
    }
    let expected = frames() / 8;
    assert!(accepted >= expected / 2, "{accepted} accepted of {expected}");
    assert!(accepted <= expected + expected / 4 + 10_000, "{accepted} accepted of {expected}");
    assert!(wrong > frames() / 2, "{wrong}");
    assert_eq!(session.counters().accepted, accepted + 1);
}

fn receiver_of<'a>(
    receiver: &'a mut Receiver,
    frame: &[u8],
) -> Result<firmware::link::Frame<'a>, LinkError> {
    let (last, first) = frame.split_last().expect("a zero");
    for &byte in first {
        assert!(receiver.push(byte, SESSION).is_none());
    }
    receiver.push(*last, SESSION).expect("the end of a frame")
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(7), ..config(300) })]

    /// A whole device under fire: it neither stops nor stimulates, and still answers.
    #[test]
    fn nothing_on_the_line_arms_or_silences_a_device(fire in prop::collection::vec(mutated(), 1..40)) {
        let mut host = booted();
        for bytes in &fire {
            host.send_raw(bytes);
        }
        // Ends whatever is open, and takes what was said.
        host.send_raw(&[0]);
        while let Ok(1) = host.line().read(&mut [0]) {}
        prop_assert_eq!(host.line().flowed(), 0);
        let mut host = Client::new(host.into_line());
        prop_assert!(host.greet().is_ok());
        prop_assert!(matches!(report(&mut host).state, State::Latched(_)));
    }
}
