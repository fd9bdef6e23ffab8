//! Streams the addresses of executed instructions from QEMU.
//!
//! A plugin sends them over a socket. A QEMU built without plugin support writes them to its log as
//! text, a hundred times slower.

use super::core::Core;
use crate::output_file::temporary_folder;
use crate::target::{self, TargetError};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Why a program could not be traced.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The target toolchain or QEMU is missing.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The plugin could not be built.
    #[error("the trace plugin does not build:\n{0}")]
    Plugin(String),
    /// QEMU did not load the plugin.
    #[error("QEMU did not load the plugin: {0}")]
    Refused(String),
    /// The trace could not be read.
    #[error("reading the trace: {0}")]
    Read(#[from] std::io::Error),
    /// The program exceeded its timeout.
    #[error("{} is still running after {seconds} s (--timeout)", program.display())]
    Endless {
        /// The program.
        program: PathBuf,
        /// Timeout, s.
        seconds: u64,
    },
    /// The program failed.
    #[error("{} ended with {status} after {blocks} blocks: {message}", program.display())]
    Failed {
        /// The program.
        program: PathBuf,
        /// Exit status.
        status: std::process::ExitStatus,
        /// Number of executed blocks.
        blocks: u64,
        /// QEMU's standard error.
        message: String,
    },
}

/// Source of the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Tracer {
    /// The plugin; the log if QEMU does not load plugins.
    #[default]
    Auto,
    /// A plugin.
    Plugin,
    /// QEMU's execution log, a hundred times slower.
    Log,
}

/// A program to run in QEMU.
#[derive(Clone, Debug)]
pub struct Program<'a> {
    /// The image.
    pub image: &'a Path,
    /// QEMU machine name.
    pub machine: &'a str,
    /// The core whose timing is modelled.
    pub core: Core,
    /// Additional QEMU arguments.
    pub arguments: Vec<String>,
    /// Timeout.
    pub timeout: Duration,
}

impl<'a> Program<'a> {
    /// An image built for the board of a core.
    pub fn on_board(image: &'a Path, core: Core) -> Self {
        let machine = core.board().machine;
        Self { image, machine, core, arguments: Vec::new(), timeout: TIMEOUT }
    }
}

/// Consecutively executed instructions; only the last may branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Block {
    /// Address of the first.
    pub first: u32,
    /// Address of the last.
    pub last: u32,
}

/// Timeout of the bench.
const TIMEOUT: Duration = Duration::from_secs(1200);
/// Timeout until QEMU has loaded the plugin.
const START: Duration = Duration::from_secs(60);

/// Runs a program to its end and calls `see` with every executed block.
pub fn execute(
    program: &Program<'_>,
    tracer: Tracer,
    mut see: impl FnMut(Block),
) -> Result<(), TraceError> {
    match tracer {
        Tracer::Plugin => by_plugin(program, &mut see),
        Tracer::Log => by_log(program, &mut see),
        Tracer::Auto => match by_plugin(program, &mut see) {
            Err(TraceError::Refused(_)) => by_log(program, &mut see),
            result => result,
        },
    }
}

/// Builds the plugin and returns the path of its library.
fn plugin() -> Result<PathBuf, TraceError> {
    let folder = target::root().join("target/trace-plugin");
    let output = Command::new(option_env!("CARGO").unwrap_or("cargo"))
        .args(["build", "--release", "--package", "trace-plugin", "--target-dir"])
        .arg(&folder)
        .current_dir(target::root())
        .output()
        .map_err(target::start_error("cargo"))?;
    if !output.status.success() {
        return Err(TraceError::Plugin(String::from_utf8_lossy(&output.stderr).into_owned()));
    }
    let name =
        format!("{}trace_plugin{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(folder.join("release").join(name))
}

/// A run of QEMU, killed when dropped or at its timeout.
struct Run<'a> {
    program: &'a Program<'a>,
    child: Arc<Mutex<Child>>,
    watchdog: Watchdog,
    started: Instant,
    blocks: u64,
}

/// Kills a child at its timeout. A separate thread is needed: a sleeping program sends no blocks.
struct Watchdog {
    expired: Arc<AtomicBool>,
    /// Dropping it ends the waiting thread.
    _alive: mpsc::Sender<()>,
}

impl Watchdog {
    fn watch(child: &Arc<Mutex<Child>>, timeout: Duration) -> Self {
        let (alive, over) = mpsc::channel::<()>();
        let expired = Arc::new(AtomicBool::new(false));
        let (flag, child) = (Arc::clone(&expired), Arc::clone(child));
        thread::spawn(move || {
            if over.recv_timeout(timeout) == Err(RecvTimeoutError::Timeout) {
                flag.store(true, Ordering::SeqCst);
                let _already_gone = locked(&child).kill();
            }
        });
        Self { expired, _alive: alive }
    }
}

/// Locks the child, also if another thread panicked with the lock.
fn locked(child: &Mutex<Child>) -> MutexGuard<'_, Child> {
    child.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Drop for Run<'_> {
    fn drop(&mut self) {
        let mut child = locked(&self.child);
        let _already_gone = child.kill();
        let _already_waited_for = child.wait();
    }
}

