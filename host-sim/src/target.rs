//! Builds programs for a core, the stimulator or those of `vm-nostd/cores`, and runs them in QEMU.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// An emulated board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// QEMU machine name.
    pub machine: &'static str,
    /// The target triple of its core.
    pub triple: &'static str,
    /// The core that the compiler schedules for; `None`: as `.cargo/config.toml` says.
    pub core: Option<&'static str>,
}

impl Board {
    const fn new(machine: &'static str, triple: &'static str) -> Self {
        Self { machine, triple, core: None }
    }
}

/// STM32F405, a Cortex-M4F: the board of the firmware.
pub const STM32F405: Board = Board::new("netduinoplus2", "thumbv7em-none-eabihf");
/// Arm's MPS2 board with a Cortex-M3: no floating-point unit.
pub const CORTEX_M3: Board = Board::new("mps2-an385", "thumbv7m-none-eabi");
/// nRF51, a Cortex-M0: no floating-point unit and no long multiplication.
pub const CORTEX_M0: Board = Board::new("microbit", "thumbv6m-none-eabi");
/// Arm's MPS2 board with a Cortex-M7.
pub const CORTEX_M7: Board =
    Board { core: Some("cortex-m7"), ..Board::new("mps2-an500", "thumbv7em-none-eabihf") };
/// Arm's MPS2 board with a Cortex-M33.
pub const CORTEX_M33: Board =
    Board { core: Some("cortex-m33"), ..Board::new("mps2-an505", "thumbv8m.main-none-eabihf") };
/// The stimulator's program.
pub const STIMULATOR: &str = "firmware";
/// The program that `vm cycles` measures.
pub const BENCH: &str = "bench";
/// The emulator.
pub const QEMU: &str = "qemu-system-arm";

/// Why the target could not be used.
#[derive(Debug, thiserror::Error)]
pub enum TargetError {
    /// The target's library is missing and rustup could not add it.
    #[error("target {triple} is not installed (rustup target add {triple}): {message}")]
    NoLibrary {
        /// Which target.
        triple: &'static str,
        /// Error of rustup.
        message: String,
    },
    /// The program did not build.
    #[error("the program {program} does not build:\n{message}")]
    Build {
        /// Which program.
        program: String,
        /// Error of cargo.
        message: String,
    },
    /// A program could not be started.
    #[error("{program}: {source}{}", hint(program))]
    Start {
        /// Which program.
        program: String,
        /// The system's error.
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

/// Adds the target's library with rustup; an error if that fails and it is missing.
fn ensure_library(triple: &'static str) -> Result<(), TargetError> {
    // Without rustup the library may be installed in another way.
    let added = Command::new("rustup").args(["target", "add", triple]).current_dir(root()).output();
    let folder = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", triple])
        .current_dir(root())
        .output()
        .map(|output| PathBuf::from(String::from_utf8_lossy(&output.stdout).trim()));
    if folder.is_ok_and(|folder| folder.is_dir()) {
        return Ok(());
    }
    let message = match added {
        Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_owned(),
        Err(error) => format!("rustup: {error}"),
    };
    Err(TargetError::NoLibrary { triple, message })
}

/// Builds a program for a board and returns its image. `variables` are set in the
/// build's environment.
pub fn build(
    board: Board,
    program: &str,
    variables: &[(&str, &Path)],
) -> Result<PathBuf, TargetError> {
    let triple = board.triple;
    ensure_library(triple)?;
    let (package, feature) = match program {
        STIMULATOR => (program, "board-stm32f405"),
        BENCH => ("vm-nostd-cores", "bench"),
        _ => ("vm-nostd-cores", "core"),
    };
    // Apart from the host's, which a running cargo may lock; boards differ in their memories.
    let folder = root().join("target/on-target").join(board.machine);
    let flags = board.core.map(|core| {
        let triple = triple.to_uppercase().replace(['-', '.'], "_");
        (format!("CARGO_TARGET_{triple}_RUSTFLAGS"), format!("-Ctarget-cpu={core}"))
    });
    let output = Command::new(option_env!("CARGO").unwrap_or("cargo"))
        .args(["build", "--release", "--package", package, "--features", feature])
        .args(["--target", triple, "--bin", program, "--target-dir"])
        .arg(&folder)
        .envs(variables.iter().copied())
        .envs(flags)
        .env("VM_MACHINE", board.machine)
        // Incremental builds inline less: cycles would depend on the caller's environment.
        .env("CARGO_INCREMENTAL", "0")
        .current_dir(root())
        .output()
        .map_err(|source| TargetError::Start { program: "cargo".to_owned(), source })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        return Err(TargetError::Build { program: program.to_owned(), message });
    }
    Ok(folder.join(triple).join("release").join(program))
}

/// QEMU command that runs an image with semihosting and nothing else connected.
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
