//! The bench: steps one muscle of each mode through inputs that the host puts in, so that a trace
//! of its execution shows what each tick costs. It measures nothing itself.
//!
//! The inputs are little-endian words: per run the number of its rows, then activation, path
//! length and stimulation frequency of each as `f32` bits; the first row is the muscle at rest.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use firmware::MUSCLE;
use vm_nostd::{
    ContinuousMuscle, FesMuscle, Input, IntramuscularFes, Muscle, NaturalContinuous, Output,
    ParameterError, Recruitment, State, TimeStep,
};

static INPUTS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/bench_inputs.bin"));

type Step<R> = fn(&Muscle<f32, R, 2>, &mut State<f32, R, 2>, Input<f32>) -> Output<f32>;

/// What is measured: one tick, the call included.
#[inline(never)]
fn step_continuous_f32(
    muscle: &ContinuousMuscle<f32, 2>,
    state: &mut State<f32, NaturalContinuous, 2>,
    input: Input<f32>,
) -> Output<f32> {
    muscle.step(state, input)
}

/// What is measured: one tick, the call included.
#[inline(never)]
fn step_fes_f32(
    muscle: &FesMuscle<f32, 2>,
    state: &mut State<f32, IntramuscularFes, 2>,
    input: Input<f32>,
) -> Output<f32> {
    muscle.step(state, input)
}

/// Takes words off the front of the inputs.
struct Words(&'static [u8]);

impl Words {
    fn next(&mut self) -> Option<u32> {
        let (word, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u32::from_le_bytes(*word))
    }

    fn input(&mut self) -> Option<Input<f32>> {
        Some(Input {
            activation: f32::from_bits(self.next()?),
            path_length: f32::from_bits(self.next()?),
            stimulation_frequency: f32::from_bits(self.next()?),
        })
    }
}

/// Steps a muscle through all runs.
fn drive<R: Recruitment<f32, 2>>(step: Step<R>) -> Result<(), ParameterError> {
    let muscle = Muscle::<f32, R, 2>::build(&MUSCLE, TimeStep::MILLISECOND)?;
    let mut words = Words(INPUTS);
    while let Some(rows) = words.next() {
        let Some(first) = words.input() else { break };
        let mut state = muscle.rest(first.path_length)?;
        for _ in 1..rows {
            let Some(input) = words.input() else { break };
            black_box(step(black_box(&muscle), black_box(&mut state), black_box(input)));
        }
    }
    Ok(())
}

#[entry]
fn main() -> ! {
    let done = drive(step_continuous_f32).and_then(|()| drive(step_fes_f32));
    debug::exit(if done.is_ok() { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    stop()
}

fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    debug::exit(debug::EXIT_FAILURE);
    stop()
}
