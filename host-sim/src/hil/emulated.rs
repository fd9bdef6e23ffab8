//! The firmware in QEMU, with its USART as a socket.

use crate::hil::{Client, HilError, PAUSE};
use crate::target::{self, QEMU, STIMULATOR, STM32F405};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// A line to the firmware in QEMU; dropping it ends QEMU.
#[derive(Debug)]
pub struct Emulated {
    stream: TcpStream,
    _machine: Machine,
}

/// Longest start of QEMU.
const BOOT: Duration = Duration::from_secs(30);
/// An instruction takes 2^3 ns (1.3 cycles at 168 MHz). Emulated time depends on instructions alone
/// and skips waits, so that the load of the host does not delay a tick.
const INSTRUCTION_TIME: &str = "shift=3,sleep=off";

impl Emulated {
    /// Builds and starts the firmware.
    pub fn start() -> Result<Client<Self>, HilError> {
        let image = target::build(STM32F405, STIMULATOR, &[])?;
        Ok(Client::new(Self::run(&image, &[])?))
    }

    /// Starts an image, with additional arguments for QEMU.
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

/// A QEMU process that ends when dropped.
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
