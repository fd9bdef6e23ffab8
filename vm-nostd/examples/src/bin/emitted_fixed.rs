//! The smallest program with an FES muscle in fixed point: its words are in flash, and nothing is
//! built on the part.
#![no_std]
#![no_main]

#[path = "../emulated.rs"]
mod emulated;

use emulated::Integers;
use vm_nostd::{Fixed, Input};

fn input(integers: Integers) -> Input<Fixed> {
    let Integers { activation, path_length, stimulation_frequency } = integers;
    Input::<Fixed>::from_integers(activation, path_length, stimulation_frequency)
}

include!("../emulated/deltoid_fixed.rs");

#[cortex_m_rt::entry]
fn main() -> ! {
    emulated::run(deltoid_posterior_fes_fixed(), input)
}
