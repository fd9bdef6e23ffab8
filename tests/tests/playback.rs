//! A trace played over the link by the client of `vm hil`, to the whole firmware without its chip.

use firmware::link::{Answer, Message, NO_SESSION, Receiver, Request, SessionNumber, encode};
use host_sim::engine::Class;
use host_sim::hil::{self, Client, HilError};
use host_sim::reference::Mode;
use host_sim::{muscle_file, trace};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use stimulator_tests::device::{InProcess, Memory};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/data").join(name)
}

/// A trace of the authors' program, played to the firmware: bits equal to the host's own run.
#[test]
fn a_trace_played_over_the_link_has_the_hosts_bits() {
    let muscle =
        muscle_file::read(&data("muscles/deltoid_posterior.toml")).expect("a muscle").muscle;
    for (vector, mode, class) in [
        ("fes_steps", Mode::Fes, Class::Standard),
        ("continuous_length_3hz", Mode::Continuous, Class::Standard),
        ("continuous_length_3hz", Mode::Continuous, Class::Economy),
        ("continuous_length_3hz", Mode::Continuous, Class::Fine),
    ] {
        let trace = trace::read_inputs(&data(&format!("vectors/{vector}.csv"))).expect("inputs");
        let mut host = Client::new(InProcess::boot(Memory::new()));
        let played =
            hil::play(&mut host, &muscle, class, mode, &trace, &mut |_| ()).expect("equal bits");
        assert_eq!(played.rows.len(), trace.inputs.len());
        assert_eq!(played.report.rows as usize, trace.inputs.len() - 1);
        assert_eq!(played.report.frames.broken + played.report.frames.refused, 0);
        // Without arming no current flows.
        assert_eq!(host.line().flowed(), 0);
    }
}

/// The comparison fails for a device with another muscle.
#[test]
fn another_muscle_is_detected_by_its_bits() {
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
            // Changes the mass of an upload, in a valid frame.
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
    let played = hil::play(&mut host, &muscle, Class::Standard, Mode::Fes, &trace, &mut |_| ());
    assert!(matches!(played, Err(HilError::Differs(_))), "{played:?}");
}
