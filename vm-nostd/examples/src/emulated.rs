//! What the two smallest programs with a muscle share: they step it in an emulator and write the
//! bits of every output to the host.

#[path = "emulated/inputs.rs"]
mod inputs;

pub use inputs::{Integers, TICKS, at};

use semihosting::io::{Write, stdout};
use semihosting::process::ExitCode;
use vm_nostd::{FesMuscle, Input, Scalar, WordsError};

/// Steps a muscle from words through all inputs. Each tick writes force, length, velocity, relative
/// force and flags. Exit code 0 if all were written.
pub fn run<S: Scalar<Bits = u32>>(
    muscle: Result<FesMuscle<S, 2>, WordsError>,
    input: fn(Integers) -> Input<S>,
) -> ! {
    let stepped = || {
        let muscle = muscle.ok()?;
        let mut state = muscle.rest_in_range(input(at(0)).path_length)?;
        let mut host = stdout().ok()?;
        for tick in 0..TICKS {
            let output = muscle.step(&mut state, input(at(tick)));
            let words = [
                S::force_bits(output.force),
                output.fascicle_length.to_bits(),
                output.fascicle_velocity.to_bits(),
                output.relative_force.to_bits(),
                output.status.bits().into(),
            ];
            for word in words {
                host.write_all(&word.to_le_bytes()).ok()?;
            }
        }
        Some(())
    };
    let code = if stepped().is_some() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    code.exit_process()
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    ExitCode::FAILURE.exit_process()
}
