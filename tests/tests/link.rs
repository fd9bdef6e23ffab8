//! The link: what a host can do to a device, and what nothing on the line can.

use firmware::link::{
    Answer, Counters, Electrode, LinkError, MOST_FRAME, Message, NO_SESSION, Readings, Receiver,
    Report, Request, RowInputs, Session, SessionNumber, Upload, encode,
};
use firmware::safety::{CHANNELS, Fault, Limits, NotArmed, State};
use firmware::{MUSCLE, MUSCLES, Stimulus};
use host_sim::hil::{self, Client, HilError};
use host_sim::reference::Mode;
use host_sim::{muscle_file, trace};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use system_tests::device::{InProcess, Memory};
use system_tests::muscles::config;
use vm_nostd::RecruitmentCurveParams;

type Host = Client<InProcess<Memory>>;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/data").join(name)
}

fn booted() -> Host {
    let mut host = Client::new(InProcess::boot(Memory::new()));
    host.greet().expect("a greeting");
    host
}

fn report(host: &mut Host) -> Report {
    match host.ask(&Request::Report).expect("an answer") {
        Answer::Report(report) => report,
        other => panic!("{other:?}"),
    }
}

fn fes() -> Upload {
    Upload { mode: firmware::link::Mode::Fes, muscle: MUSCLE, electrode: None }
}

const READINGS: Readings =
    Readings { impedance_ohm: [Some(1000); CHANNELS], supply_mv: 3700, path_um: Some(160_000) };

/// Names the fault and arms, as a host does.
fn arm(host: &mut Host, fault: Fault) {
    host.order(&Request::Readings(READINGS)).expect("readings");
    host.order(&Request::Acknowledge(fault)).expect("its name");
    host.order(&Request::Arm).expect("nothing is wrong");
    assert_eq!(report(host).state, State::Armed);
}

