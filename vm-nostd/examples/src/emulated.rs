//! What the two smallest programs with a muscle share: they step it in an emulator and write the
//! bits of every output to the host.

#[path = "emulated/inputs.rs"]
mod inputs;

pub use inputs::{Integers, TICKS, at};

use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hio::hstdout;
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
        let mut host = hstdout().ok()?;
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
    end(if stepped().is_some() { EXIT_SUCCESS } else { EXIT_FAILURE })
}

fn end(status: cortex_m_semihosting::debug::ExitStatus) -> ! {
    loop {
        exit(status);
    }
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end(EXIT_FAILURE)
}
