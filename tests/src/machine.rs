//! The stimulator as it would be flashed, in QEMU, with a host that speaks to it and looks at its pins.

use crate::{build, skip};
use firmware::Stimulus;
use firmware::link::{
    Answer, Message, NO_SESSION, Readings, Receiver, Refusal, Report, Request, SessionNumber,
    encode,
};
use firmware::safety::{CHANNELS, Fault, NotArmed, State};
use host_sim::hil::{Client, Emulated};
use host_sim::target::{STIMULATOR, STM32F405};
use object::{Object, ObjectSymbol};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stimulator_tests::host::READINGS;

/// The firmware's image, if it is to be had.
pub fn image() -> Option<PathBuf> {
    let built = build(STM32F405, STIMULATOR).and_then(|image| {
        let version = std::process::Command::new(host_sim::target::QEMU).arg("--version").output();
        version.map_err(host_sim::target::start_error(host_sim::target::QEMU)).map(|_| image)
    });
    built.map_err(|reason| skip(&reason.to_string())).ok()
}

/// A machine, and what its pins did.
pub struct Machine {
    line: Emulated,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    log: tempfile::NamedTempFile,
}

/// A stimulus with which nothing is wrong, of an amplitude in µA.
pub fn stimulus(amplitude_ua: u32) -> Stimulus {
    Stimulus { amplitude_ua, width_us: 200, gap_us: 50, frequency_tenths_pps: 1000, recovery: 1 }
}

/// Messages that keep a host heard for some hundredths of a second.
const KEPT_ALIVE: usize = 400;

/// Bytes that may be on their way to the firmware, which has room for four thousand.
const WINDOW: usize = 3600;

/// With a machine that does not do what it should.
const PATIENCE: Duration = Duration::from_secs(60);

/// Pins that do not move for so long are left alone.
const STILL: Duration = Duration::from_millis(300);

/// A host that is there, and a sensor that works.
pub fn kept_alive() -> Vec<Request> {
    let one = |index: usize| match index % 8 {
        0 => {
            let path_um = Some(160_000 + i32::from(index.is_multiple_of(16)));
            Request::Readings(Readings { path_um, ..READINGS })
        }
        _ => Request::KeepAlive,
    };
    (0..KEPT_ALIVE).map(one).collect()
}

/// Pulses of 10 mA on all channels, 400 a second.
pub fn drive() -> Request {
    Request::Drive([Some(stimulus(10_000)); CHANNELS])
}

/// What a device said to a request.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// It was done.
    Done,
    /// Supervision did not go along.
    NotArmed(NotArmed),
    /// How it is.
    Report(Report),
    /// A muscle's state.
    Words(Vec<u32>),
    /// Anything else, in words.
    Other(String),
}

impl Machine {
    /// Starts an image, with more arguments for the emulator, and greets it.
    pub fn start(image: &Path, arguments: Vec<String>) -> Self {
        let log = tempfile::NamedTempFile::new().expect("a file");
        // QEMU has no pins: what is written to them is in its log.
        let mut all = ["-d", "unimp", "-D"].map(str::to_owned).to_vec();
        all.push(log.path().display().to_string());
        all.extend(arguments);
        Self::greeted(Emulated::run(image, &all).expect("a machine"), log)
    }

    /// The same machine after it has started again.
    pub fn greeted_again(self) -> Self {
        Self::greeted(self.line, self.log)
    }

    fn greeted(line: Emulated, log: tempfile::NamedTempFile) -> Self {
        let mut client = Client::new(line);
        client.greet().expect("a greeting");
        let (session, sequence) = client.session();
        Self { line: client.into_line(), receiver: Receiver::new(), session, sequence, log }
    }

    /// Sends requests, and returns what was said to each.
    pub fn script(&mut self, requests: &[Request]) -> Vec<Said> {
        self.converse(requests, 0)
    }