/// A trace of the authors' program, played to the firmware: bits equal to the host's own run.
#[test]
fn a_trace_played_over_the_link_has_the_bits_of_the_hosts_run() {
    let muscle =
        muscle_file::read(&data("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    for (vector, mode) in [("fes_steps", Mode::Fes), ("continuous_length_3hz", Mode::Continuous)] {
        let trace = trace::read_inputs(&data(&format!("vectors/{vector}.csv"))).expect("inputs");
        let mut host = Client::new(InProcess::boot(Memory::new()));
        let played = hil::play(&mut host, &muscle, mode, &trace, &mut |_| ()).expect("equal bits");
        assert_eq!(played.rows.len(), trace.inputs.len());
        assert_eq!(played.report.rows as usize, trace.inputs.len() - 1);
        assert_eq!(played.report.frames.broken + played.report.frames.refused, 0);
        // Without arming, no current, whatever the rows say.
        assert_eq!(host.line().flowed(), 0);
    }
}

/// The comparison can fail: a device that was given another muscle.
#[test]
fn another_muscle_has_other_bits() {
    struct Tampered {
        device: InProcess<Memory>,
        answers: Receiver,
        session: SessionNumber,
    }
    impl Read for Tampered {
        fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
            let length = self.device.read(bytes)?;
            for &byte in &bytes[..length] {
                if let Some(Ok(frame)) = self.answers.push(byte, NO_SESSION)
                    && let Ok(Message::Answer { answer: Answer::Info(info), .. }) =
                        postcard::from_bytes(frame.content)
                {
                    self.session = info.session;
                }
            }
            Ok(length)
        }
    }
    impl Write for Tampered {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            // An upload is given another mass, in a frame that is whole.
            let mut receiver = Receiver::new();
            for &byte in bytes {
                if let Some(Ok(frame)) = receiver.push(byte, self.session)
                    && let Ok(Request::Upload { place, mut upload }) =
                        postcard::from_bytes(frame.content)
                {
                    upload.muscle.mass *= 1.000_001;
                    let request = Request::Upload { place, upload };
                    let frame = encode(frame.session, frame.sequence, &request);
                    self.device.write_all(&frame.expect("a frame"))?;
                    return Ok(bytes.len());
                }
            }
            self.device.write(bytes)
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let muscle =
        muscle_file::read(&data("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    let trace = trace::read_inputs(&data("vectors/fes_steps.csv")).expect("inputs");
    let mut host = Client::new(Tampered {
        device: InProcess::boot(Memory::new()),
        answers: Receiver::new(),
        session: NO_SESSION,
    });
    let played = hil::play(&mut host, &muscle, Mode::Fes, &trace, &mut |_| ());
    assert!(matches!(played, Err(HilError::Differs(_))), "{played:?}");
}

#[test]
fn an_activation_becomes_pulses_once_somebody_has_armed() {
    let mut host = booted();
    let curve = RecruitmentCurveParams {
        threshold: 4e-3,
        saturation: 12e-3,
        chronaxie: 200e-6,
        slope: 2.0,
    };
    let electrode = Electrode { channel: 2, curve, width_us: 200, gap_us: 40, recovery: 1 };
    let upload = Upload { electrode: Some(electrode), ..fes() };
    host.order(&Request::Upload { place: 1, upload }).expect("a muscle");
    host.order(&Request::Rest([None, Some(0.16)])).expect("a path");
    let rows = |first: u32, count: usize| {
        let inputs = RowInputs { activation: 0.5, path_length: 0.16, stimulation_frequency: 40.0 };
        let rows = std::iter::repeat_n([RowInputs::default(), inputs], count).collect();
        Request::Rows { first, rows }
    };
    // Not armed: the muscle is computed, and nothing flows.
    host.order(&rows(0, 8)).expect("room");
    (0..20).for_each(|_| host.line().tick());
    assert_eq!(host.line().flowed(), 0);
    arm(&mut host, Fault::Boot);
    for first in (8..1600).step_by(8) {
        while let Err(error) = host.order(&rows(first, 8)) {
            assert!(matches!(error, HilError::Refused { no_room: true, .. }), "{error}");
        }
        // A sensor has noise.
        let path_um = Some(160_000 + i32::try_from(first / 8 % 2).expect("0 or 1"));
        host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
    }
    // As much as recruits one half: 8 mA for ever, 16 mA for a chronaxie; of 50 mA by 4095 counts.
    assert_eq!(host.line().flowed(), 16 * 4095 / 50);
    let electrodes = host.line().electrodes.borrow();
    assert_eq!(electrodes.channels, [false, false, electrodes.channels[2], false]);
    drop(electrodes);
    let mut last = None;
    while let Some(traced) = host.next_trace() {
        last = Some(traced);
    }
    let force = last.expect("traces").outputs[1].force;
    assert!((20.0..200.0).contains(&force), "{force} N");
    // A host that falls silent: off after a tenth of a second.
    (0..102).for_each(|_| host.line().tick());
    host.line().flowed();
    (0..1000).for_each(|_| host.line().tick());
    assert_eq!(host.line().flowed(), 0);
    assert_eq!(report(&mut host).state, State::Latched(Fault::Silence));
}

#[test]
fn what_is_refused_is_named_and_changes_nothing() {
    let mut host = booted();
    let mut refused = |request: &Request| match host.ask(request) {
        Err(HilError::Refused { reason, .. }) => reason,
        other => panic!("{request:?}: {other:?}"),
    };
    let mut upload = fes();
    upload.muscle.mass = -1.0;
    assert_eq!(
        refused(&Request::Upload { place: 0, upload }),
        "mass = -1: must be between 0.00001 and 20"
    );
    let mut upload = fes();
    upload.muscle.fibers[1].fiber_type.half_force_frequency = f64::NAN;
    assert_eq!(
        refused(&Request::Upload { place: 0, upload }),
        "fibers[1].half_force_frequency = NaN: must be between 0.5 and 200"
    );
    assert_eq!(refused(&Request::Upload { place: 2, upload: fes() }), "place = 2: must be 0 to 1");
    let curve = RecruitmentCurveParams {
        threshold: 4e-3,
        saturation: 12e-3,
        chronaxie: 200e-6,
        slope: 2.0,
    };
    let electrode = Electrode { channel: 4, curve, width_us: 200, gap_us: 40, recovery: 1 };
    let with = |electrode| Request::Upload {
        place: 0,
        upload: Upload { electrode: Some(electrode), ..fes() },
    };
    assert_eq!(refused(&with(electrode)), "electrode.channel = 4: must be 0 to 3");
    let electrode = Electrode { channel: 0, ..electrode };
    assert_eq!(
        refused(&with(Electrode { recovery: 9, ..electrode })),
        "recovery = 9: must be 1 to 8"
    );
    assert_eq!(
        refused(&with(Electrode {
            curve: RecruitmentCurveParams { slope: 0.5, ..curve },
            ..electrode
        })),
        "slope = 0.5: must be between 1 and 10"
    );
    assert_eq!(refused(&Request::State { place: 0 }), "no muscle is at that place");
    assert_eq!(refused(&Request::Arm), "NotAcknowledged");
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]]).expect("room");
    assert_eq!(refused(&Request::Rows { first: 1, rows }), "first = 1: must be 0 to 0");
    host.order(&Request::Upload { place: 0, upload: fes() }).expect("a muscle");
    let rest = host.ask(&Request::Rest([Some(0.5), None]));
    let Err(HilError::Refused { reason, .. }) = rest else { panic!("{rest:?}") };
    assert!(reason.starts_with("path_length = 0.5: must be between 0.0"), "{reason}");
    // A device that is armed keeps its muscles.
    arm(&mut host, Fault::Boot);
    for request in [Request::Upload { place: 0, upload: fes() }, Request::Rest([None; MUSCLES])] {
        let answer = host.ask(&request);
        assert!(
            matches!(&answer, Err(HilError::Refused { reason, .. }) if reason == "stimulation is armed"),
            "{answer:?}"
        );
    }
    assert_eq!(report(&mut host).state, State::Armed);
    host.order(&Request::Stop).expect("a stop");
    assert_eq!(report(&mut host).state, State::Latched(Fault::Stopped));
}

