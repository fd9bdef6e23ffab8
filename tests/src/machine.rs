//! The stimulator's image in QEMU, a client for it, and its pins.

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

/// Builds the firmware's image; `None` if the test is skipped.
pub fn image() -> Option<PathBuf> {
    let built = build(STM32F405, STIMULATOR).and_then(|image| {
        let version = std::process::Command::new(host_sim::target::QEMU).arg("--version").output();
        version.map_err(host_sim::target::start_error(host_sim::target::QEMU)).map(|_| image)
    });
    built.map_err(|reason| skip(&reason.to_string())).ok()
}

/// A running machine with a log of its pins.
pub struct Machine {
    line: Emulated,
    receiver: Receiver,
    session: SessionNumber,
    sequence: u16,
    log: tempfile::NamedTempFile,
}

/// A valid stimulus of an amplitude in µA.
pub fn stimulus(amplitude_ua: u32) -> Stimulus {
    Stimulus { amplitude_ua, width_us: 200, gap_us: 50, frequency_tenths_pps: 1000, recovery: 1 }
}

/// Number of keep-alive messages, enough for about 10 ms.
const KEPT_ALIVE: usize = 400;

/// Limit of bytes in flight to the firmware, which buffers 4,000.
const WINDOW: usize = 3600;

/// Timeout of the machine.
const TIMEOUT: Duration = Duration::from_secs(60);

/// Pins count as settled after this time without a change.
const STILL: Duration = Duration::from_millis(300);

/// Messages of a live host with a working sensor.
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

/// Answer of a device.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// Done.
    Done,
    /// Arming was refused.
    NotArmed(NotArmed),
    /// Report.
    Report(Report),
    /// A muscle's state.
    Words(Vec<u32>),
    /// Anything else, as text.
    Other(String),
}

impl Machine {
    /// Starts an image with additional arguments for QEMU, and greets it.
    pub fn start(image: &Path, arguments: Vec<String>) -> Self {
        let log = tempfile::NamedTempFile::new().expect("a file");
        // QEMU has no pins; writes to them are in its log.
        let mut all = ["-d", "unimp", "-D"].map(str::to_owned).to_vec();
        all.push(log.path().display().to_string());
        all.extend(arguments);
        Self::greeted(Emulated::run(image, &all).expect("a machine"), log)
    }

    /// Greets the machine again after a reset.
    pub fn greeted_again(self) -> Self {
        Self::greeted(self.line, self.log)
    }

    fn greeted(line: Emulated, log: tempfile::NamedTempFile) -> Self {
        let mut client = Client::new(line);
        client.greet().expect("a greeting");
        let (session, sequence) = client.session();
        Self { line: client.into_line(), receiver: Receiver::new(), session, sequence, log }
    }

    /// Sends requests and returns the answers.
    pub fn script(&mut self, requests: &[Request]) -> Vec<Said> {
        self.converse(requests, 0)
    }

    /// The same, without waiting for the last answers.
    ///
    /// Keeps the firmware's buffer filled, so that the next request is always available.
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
            assert!(started.elapsed() < TIMEOUT, "silence after {said:?}");
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

    /// Report.
    pub fn report(&mut self) -> Report {
        match self.script(&[Request::Report])[..] {
            [Said::Report(report)] => report,
            ref other => panic!("{other:?}"),
        }
    }

    /// Acknowledges the latched fault, arms and stimulates for a while, then sends `then`. Returns
    /// the report before `then` and its answers.
    ///
    /// All in one script, because the time between two scripts is arbitrary.
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

    /// Waits until the pins settle. Pulses come every 10 ms of the machine's time, which may run
    /// slowly on a busy host.
    pub fn settled_pins(&self) -> Pins {
        let started = Instant::now();
        let mut pins = self.pins();
        loop {
            std::thread::sleep(STILL);
            let later = self.pins();
            if later == pins {
                return pins;
            }
            assert!(started.elapsed() < TIMEOUT, "it goes on: {pins:?}, {later:?}");
            pins = later;
        }
    }

    /// Levels of bridge and channel pins at the log's end, and the number of bridge closures.
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
            // The lower half sets, the upper half resets.
            *levels = (*levels | value & 0xffff) & !(value >> 16);
        }
        pins
    }
}

/// Levels and activity of pins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pins {
    /// A bit for each pin of the bridge.
    pub bridge: u32,
    /// A bit for each channel.
    pub channels: u32,
    /// Bridge closures.
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