    /// The same, but for the last ones, whose answers are not waited for.
    ///
    /// As much is always on its way as the firmware has room for: it finds the next request as soon as it looks.
    pub fn converse(&mut self, requests: &[Request], unanswered: usize) -> Vec<Said> {
        let mut frames = requests.iter();
        let (mut lengths, mut said) = (VecDeque::new(), Vec::new());
        let started = Instant::now();
        let mut byte = [0];
        loop {
            while lengths.iter().sum::<usize>() < WINDOW
                && let Some(request) = frames.next()
            {
                let frame = encode(self.session, self.sequence, request).expect("a frame");
                self.sequence = self.sequence.wrapping_add(1);
                self.line.write_all(&frame).expect("a line");
                lengths.push_back(frame.len());
            }
            if said.len() + unanswered >= requests.len() {
                return said;
            }
            assert!(started.elapsed() < PATIENCE, "silence after {said:?}");
            match self.line.read(&mut byte) {
                Ok(_) => (),
                Err(error)
                    if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) =>
                {
                    continue;
                }
                Err(error) => panic!("{error}"),
            }
            let Some(frame) = self.receiver.push(byte[0], NO_SESSION) else { continue };
            let frame = frame.expect("a whole frame");
            match postcard::from_bytes(frame.content).expect("a message") {
                Message::Answer { to, answer } => {
                    lengths.pop_front();
                    let behind = u16::try_from(frames.len() + lengths.len() + 1).expect("few");
                    let all = u16::try_from(frames.len()).expect("few");
                    assert_eq!(to, self.sequence.wrapping_add(all).wrapping_sub(behind));
                    said.push(match answer {
                        Answer::Done => Said::Done,
                        Answer::Report(report) => Said::Report(report),
                        Answer::State(words) => Said::Words(words.to_vec()),
                        Answer::Refused(Refusal::NotArmed(reason)) => Said::NotArmed(reason),
                        other => Said::Other(format!("{other:?}")),
                    });
                }
                Message::Traces(_) => (),
                other => panic!("{other:?}"),
            }
        }
    }

    /// How it is.
    pub fn report(&mut self) -> Report {
        match self.script(&[Request::Report])[..] {
            [Said::Report(report)] => report,
            ref other => panic!("{other:?}"),
        }
    }

    /// Names the fault that is latched, arms, and gives pulses for a while; then what is to happen. Returns how it
    /// was before that, and what was said to it.
    ///
    /// All in one, for between two scripts the firmware's host is silent for any time.
    pub fn stimulated(&mut self, latched: Fault, then: &[Request]) -> (Report, Vec<Said>) {
        let mut requests =
            vec![Request::Readings(READINGS), drive(), Request::Acknowledge(latched), Request::Arm];
        requests.extend(kept_alive());
        let armed = requests.len();
        requests.push(Request::Report);
        requests.extend_from_slice(then);
        let mut said = self.script(&requests);
        let after = said.split_off(armed + 1);
        let Some(Said::Report(report)) = said.pop() else { panic!("{said:?}") };
        assert!(said.iter().all(|one| *one == Said::Done), "{said:?}");
        assert_eq!(report.state, State::Armed);
        (report, after)
    }

    /// The pins once nothing has moved them for a while. Pulses come every 10 ms of the machine's time, of which a busy
    /// host may give it little.
    pub fn pins_at_last(&self) -> Pins {
        let started = Instant::now();
        let mut pins = self.pins();
        loop {
            std::thread::sleep(STILL);
            let later = self.pins();
            if later == pins {
                return pins;
            }
            assert!(started.elapsed() < PATIENCE, "it goes on: {pins:?}, {later:?}");
            pins = later;
        }
    }

    /// Levels of bridge and channel pins, as the log's end has them, and how often the bridge was closed.
    pub fn pins(&self) -> Pins {
        let text = std::fs::read_to_string(self.log.path()).expect("a log");
        let mut pins = Pins::default();
        for line in text.lines() {
            let Some((port, rest)) = line.split_once(": unimplemented device write (size 4, ")
            else {
                continue;
            };
            let Some(value) = rest.strip_prefix("offset 0x018, value 0x") else { continue };
            let value = u32::from_str_radix(value.trim_end_matches(')'), 16).expect("a word");
            let levels = match port {
                "GPIOB" => &mut pins.bridge,
                "GPIOC" => &mut pins.channels,
                _ => continue,
            };
            pins.closed += u32::from(port == "GPIOB" && value & 3 != 0);
            // Set by the lower half, reset by the upper one.
            *levels = (*levels | value & 0xffff) & !(value >> 16);
        }
        pins
    }
}

/// Levels of pins, and what they did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// A bit for each pin of the bridge.
    pub bridge: u32,
    /// A bit for each channel.
    pub channels: u32,
    /// How often the bridge was closed.
    pub closed: u32,
}

/// Address and size of the statics and functions whose name contains a text.
pub fn symbol(image: &Path, text: &str) -> (u64, usize) {
    let bytes = std::fs::read(image).expect("an image");
    let file = object::File::parse(&*bytes).expect("an ELF file");
    let found: Vec<(u64, u64)> = file
        .symbols()
        .filter(|symbol| symbol.name().is_ok_and(|name| name.contains(text)))
        .map(|symbol| (symbol.address(), symbol.size()))
        .collect();
    assert_eq!(found.len(), 1, "{text}: {found:x?}");
    (found[0].0, usize::try_from(found[0].1).expect("a size"))
}
