//! The smallest program with an FES muscle, on a Cortex-M4F: its words are in flash, and nothing is
//! built on the part.
#![no_std]
#![no_main]

#[path = "../emulated.rs"]
mod emulated;

use emulated::Integers;
use vm_nostd::Input;

fn input(integers: Integers) -> Input<f32> {
    Input {
        activation: f32::from(integers.activation) * 1e-3,
        path_length: integers.path_length as f32 * 1e-6,
        stimulation_frequency: f32::from(integers.stimulation_frequency) * 0.1,
    }
}

include!("../emulated/deltoid_f32.rs");

#[cortex_m_rt::entry]
fn main() -> ! {
    emulated::run(deltoid_posterior_fes_f32(), input)
}
