//! The smallest program that builds muscles, steps them for ever, and saves and restores a state.
//! A test reads its image: no panic may be linked into it.
#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use firmware::{Arithmetic, Inputs, MUSCLE, Record, Rig, Scenario, end};
use vm_nostd::{
    ContinuousMuscle, FesMuscle, Fixed, Input, IntramuscularFes, Muscle, NaturalContinuous, Output,
    Recruitment, Scalar, State, TimeStep,
};

/// Inputs and results that the optimiser can tell nothing about.
struct Anything;

impl<S: Scalar> Inputs<S> for Anything {
    fn inputs(&mut self, tick: u32) -> [Input<S>; 2] {
        black_box(Scenario).inputs(black_box(tick))
    }
}

impl Record for Anything {
    fn record(&mut self, words: impl Iterator<Item = u32>) {
        words.for_each(|word| {
            black_box(word);
        });
    }
}

/// A tick in fixed point, by itself: what it calls is read from the image.
#[inline(never)]
fn step_continuous_fixed(
    muscle: &ContinuousMuscle<Fixed, 2>,
    state: &mut State<Fixed, NaturalContinuous, 2>,
    input: Input<Fixed>,
) -> Output<Fixed> {
    muscle.step(state, input)
}

/// A tick in fixed point, by itself: what it calls is read from the image.
#[inline(never)]
fn step_fes_fixed(
    muscle: &FesMuscle<Fixed, 2>,
    state: &mut State<Fixed, IntramuscularFes, 2>,
    input: Input<Fixed>,
) -> Output<Fixed> {
    muscle.step(state, input)
}

/// Builds, rests, saves and restores a muscle.
fn muscle_at_rest<S: Arithmetic, R: Recruitment<S, 2>>() -> Option<(Muscle<S, R, 2>, State<S, R, 2>)>
{
    let muscle = Muscle::<S, R, 2>::build(&black_box(MUSCLE), TimeStep::MILLISECOND).ok()?;
    let state = muscle.rest(S::path_length(black_box(Scenario::RESTING_PATH).into())).ok()?;
    let mut words = [0; 32];
    words.iter_mut().zip(state.words()).for_each(|(place, word)| *place = word);
    let length = State::<S, R, 2>::WORDS;
    let state = muscle.restore(black_box(words).into_iter().take(length)).ok()?;
    Some((muscle, state))
}

fn run() -> Option<()> {
    let (continuous, mut continuous_state) = muscle_at_rest::<Fixed, NaturalContinuous>()?;
    let (fes, mut fes_state) = muscle_at_rest::<Fixed, IntramuscularFes>()?;
    muscle_at_rest::<f32, IntramuscularFes>()?;
    let mut rig = Rig::<f32>::at_rest(black_box(Scenario::RESTING_PATH)).ok()?;
    loop {
        rig.tick(&mut Anything, &mut Anything);
        let [natural, stimulated] = Anything.inputs(0);
        black_box(step_continuous_fixed(&continuous, &mut continuous_state, natural));
        black_box(step_fes_fixed(&fes, &mut fes_state, stimulated));
    }
}

#[entry]
fn main() -> ! {
    run();
    end::sleep()
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end::sleep()
}
