//! The bench: drives what is measured through inputs that the host puts in, so that a trace of its
//! execution shows what each tick costs. It measures nothing itself.
//!
//! The inputs are little-endian words. Per run: a mask with a bit for each case, in the order of
//! `main`, that it is for; the number of its rows; then activation, path length and stimulation
//! frequency of each as `f32` bits. The first row is the muscle at rest.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use firmware::MUSCLE;
use literal_port::{Drive, LiteralMuscle, STABLE_STEPS, kernels_of_one_evaluation};
use vm_nostd::{
    ContinuousMuscle, FesMuscle, Input, IntramuscularFes, NaturalContinuous, Output,
    ParameterError, State, TimeStep,
};

static INPUTS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/bench_inputs.bin"));

// What is measured: one tick each.

#[inline(never)]
fn step_continuous_f32(
    muscle: &ContinuousMuscle<f32, 2>,
    state: &mut State<f32, NaturalContinuous, 2>,
    input: Input<f32>,
) -> Output<f32> {
    muscle.step(state, input)
}

#[inline(never)]
fn step_fes_f32(
    muscle: &FesMuscle<f32, 2>,
    state: &mut State<f32, IntramuscularFes, 2>,
    input: Input<f32>,
) -> Output<f32> {
    muscle.step(state, input)
}

/// A tick of the literal port, under a name of its own for each mode and precision.
macro_rules! literal {
    ($name:ident, $real:ty, $input:ident => $drive:expr) => {
        #[inline(never)]
        fn $name(muscle: &mut LiteralMuscle<$real>, $input: Input<f32>) -> $real {
            muscle.tick($drive, $input.path_length.into())
        }
    };
}
literal!(literal_continuous_f32, f32, input => Drive::Natural(input.activation));
literal!(literal_fes_f32, f32, input => {
    Drive::Fes(input.activation, input.stimulation_frequency)
});
literal!(literal_continuous_f64, f64, input => Drive::Natural(input.activation.into()));
literal!(literal_fes_f64, f64, input => {
    Drive::Fes(input.activation.into(), input.stimulation_frequency.into())
});

#[inline(never)]
fn kernels_f32(input: Input<f32>) -> f32 {
    kernels_of_one_evaluation(10.0 * input.path_length, input.activation, 1.0)
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

/// Drives a case through its runs: `rest` makes what is stepped, for a path length (m).
fn drive<M, O>(
    case: u32,
    rest: impl Fn(f32) -> Result<M, ParameterError>,
    tick: impl Fn(&mut M, Input<f32>) -> O,
) -> Result<(), ParameterError> {
    let mut words = Words(INPUTS);
    while let (Some(mask), Some(rows)) = (words.next(), words.next()) {
        let Some(first) = words.input() else { break };
        let wanted = mask & (1 << case) != 0;
        let mut subject = if wanted { Some(rest(first.path_length)?) } else { None };
        for _ in 1..rows {
            let Some(input) = words.input() else { break };
            if let Some(subject) = &mut subject {
                black_box(tick(black_box(subject), black_box(input)));
            }
        }
    }
    Ok(())
}

fn drive_all() -> Result<(), ParameterError> {
    let continuous = ContinuousMuscle::<f32, 2>::build(&MUSCLE, TimeStep::MILLISECOND)?;
    let fes = FesMuscle::<f32, 2>::build(&MUSCLE, TimeStep::MILLISECOND)?;
    drive(
        0,
        |path| continuous.rest(path),
        |state, input| step_continuous_f32(black_box(&continuous), state, input),
    )?;
    drive(1, |path| fes.rest(path), |state, input| step_fes_f32(black_box(&fes), state, input))?;
    literal(2, literal_continuous_f32)?;
    literal(3, literal_fes_f32)?;
    literal(4, literal_continuous_f64)?;
    literal(5, literal_fes_f64)?;
    drive(6, |_| Ok(()), |(), input| kernels_f32(input))
}

/// Drives a literal port.
fn literal<R: literal_port::Real + From<f32>>(
    case: u32,
    tick: fn(&mut LiteralMuscle<R>, Input<f32>) -> R,
) -> Result<(), ParameterError> {
    drive(case, |path| Ok(LiteralMuscle::at_rest(path.into(), STABLE_STEPS)), tick)
}

#[entry]
fn main() -> ! {
    let done = drive_all();
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