#[test]
fn what_is_asked_of_supervision_is_answered_by_it() {
    let mut host = booted();
    let mut not_armed = |request: &Request| match host.ask(request) {
        Err(HilError::Refused { reason, .. }) => reason,
        other => panic!("{request:?}: {other:?}"),
    };
    let other = format!("{:?}", NotArmed::OtherFault);
    assert_eq!(not_armed(&Request::Acknowledge(Fault::Supply)), other);
    host.order(&Request::Acknowledge(Fault::Boot)).expect("its name");
    // No sensor has said anything yet.
    let Err(HilError::Refused { reason, .. }) = host.ask(&Request::Arm) else { panic!("armed") };
    assert_eq!(reason, format!("{:?}", NotArmed::StillThere(Fault::Supply)));
    arm(&mut host, Fault::Boot);
    // More than is allowed latches; the fault is named by whoever asks.
    let stimulus = Stimulus {
        amplitude_ua: Limits::SURFACE.amplitude_ua + 1,
        width_us: 200,
        gap_us: 40,
        frequency_tenths_pps: 400,
        recovery: 1,
    };
    host.order(&Request::Drive([Some(stimulus), None, None, None])).expect("taken");
    host.line().tick();
    assert_eq!(report(&mut host).state, State::Latched(Fault::Amplitude));
    assert_eq!(host.line().flowed(), 0);
}

