//! The firmware on an emulated board, its USART a socket.

use crate::hil::{Client, HilError, PAUSE};
use crate::target::{self, QEMU, STM32F405};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A line to the firmware in QEMU, which ends with it.
#[derive(Debug)]
pub struct Emulated {
    stream: TcpStream,
    machine: Child,
}

/// Until the emulator is there.
const BOOT: Duration = Duration::from_secs(30);
/// An instruction takes 2^3 ns: with 168 MHz, 1.3 cycles. Ticks then take as long as they have instructions,
/// whatever else the host does.
const INSTRUCTION_TIME: &str = "shift=3";

impl Emulated {
    /// Builds the firmware, and starts it.
    pub fn start() -> Result<Client<Self>, HilError> {
        let image = target::build(STM32F405, "firmware", &[])?;
        let listener = TcpListener::bind(("127.0.0.1", 0))?;
        listener.set_nonblocking(true)?;
        let port = listener.local_addr()?.port();
        let mut machine = std::process::Command::new(QEMU)
            .args(["-M", STM32F405.machine, "-display", "none", "-monitor", "none"])
            .args(["-icount", INSTRUCTION_TIME, "-serial", &format!("tcp:127.0.0.1:{port}")])
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .spawn()
            .map_err(target::start_error(QEMU))?;
        let started = Instant::now();
        let stream = loop {
            match listener.accept() {
                Ok((stream, _)) => break stream,
                Err(_) if started.elapsed() < BOOT && machine.try_wait()?.is_none() => {
                    std::thread::sleep(Duration::from_millis(10));
                }
                Err(error) => {
                    let _gone = machine.kill();
                    return Err(error.into());
                }
            }
        };
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PAUSE))?;
        Ok(Client::new(Self { stream, machine }))
    }
}

impl Drop for Emulated {
    fn drop(&mut self) {
        let _gone = self.machine.kill();
        let _reaped = self.machine.wait();
    }
}

impl Read for Emulated {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        self.stream.read(bytes)
    }
}

impl Write for Emulated {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}
