//! The rig run through the scenario as fast as the core can, first in fixed point, then in `f32`;
//! the bits of every tick go to the emulator's standard output as little-endian words. 16 KiB of
//! RAM are enough.
#![no_std]
#![no_main]

use semihosting::io::{Stdout, Write, stdout};
use semihosting::process::ExitCode;
use vm_nostd::Fixed;
use vm_nostd_cores::{Arithmetic, Record, Rig, Scenario, TICKS};

/// Words that go to the host at once.
const CHUNK: usize = 64;

/// Sends words to the host.
struct Outlet {
    host: Stdout,
    failed: bool,
}

impl Record for Outlet {
    fn record(&mut self, mut words: impl Iterator<Item = u32>) {
        let mut bytes = [0; 4 * CHUNK];
        loop {
            let mut length = 0;
            for (place, word) in bytes.chunks_exact_mut(4).zip(&mut words) {
                place.copy_from_slice(&word.to_le_bytes());
                length += 4;
            }
            let Some(sent) = bytes.get(..length).filter(|sent| !sent.is_empty()) else { return };
            self.failed |= self.host.write_all(sent).is_err();
        }
    }
}

fn run<S: Arithmetic>(outlet: &mut Outlet) -> bool {
    let Ok(mut rig) = Rig::<S>::at_rest(Scenario::RESTING_PATH) else { return false };
    for _ in 0..TICKS {
        rig.tick(&mut Scenario, outlet);
    }
    !outlet.failed
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let done = stdout().is_ok_and(|host| {
        let mut outlet = Outlet { host, failed: false };
        run::<Fixed>(&mut outlet) && run::<f32>(&mut outlet)
    });
    let code = if done { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    code.exit_process()
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    ExitCode::FAILURE.exit_process()
}
