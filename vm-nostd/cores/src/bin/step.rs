//! The smallest program that builds muscles, steps them for ever, and saves and restores a state.
//! A test reads its image: no panic may be linked into it.
#![no_std]
#![no_main]

use core::hint::black_box;
use vm_nostd::{
    ContinuousMuscle, EffectiveLength, FesMuscle, Fixed, Input, IntramuscularFes, MotorUnits,
    Muscle, NaturalContinuous, NaturalDiscrete, Output, Recruitment, Scalar, State, TimeStep,
    UnitSizes,
};
use vm_nostd_cores::{Arithmetic, Inputs, MUSCLE, Record, Rig, Scenario};

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

/// A tick in fixed point as a separate function, whose callees are read from the image.
#[inline(never)]
fn step_continuous_fixed(
    muscle: &ContinuousMuscle<Fixed, 2>,
    state: &mut State<Fixed, NaturalContinuous, 2>,
    input: Input<Fixed>,
) -> Output<Fixed> {
    muscle.step(state, input)
}

/// A tick in fixed point as a separate function, whose callees are read from the image.
#[inline(never)]
fn step_fes_fixed(
    muscle: &FesMuscle<Fixed, 2>,
    state: &mut State<Fixed, IntramuscularFes, 2>,
    input: Input<Fixed>,
) -> Output<Fixed> {
    muscle.step(state, input)
}

/// A mode of motor units, the one with most state.
type Discrete = NaturalDiscrete<EffectiveLength, 8>;

/// A tick in fixed point as a separate function, whose callees are read from the image.
#[inline(never)]
fn step_discrete_fixed(
    muscle: &Muscle<Fixed, Discrete, 2>,
    state: &mut State<Fixed, Discrete, 2>,
    input: Input<Fixed>,
) -> Output<Fixed> {
    muscle.step(state, input)
}

/// Builds, rests, saves and restores a muscle.
fn muscle_at_rest<S: Arithmetic, R: Recruitment<S, 2>>(
    units: &R::Units,
) -> Option<(Muscle<S, R, 2>, State<S, R, 2>)> {
    let params = black_box(MUSCLE);
    let muscle = Muscle::<S, R, 2>::build_with_units(&params, units, TimeStep::MILLISECOND).ok()?;
    let state = muscle.rest(S::path_length(black_box(Scenario::RESTING_PATH).into())).ok()?;
    let mut words = [0; 128];
    words.iter_mut().zip(muscle.save(&state)).for_each(|(place, word)| *place = word);
    let length = State::<S, R, 2>::SAVED_WORDS;
    let state = muscle.restore(black_box(words).into_iter().take(length)).ok()?;
    Some((muscle, state))
}

fn run() -> Option<()> {
    let (continuous, mut continuous_state) = muscle_at_rest::<Fixed, NaturalContinuous>(&())?;
    let (fes, mut fes_state) = muscle_at_rest::<Fixed, IntramuscularFes>(&())?;
    let sizes = [UnitSizes::Default(3), UnitSizes::Listed(black_box(&[1.0, 2.0]))];
    let units = MotorUnits::new(&black_box(MUSCLE), sizes).ok()?;
    let (discrete, mut discrete_state) = muscle_at_rest::<Fixed, Discrete>(&units)?;
    muscle_at_rest::<f32, IntramuscularFes>(&())?;
    let (float, mut float_state) = muscle_at_rest::<f32, Discrete>(&units)?;
    let mut rig = Rig::<f32>::at_rest(black_box(Scenario::RESTING_PATH)).ok()?;
    loop {
        rig.tick(&mut Anything, &mut Anything);
        let [natural, stimulated] = Anything.inputs(0);
        black_box(step_continuous_fixed(&continuous, &mut continuous_state, natural));
        black_box(step_fes_fixed(&fes, &mut fes_state, stimulated));
        black_box(step_discrete_fixed(&discrete, &mut discrete_state, natural));
        let [natural, _] = Anything.inputs(0);
        black_box(float.step(&mut float_state, natural));
    }
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    run();
    wait()
}

#[panic_handler]
fn on_panic(_: &core::panic::PanicInfo<'_>) -> ! {
    wait()
}

/// Does nothing for good.
fn wait() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
