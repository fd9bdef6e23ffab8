//! The smallest program that builds muscles, steps them for ever, and saves and restores a state.
//! A test reads its image: no panic may be linked into it.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use firmware::{Frame, Inputs, MUSCLE, Record, Rig, Scenario};
use vm_nostd::{FesMuscle, Input, IntramuscularFes, State, TimeStep};

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
    if let Ok(mut rig) = Rig::at_rest(black_box(Scenario::RESTING_PATH))
        && let Ok(muscle) = FesMuscle::<f32, 2>::build(&black_box(MUSCLE), TimeStep::MILLISECOND)
        && let Ok(state) = muscle.rest(black_box(Scenario::RESTING_PATH))
    {
        let mut words = [0; State::<f32, IntramuscularFes, 2>::WORDS];
        words.iter_mut().zip(state.words()).for_each(|(place, word)| *place = word);
        let _checked = black_box(muscle.restore(black_box(words)));
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
