//! The firmware on an emulated board, its USART a socket.

use crate::hil::{Client, HilError, PAUSE};
use crate::target::{self, QEMU, STIMULATOR, STM32F405};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A line to the firmware in QEMU, which ends with it.
#[derive(Debug)]
pub struct Emulated {
    stream: TcpStream,
    _machine: Machine,
}

/// Until the emulator is there.
const BOOT: Duration = Duration::from_secs(30);
/// An instruction takes 2^3 ns: with 168 MHz, 1.3 cycles. Time is that of the firmware alone, which while it waits
/// goes from tick to tick at once: whatever else the host does, a tick is as long as its instructions.
const INSTRUCTION_TIME: &str = "shift=3,sleep=off";

impl Emulated {
    /// Builds the firmware, and starts it.
    pub fn start() -> Result<Client<Self>, HilError> {
        let image = target::build(STM32F405, STIMULATOR, &[])?;
        Ok(Client::new(Self::run(&image, &[])?))
    }

    /// Starts an image, with more arguments for the emulator.
    pub fn run(image: &Path, arguments: &[String]) -> Result<Self, HilError> {
        let listener = TcpListener::bind(("127.0.0.1", 0))?;
        listener.set_nonblocking(true)?;
        let port = listener.local_addr()?.port();
        // Without `nodelay`, each answer waits for the host's acknowledgement of the one before.
        let serial = format!("tcp:127.0.0.1:{port},nodelay=on");
        let machine = std::process::Command::new(QEMU)
            .args(["-M", STM32F405.machine, "-display", "none", "-monitor", "none"])
            .args(["-icount", INSTRUCTION_TIME, "-serial", &serial])
            .args(arguments)
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .spawn()
            .map_err(target::start_error(QEMU))?;
        let mut machine = Machine(machine);
        let started = Instant::now();
        let stream = loop {
            match listener.accept() {
                Ok((stream, _)) => break stream,
                Err(_) if started.elapsed() < BOOT && machine.0.try_wait()?.is_none() => {
                    std::thread::sleep(Duration::from_millis(10));
                }
                Err(error) => return Err(error.into()),
            }
        };
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(PAUSE))?;
        Ok(Self { stream, _machine: machine })
    }
}

/// An emulator, which ends when nobody needs it.
#[derive(Debug)]
struct Machine(Child);

impl Drop for Machine {
    fn drop(&mut self) {
        let _gone = self.0.kill();
        let _reaped = self.0.wait();
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
