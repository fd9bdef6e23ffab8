//! A GDB remote protocol client for QEMU: reads and writes memory of a stopped machine.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

/// TCP port of a debugger.
pub struct Port(u16);

impl Port {
    /// A free port.
    pub fn free() -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
        Self(listener.local_addr().expect("an address").port())
    }

    /// Arguments for QEMU.
    pub fn arguments(&self) -> Vec<String> {
        vec!["-gdb".to_owned(), format!("tcp:127.0.0.1:{},nodelay=on", self.0)]
    }

    /// Attaches, which stops the machine.
    pub fn attach(&self) -> Debugger {
        self.attached(TcpStream::connect(("127.0.0.1", self.0)).expect("an emulator"))
    }

    /// Attaches as soon as the machine runs.
    pub fn wait_and_attach(&self) -> Debugger {
        for _ in 0..300 {
            if let Ok(stream) = TcpStream::connect(("127.0.0.1", self.0)) {
                return self.attached(stream);
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("no emulator")
    }

    fn attached(&self, stream: TcpStream) -> Debugger {
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
        Debugger(stream)
    }
}

/// A debugger attached to a stopped machine.
pub struct Debugger(TcpStream);

/// Maximum packet size, bytes.
const CHUNK: usize = 512;

impl Debugger {
    /// Continues execution.
    pub fn resume(&mut self) {
        self.send("c");
    }

    /// Stops execution.
    pub fn stop(&mut self) {
        self.0.write_all(&[0x03]).expect("a line");
        while !self.packet().starts_with('T') {}
    }

    /// Reads memory of the stopped machine.
    pub fn read(&mut self, address: u64, length: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        while bytes.len() < length {
            let part = CHUNK.min(length - bytes.len());
            self.send(&format!("m{:x},{part:x}", address + bytes.len() as u64));
            let reply = self.reply();
            assert_eq!(reply.len(), 2 * part, "{reply}");
            bytes.extend(
                (0..part).map(|at| {
                    u8::from_str_radix(&reply[2 * at..2 * at + 2], 16).expect("two digits")
                }),
            );
        }
        bytes
    }

    /// Writes memory of the stopped machine, flash as well.
    pub fn write(&mut self, address: u64, bytes: &[u8]) {
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        self.send(&format!("M{address:x},{:x}:{digits}", bytes.len()));
        assert_eq!(self.reply(), "OK");
    }

    fn send(&mut self, command: &str) {
        let sum = command.bytes().fold(0_u8, u8::wrapping_add);
        write!(self.0, "${command}#{sum:02x}").expect("a line");
    }

    /// Answer to a command, skipping stop notices.
    fn reply(&mut self) -> String {
        loop {
            let packet = self.packet();
            if !packet.starts_with('T') {
                return packet;
            }
        }
    }

    /// Next packet, acknowledged.
    fn packet(&mut self) -> String {
        let mut byte = [0];
        let mut next = || {
            self.0.read_exact(&mut byte).expect("a packet");
            byte[0]
        };
        while next() != b'$' {}
        let mut text = Vec::new();
        loop {
            match next() {
                b'#' => break,
                other => text.push(other),
            }
        }
        next();
        next();
        self.0.write_all(b"+").expect("a line");
        String::from_utf8(text).expect("a text")
    }
}