impl<'a> Run<'a> {
    fn start(program: &'a Program<'a>, arguments: &[&str]) -> Result<Self, TraceError> {
        let child = target::emulator(program.machine, program.image)
            .args(&program.arguments)
            .args(arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(target::start_error(target::QEMU))?;
        let child = Arc::new(Mutex::new(child));
        let watchdog = Watchdog::watch(&child, program.timeout);
        Ok(Self { program, child, watchdog, started: Instant::now(), blocks: 0 })
    }

    /// Exit status; `None` while running.
    fn status(&self) -> std::io::Result<Option<ExitStatus>> {
        locked(&self.child).try_wait()
    }

    /// Waits for the end; fails unless the exit status is success.
    fn end(self, message: impl FnOnce() -> String) -> Result<(), TraceError> {
        let status = loop {
            match self.status()? {
                Some(status) => break status,
                None => thread::sleep(Duration::from_millis(1)),
            }
        };
        let program = self.program.image.to_owned();
        if self.watchdog.expired.load(Ordering::SeqCst) {
            return Err(TraceError::Endless { program, seconds: self.program.timeout.as_secs() });
        }
        if status.success() {
            return Ok(());
        }
        Err(TraceError::Failed { program, status, blocks: self.blocks, message: message() })
    }
}

/// Drains QEMU's standard error while it runs, so that its pipe does not fill up.
fn listen(child: &Mutex<Child>) -> JoinHandle<String> {
    let pipe = locked(child).stderr.take();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            // Output read before an error is still worth showing.
            let _broken = pipe.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).trim().to_owned()
    })
}

fn by_plugin(program: &Program<'_>, see: &mut impl FnMut(Block)) -> Result<(), TraceError> {
    let plugin = plugin()?;
    let folder = temporary_folder()?;
    let socket = folder.path().join("trace");
    let listener = UnixListener::bind(&socket)?;
    listener.set_nonblocking(true)?;
    let argument = format!("{},socket={}", plugin.display(), socket.display());
    let mut run = Run::start(program, &["-plugin", &argument])?;
    let said = listen(&run.child);
    let Some(mut stream) = accept(&listener, &run)? else {
        // QEMU may be running without the plugin.
        let _already_gone = locked(&run.child).kill();
        return Err(TraceError::Refused(said.join().unwrap_or_default()));
    };
    let mut buffer = vec![0; 1 << 20];
    let mut held = 0;
    loop {
        let read = stream.read(&mut buffer[held..])?;
        if read == 0 {
            break;
        }
        held += read;
        let blocks = buffer[..held].chunks_exact(8);
        let rest = blocks.remainder().len();
        for block in blocks {
            let address =
                |at: usize| u32::from_le_bytes(std::array::from_fn(|byte| block[at + byte]));
            run.blocks += 1;
            see(Block { first: address(0), last: address(4) });
        }
        buffer.copy_within(held - rest..held, 0);
        held = rest;
    }
    run.end(|| said.join().unwrap_or_default())
}

/// Accepts the plugin's connection; `None` if QEMU ends without one.
fn accept(listener: &UnixListener, run: &Run<'_>) -> Result<Option<UnixStream>, TraceError> {
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false)?;
                return Ok(Some(stream));
            }
            Err(error) if error.kind() != std::io::ErrorKind::WouldBlock => {
                return Err(error.into());
            }
            // The plugin of a very short run may have connected before QEMU ended.
            Err(_) if run.status()?.is_some() => match listener.accept() {
                Ok((stream, _)) => return Ok(Some(stream)),
                Err(_) => return Ok(None),
            },
            Err(_) if run.started.elapsed() > START => return Ok(None),
            Err(_) => thread::sleep(Duration::from_millis(5)),
        }
    }
}

/// QEMU arguments that log every instruction separately.
fn log_arguments() -> Result<&'static [&'static str], TraceError> {
    let output = Command::new(target::QEMU)
        .arg("--version")
        .output()
        .map_err(target::start_error(target::QEMU))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let version = text.split("version ").nth(1).unwrap_or("");
    let mut numbers = version.split('.').map(|number| number.parse::<u32>().unwrap_or(0));
    let version = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    // QEMU 8.1 replaced -singlestep.
    Ok(if version >= (8, 1) {
        &["-accel", "tcg,one-insn-per-tb=on", "-d", "exec,nochain"]
    } else {
        &["-singlestep", "-d", "exec,nochain"]
    })
}

fn by_log(program: &Program<'_>, see: &mut impl FnMut(Block)) -> Result<(), TraceError> {
    let mut run = Run::start(program, log_arguments()?)?;
    let mut said = Vec::new();
    let pipe = locked(&run.child).stderr.take();
    if let Some(pipe) = pipe {
        for line in BufReader::new(pipe).lines() {
            let line = line?;
            match logged_address(&line) {
                Some(address) => {
                    run.blocks += 1;
                    see(Block { first: address, last: address });
                }
                None => said.push(line),
            }
        }
    }
    run.end(|| said.join("\n"))
}

/// The address in a line such as `Trace 0: 0x7f1e04 [00000000/08000194/00000110/ff000000] main`.
fn logged_address(line: &str) -> Option<u32> {
    let (_, fields) = line.strip_prefix("Trace ")?.split_once('[')?;
    u32::from_str_radix(fields.split('/').nth(1)?, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_parsed_from_the_log() {
        let line = "Trace 0: 0x7ff1fc000100 [00000000/08000194/00000110/ff000200] reset";
        assert_eq!(logged_address(line), Some(0x0800_0194));
        assert_eq!(logged_address("qemu-system-arm: no such file"), None);
    }
}
