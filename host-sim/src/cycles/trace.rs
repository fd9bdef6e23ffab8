//! The addresses of executed instructions, as QEMU runs an image.

use crate::target::{self, TargetError};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Why a program could not be traced.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The target or QEMU is not to be had.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// The plugin could not be built.
    #[error("the trace plugin does not build:\n{0}")]
    Plugin(String),
    /// The trace could not be read.
    #[error("the trace broke off: {0}")]
    Read(#[from] std::io::Error),
    /// The program failed.
    #[error("{} ended with {status} after {instructions} instructions: {message}", program.display())]
    Failed {
        /// Which program.
        program: PathBuf,
        /// How it ended.
        status: std::process::ExitStatus,
        /// How far it came.
        instructions: u64,
        /// What QEMU said.
        message: String,
    },
}

/// How long a program may go on for.
const PATIENCE: Duration = Duration::from_secs(1200);

/// Builds the plugin and returns its library.
fn plugin() -> Result<PathBuf, TraceError> {
    let folder = target::root().join("target/trace-plugin");
    let output = std::process::Command::new(option_env!("CARGO").unwrap_or("cargo"))
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

/// Runs an image to its end and passes on the address of every executed instruction; returns how
/// many there were.
pub fn execute(image: &Path, mut see: impl FnMut(u32)) -> Result<u64, TraceError> {
    let plugin = plugin()?;
    // QEMU's standard output is the trace: a pipe needs no file, however long it gets.
    let mut child = target::emulator(image)
        .arg("-plugin")
        .arg(format!("{},out=/dev/stdout", plugin.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(target::start_error(target::QEMU))?;
    let started = Instant::now();
    let mut instructions = 0;
    if let Some(mut pipe) = child.stdout.take() {
        let mut buffer = vec![0; 1 << 20];
        let mut held = 0;
        loop {
            let read = pipe.read(&mut buffer[held..])?;
            if read == 0 || started.elapsed() > PATIENCE {
                break;
            }
            held += read;
            let words = buffer[..held].chunks_exact(4);
            let rest = words.remainder().len();
            for word in words {
                if let Ok(word) = word.try_into() {
                    see(u32::from_le_bytes(word));
                    instructions += 1;
                }
            }
            buffer.copy_within(held - rest..held, 0);
            held = rest;
        }
    }
    // Closed or out of patience: either way there is nothing more to come.
    if started.elapsed() > PATIENCE {
        child.kill()?;
    }
    let output = child.wait_with_output()?;
    if !output.status.success() {
        return Err(TraceError::Failed {
            program: image.to_owned(),
            status: output.status,
            instructions,
            message: String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        });
    }
    Ok(instructions)
}
