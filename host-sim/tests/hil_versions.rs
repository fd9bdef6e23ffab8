//! Different protocol versions are reported, whichever side detects them.

use firmware::link::{LinkError, Message, NO_SESSION, VERSION, encode};
use host_sim::hil::Client;
use std::io::{Error, ErrorKind, Read, Result, Write};

/// A device with a constant answer.
struct Says(Vec<u8>);

impl Read for Says {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        let length = self.0.len().min(bytes.len());
        bytes[..length].copy_from_slice(&self.0[..length]);
        self.0.drain(..length);
        if length > 0 { Ok(length) } else { Err(Error::from(ErrorKind::TimedOut)) }
    }
}

impl Write for Says {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

/// Frame of a message with another version.
fn of_version(version: u8, message: &Message<'_>) -> Vec<u8> {
    let mut frame = encode(NO_SESSION, 0, message).expect("a frame").to_vec();
    let length = cobs::decode_in_place(&mut frame).expect("a frame");
    let mut whole = frame[..length - 4].to_vec();
    whole[0] = version;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    digest.update(&NO_SESSION.to_le_bytes());
    digest.update(&whole);
    whole.extend(digest.finalize().to_le_bytes());
    let mut frame = vec![0; cobs::max_encoding_length(whole.len())];
    let length = cobs::encode(&whole, &mut frame);
    frame.truncate(length);
    frame.push(0);
    frame
}

#[test]
fn the_error_names_both_versions_and_the_remedy() {
    assert_eq!(VERSION, 4);
    for device in 1..VERSION {
        let expected = format!(
            "the device has version {device} of the link's protocol, this program version 4: \
             flash the firmware of this program's version"
        );
        // An older device answers in its own version, or reports the difference itself.
        let refusal = Message::NotActedUpon(LinkError::Version { got: VERSION, known: device });
        for said in [of_version(device, &refusal), of_version(VERSION, &refusal)] {
            let error = Client::new(Says(said)).greet().expect_err("another version");
            assert_eq!(error.to_string(), expected);
        }
    }
}
