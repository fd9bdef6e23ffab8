//! The target: building the firmware's programs for it, and running them in QEMU.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The target triple of a Cortex-M4F.
pub const TRIPLE: &str = "thumbv7em-none-eabihf";
/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// The emulator's name of the board: an STM32F405.
pub const MACHINE: &str = "netduinoplus2";

/// Why the target is not to be had.
#[derive(Debug, thiserror::Error)]
pub enum TargetError {
    /// The library of the target is missing, and rustup did not add it.
    #[error("the library of {TRIPLE} is not installed (rustup target add {TRIPLE}): {0}")]
    NoLibrary(String),
    /// The firmware did not build.
    #[error("the firmware's program {program} does not build:\n{message}")]
    Build {
        /// Which program.
        program: String,
        /// What cargo said.
        message: String,
    },
    /// A program could not be started.
    #[error("{program}: {source}{}", hint(program))]
    Start {
        /// Which program.
        program: String,
        /// What the system said.
        source: std::io::Error,
    },
}

fn hint(program: &str) -> &'static str {
    if program == QEMU { " (apt-get install qemu-system-arm)" } else { "" }
}

/// The root of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Adds the target's library where rustup can, and says why it is missing where it is.
fn ensure_library() -> Result<(), TargetError> {
    // Without rustup the library may still be there.
    let added = Command::new("rustup").args(["target", "add", TRIPLE]).current_dir(root()).output();
    let folder = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", TRIPLE])
        .current_dir(root())
        .output()
        .map(|output| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()));
    if folder.is_ok_and(|folder| folder.is_dir()) {
        return Ok(());
    }
    Err(TargetError::NoLibrary(match added {
        Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        Err(error) => format!("rustup: {error}"),
    }))
}

/// Builds a program of the firmware and returns its image; `variables` are set for the build.
pub fn build(program: &str, variables: &[(&str, &Path)]) -> Result<PathBuf, TargetError> {
    ensure_library()?;
    // A folder of its own: the host's may be locked by the cargo that runs this.
    let folder = root().join("target/on-target");
    let output = Command::new(option_env!("CARGO").unwrap_or("cargo"))
        .args(["build", "--release", "--package", "firmware", "--features", "board"])
        .args(["--target", TRIPLE, "--bin", program, "--target-dir"])
        .arg(&folder)
        .envs(variables.iter().copied())
        .current_dir(root())
        .output()
        .map_err(|source| TargetError::Start { program: "cargo".to_owned(), source })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(TargetError::Build { program: program.to_owned(), message });
    }
    Ok(folder.join(TRIPLE).join("release").join(program))
}

/// QEMU as a machine with nothing connected but semihosting, about to run an image.
pub fn emulator(machine: &str, image: &Path) -> Command {
    let mut command = Command::new(QEMU);
    command
        .args(["-M", machine, "-display", "none", "-serial", "null", "-monitor", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(image)
        .stdin(Stdio::null());
    command
}

/// Why a command could not be started.
pub fn start_error(program: &str) -> impl FnOnce(std::io::Error) -> TargetError {
    move |source| TargetError::Start { program: program.to_owned(), source }
}