/// What was asked for before a fault is not what whoever arms next asks for.
#[test]
fn nothing_that_was_asked_for_outlasts_a_fault() {
    let mut host = booted();
    let stimulus = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 40,
        frequency_tenths_pps: 400,
        recovery: 1,
    };
    arm(&mut host, Fault::Boot);
    host.order(&Request::Drive([Some(stimulus), None, None, None])).expect("taken");
    let keep = |host: &mut Host| {
        for index in 0..40 {
            let path_um = Some(160_000 + index % 2);
            host.order(&Request::Readings(Readings { path_um, ..READINGS })).expect("readings");
        }
        host.line().flowed()
    };
    assert!(keep(&mut host) > 0);
    host.order(&Request::Stop).expect("a stop");
    (0..3).for_each(|_| host.line().tick());
    host.line().flowed();
    assert_eq!(keep(&mut host), 0);
    arm(&mut host, Fault::Stopped);
    assert_eq!(keep(&mut host), 0, "a stimulus that nobody has asked for");
    // A stop between the two steps of arming counts, too.
    host.order(&Request::Stop).expect("a stop");
    host.order(&Request::Acknowledge(Fault::Stopped)).expect("its name");
    host.order(&Request::Stop).expect("a stop");
    assert!(host.order(&Request::Arm).is_err());
    assert_eq!(report(&mut host).state, State::Latched(Fault::Stopped));
}

/// A tick that is late while nothing is armed is no fault, and costs no row.
#[test]
fn a_late_tick_costs_no_row_while_nothing_is_armed() {
    let mut host = booted();
    host.order(&Request::Upload { place: 0, upload: fes() }).expect("a muscle");
    host.order(&Request::Rest([Some(0.16), None])).expect("a path");
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]; 8]).expect("room");
    host.order(&Request::Rows { first: 0, rows }).expect("room");
    host.line().tick_late();
    (0..20).for_each(|_| host.line().tick());
    let report = report(&mut host);
    assert_eq!((report.rows, report.late, report.state), (8, 1, State::Latched(Fault::Boot)));
    let rows: Vec<u32> =
        std::iter::from_fn(|| host.next_trace()).map(|traced| traced.row).collect();
    assert_eq!(rows, [0, 1, 2, 3, 4, 5, 6, 7]);
    // Armed it is, and takes those with it that waited.
    arm(&mut host, Fault::Boot);
    let rows = heapless::Vec::from_slice(&[[RowInputs::default(); MUSCLES]; 8]).expect("room");
    host.order(&Request::Rows { first: 8, rows }).expect("room");
    host.line().tick_late();
    (0..20).for_each(|_| host.line().tick());
    let report = self::report(&mut host);
    assert_eq!((report.rows, report.late, report.state), (16, 2, State::Latched(Fault::Deadline)));
    let traced = std::iter::from_fn(|| host.next_trace()).count();
    assert!(traced < 8, "{traced} rows had their tick");
}

/// A host that keeps itself heard, and has nothing to say of its sensors.
#[test]
fn readings_that_are_old_are_none() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    let before = report(&mut host).ticks;
    let keep = |host: &mut Host, until: u32| {
        loop {
            let report = report(host);
            if report.ticks - before >= until {
                return report.state;
            }
        }
    };
    assert_eq!(keep(&mut host, 180), State::Armed);
    assert_eq!(keep(&mut host, 210), State::Latched(Fault::SensorMissing));
    assert_eq!(report(&mut host).state, State::Latched(Fault::SensorMissing));
}

#[test]
fn muscles_outlast_a_loss_of_power() {
    let mut host = booted();
    host.order(&Request::Upload { place: 1, upload: fes() }).expect("a muscle");
    host.order(&Request::Rest([None; MUSCLES])).expect("rest");
    let Answer::State(before) = host.ask(&Request::State { place: 1 }).expect("words") else {
        panic!("no words")
    };
    let memory = host.into_line().into_memory();
    let mut host = Client::new(InProcess::boot(memory));
    let info = host.greet().expect("a greeting");
    assert_eq!(info.restored, 1);
    let Answer::State(after) = host.ask(&Request::State { place: 1 }).expect("words") else {
        panic!("no words")
    };
    assert_eq!(after, before);
    assert_eq!(report(&mut host).state, State::Latched(Fault::Boot));
}

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
    let hello = encode(NO_SESSION, 65535, &Request::Hello).expect("a frame");
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
    let mut whole = vec![firmware::link::VERSION + 1, 1, 0, 0];
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    digest.update(&session.to_le_bytes());
    digest.update(&whole);
    whole.extend(digest.finalize().to_le_bytes());
    let mut other = vec![0; 32];
    let length = cobs::encode(&whole, &mut other);
    other.truncate(length + 1);
    let said = reaction(&mut device, &other);
    assert_eq!(said, "Version { got: 2, known: 1 }");
    // None of it was acted upon: the frame that is due still is.
    assert!(reaction(&mut device, &good).contains("Done"));
    let report = reaction(&mut device, &frame(2, &Request::Report));
    // The endless one is broken, too.
    let broken = u32::try_from(broken + 1).expect("few");
    let counters = Counters { accepted: 4, broken, refused: 7 };
    assert!(report.contains(&format!("{counters:?}")), "{report}, not {counters:?}");
}

