//! Test rig: two muscles stepped by one tick.

use vm_nostd::{
    Class, ContinuousMuscle, FesMuscle, FiberParams, Input, IntramuscularFes, MuscleParams,
    NaturalContinuous, Output, ParameterError, Scalar, State, TimeStep, paper_table_1,
};

/// Fibre types of each muscle.
const TYPES: usize = 2;
/// Words of a muscle's output: force, length, velocity, status.
const OUTPUT_WORDS: usize = 4;

/// An arithmetic of 32-bit words.
pub trait Arithmetic: Scalar<Bits = u32> {}
impl<S: Scalar<Bits = u32>> Arithmetic for S {}

/// Recorded words per tick.
pub const fn frame_words<S: Arithmetic>() -> usize {
    2 * (State::<S, NaturalContinuous, TYPES>::WORDS + OUTPUT_WORDS)
}

/// Source of inputs.
pub trait Inputs<S: Scalar> {
    /// Inputs of the continuous and of the FES muscle for a tick, counted from 0.
    fn inputs(&mut self, tick: u32) -> [Input<S>; 2];
}

/// Sink of results.
pub trait Record {
    /// Takes the [`frame_words`] words of a tick: state and output of the continuous muscle, then
    /// of the FES muscle. Must not block.
    fn record(&mut self, words: impl Iterator<Item = u32>);
}

/// Two of the paper's muscles, one with natural recruitment and one under intramuscular FES.
#[derive(Clone, Debug)]
pub struct Rig<S: Arithmetic> {
    continuous: ContinuousMuscle<S, TYPES>,
    continuous_state: State<S, NaturalContinuous, TYPES>,
    fes: FesMuscle<S, TYPES>,
    fes_state: State<S, IntramuscularFes, TYPES>,
    tick: u32,
}

/// The paper's validation muscle, "deltoid posterior".
pub const MUSCLE: MuscleParams<TYPES> = MuscleParams {
    mass: 97.5e-3,
    fascicle_length: 0.11,
    tendon_length: 0.02,
    max_path_length: 0.184,
    recruitment_saturation: 0.8,
    class: Class::Standard,
    elements: paper_table_1::ELEMENTS,
    fibers: [
        FiberParams { fraction: 0.6, fiber_type: paper_table_1::SLOW },
        FiberParams { fraction: 0.4, fiber_type: paper_table_1::FAST },
    ],
};

impl<S: Arithmetic> Rig<S> {
    /// Both muscles at rest on a path of `path_length` m, for ticks of 1 ms.
    pub fn at_rest(path_length: f32) -> Result<Self, ParameterError> {
        let continuous = ContinuousMuscle::build(&MUSCLE, TimeStep::MILLISECOND)?;
        let fes = FesMuscle::build(&MUSCLE, TimeStep::MILLISECOND)?;
        let path_length = S::path_length(path_length.into());
        Ok(Self {
            continuous_state: continuous.rest(path_length)?,
            continuous,
            fes_state: fes.rest(path_length)?,
            fes,
            tick: 0,
        })
    }

    /// Ticks done so far.
    pub fn ticks(&self) -> u32 {
        self.tick
    }

    /// One tick: reads inputs, steps both muscles, records state and output.
    ///
    /// Bounded, without waiting. Call it every millisecond.
    pub fn tick(&mut self, inputs: &mut impl Inputs<S>, record: &mut impl Record) {
        let [continuous, fes] = inputs.inputs(self.tick);
        let continuous = self.continuous.step(&mut self.continuous_state, continuous);
        let fes = self.fes.step(&mut self.fes_state, fes);
        self.tick = self.tick.wrapping_add(1);
        record.record(
            self.continuous_state
                .words()
                .chain(output_words(&continuous))
                .chain(self.fes_state.words())
                .chain(output_words(&fes)),
        );
    }
}

fn output_words<S: Arithmetic>(output: &Output<S>) -> [u32; OUTPUT_WORDS] {
    [
        S::force_bits(output.force),
        output.fascicle_length.to_bits(),
        output.fascicle_velocity.to_bits(),
        u32::from(output.status.bits()),
    ]
}
