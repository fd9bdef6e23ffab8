//! The loop of `vm hil --loop`: the host's bits from the whole firmware without its chip, and from
//! the image in QEMU.

use firmware::link::{Answer, Message, NO_SESSION, Receiver, Request, SessionNumber, encode};
use host_sim::closed_loop::{Kind, Patient, Task, Trial};
use host_sim::hil::{self, Client, Emulated, HilError};
use std::io::{Read, Write};
use stimulator_tests::device::{InProcess, Memory};
use system_tests::machine::image;

/// Two tasks on one patient each: the bits of every step, and the score of the host's own loop but
/// for angles that the link rounds to 1 µrad.
#[test]
fn the_loop_closed_over_the_link_has_the_hosts_bits() {
    for (task, patient) in [(Task::DropFoot, 0), (Task::ElbowReach, 3)] {
        let mut host = Client::new(InProcess::boot(Memory::new()));
        let looped = hil::close(&mut host, task, patient, &mut |_| ()).expect("equal bits");
        assert_eq!(f64::from(looped.steps), task.duration(false) * 1e3);
        // Nothing flows: it is disarmed.
        assert_eq!(host.line().flowed(), 0);
        let (patient, settings) = (Patient::scored(task, patient), Kind::Model.untuned());
        let trial = Trial {
            task,
            patient: &patient,
            kind: Kind::Model,
            settings: &settings,
            tuning: false,
        };
        let own = trial.run(|_| ()).expect("a run");
        let difference = (looped.score.rms - own.rms).abs();
        assert!(difference < 0.1 * own.rms, "{task:?}: {} and {}", looped.score.rms, own.rms);
        assert!(!looped.score.limit_broken);
    }
}

/// A line that makes another controller of the one that is uploaded.
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
        let mut receiver = Receiver::new();
        for &byte in bytes {
            if let Some(Ok(frame)) = receiver.push(byte, self.session)
                && let Ok(Request::Control(Some(mut control))) = postcard::from_bytes(frame.content)
            {
                control.limb.gravity *= 1.000_01;
                let request = Request::Control(Some(control));
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

#[test]
fn another_controller_is_detected_by_its_bits() {
    let device = InProcess::boot(Memory::new());
    let tampered = Tampered { device, answers: Receiver::new(), session: NO_SESSION };
    let closed = hil::close(&mut Client::new(tampered), Task::DropFoot, 0, &mut |_| ());
    let Err(HilError::Differs(message)) = closed else { panic!("{closed:?}") };
    assert!(message.starts_with("step 0: the device has Commanded {"), "{message}");
}

#[test]
fn the_loop_closed_over_the_emulated_chip_has_the_hosts_bits() {
    let Some(image) = image() else { return };
    let mut client = Client::new(Emulated::run(&image, &[]).expect("a machine"));
    let looped = hil::close(&mut client, Task::DropFoot, 1, &mut |_| ()).expect("equal bits");
    assert_eq!(looped.steps, 8_750);
    assert_eq!((looped.report.late, looped.report.frames.broken), (0, 0));
    assert!((10..=150).contains(&looped.report.longest_us), "{} us", looped.report.longest_us);
}
