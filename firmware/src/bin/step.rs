//! The smallest program that builds a muscle and steps it for ever. A test reads its image: no
//! panic may be linked into it.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use firmware::{Frame, Inputs, Record, Rig, Scenario};
use vm_nostd::Input;

/// Inputs and results that the optimiser can tell nothing about.
struct Anything;

impl Inputs for Anything {
    fn inputs(&mut self, tick: u32) -> [Input<f32>; 2] {
        black_box(Scenario).inputs(black_box(tick))
    }
}

impl Record for Anything {
    fn record(&mut self, frame: &Frame) {
        black_box(frame);
    }
}

#[entry]
fn main() -> ! {
    if let Ok(mut rig) = Rig::at_rest(black_box(Scenario::RESTING_PATH)) {
        loop {
            rig.tick(&mut Anything, &mut Anything);
        }
    }
    stop()
}

fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    stop()
}
