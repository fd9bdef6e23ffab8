//! Hardware in the loop: a muscle runs on a device over the link; its bits are compared with the
//! host's.

mod client;
mod closed_loop;
mod emulated;
mod playback;

pub use client::{Client, HilError, Line};
pub use closed_loop::{Looped, close};
pub use emulated::Emulated;
pub use playback::{Played, play};

use std::time::Duration;

/// Read timeout of a line.
pub(crate) const PAUSE: Duration = Duration::from_millis(100);

/// A serial port.
pub fn serial(port: &str, baud: u32) -> Result<Client<Box<dyn serialport::SerialPort>>, HilError> {
    let line = serialport::new(port, baud)
        .timeout(PAUSE)
        .open()
        .map_err(|error| HilError::Port { port: port.to_owned(), message: error.to_string() })?;
    Ok(Client::new(line))
}