/// A greeting cannot be used to begin again under current.
#[test]
fn a_greeting_while_armed_is_a_frame_like_any_other() {
    let mut host = booted();
    arm(&mut host, Fault::Boot);
    let replayed = encode(NO_SESSION, 0, &Request::Hello).expect("a frame");
    host.send_raw(&replayed).expect("a line");
    host.listen().expect("a line");
    assert_eq!(report(&mut host).frames.refused, 1);
    assert_eq!(report(&mut host).state, State::Armed);
}

/// All that a host has sent in a session, sent again in another one.
#[test]
fn a_recorded_session_does_nothing_in_another_one() {
    let mut host = booted();
    let (session, first) = host.session();
    let stimulus = Stimulus {
        amplitude_ua: 10_000,
        width_us: 200,
        gap_us: 40,
        frequency_tenths_pps: 400,
        recovery: 1,
    };
    let requests = [
        Request::Readings(READINGS),
        Request::Drive([Some(stimulus), None, None, None]),
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
    host.send_raw(&recorded).expect("a line");
    (0..100).for_each(|_| host.line().tick());
    let after = report(&mut host);
    assert_eq!(after.frames.broken, before.broken + 4);
    assert!(matches!(after.state, State::Acknowledged { fault: Fault::Stopped, .. }));
    assert_eq!(host.line().flowed(), 0);
}

/// Frames that a fuzzer makes of good ones: cut, joined, flipped, swapped, of any length.
fn mutated() -> impl Strategy<Value = Vec<u8>> {
    let request = prop_oneof![
        Just(Request::Hello),
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

/// Ten million frames, most of them good ones that something has happened to: the receiver gives a frame only
/// if it has the bytes of one that was sent, and the session a request only with the number that is due.
#[test]
fn ten_million_frames_and_none_is_acted_upon_that_was_not_meant() {
    let stimulus = Stimulus {
        amplitude_ua: 1000,
        width_us: 200,
        gap_us: 40,
        frequency_tenths_pps: 300,
        recovery: 1,
    };
    let requests = [
        Request::KeepAlive,
        Request::Arm,
        Request::Acknowledge(Fault::Boot),
        Request::Drive([Some(stimulus), None, Some(stimulus), None]),
        Request::Readings(READINGS),
        Request::Rest([Some(0.16), None]),
    ];
    let mut noise = Noise(0x9E37_79B9_7F4A_7C15);
    let (mut receiver, mut session) = (Receiver::new(), Session::new());
    let (mut due, mut accepted, mut wrong) = (0_u16, 0_u32, 0_u32);
    session
        .admit(
            receiver_of(
                &mut receiver,
                &encode(NO_SESSION, u16::MAX, &Request::Hello).expect("a frame"),
            ),
            Some(SESSION),
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
            match session.admit(received, None) {
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
            host.send_raw(bytes).expect("a line");
        }
        // Ends whatever is open, and takes what was said.
        host.send_raw(&[0]).expect("a line");
        while let Ok(1) = host.line().read(&mut [0]) {}
        prop_assert_eq!(host.line().flowed(), 0);
        let mut host = Client::new(host.into_line());
        prop_assert!(host.greet().is_ok());
        prop_assert!(matches!(report(&mut host).state, State::Latched(_)));
    }
}
