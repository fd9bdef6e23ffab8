//! A muscle of `vm-nostd` that is being run, with its fatigue.

use super::running::{Row, RunError, Running};
use crate::reference::{Input, Sample};
use std::sync::Arc;
use vm_nostd as vm;

/// A muscle of `vm-nostd` and its state.
pub(super) struct Stepped<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize> {
    pub(super) muscle: Arc<vm::Muscle<S, R, N>>,
    pub(super) state: vm::State<S, R, N>,
    pub(super) fatiguing: Option<Fatiguing<S>>,
    /// Static stiffness in F0/L_ce0, in the modes that have one.
    pub(super) slope: Option<Slope<S, R, N>>,
    /// N.
    pub(super) f0: f64,
    /// N/m.
    pub(super) f0_per_length: f64,
}

/// [`vm::Muscle::stiffness`].
pub(super) type Slope<S, R, const N: usize> = fn(&vm::Muscle<S, R, N>, &vm::State<S, R, N>) -> S;

/// Fatigue of a muscle.
#[derive(Clone, Copy)]
pub(super) struct Fatiguing<S: vm::Scalar> {
    pub(super) fatigue: vm::Fatigue<S>,
    pub(super) state: vm::FatigueState<S>,
    /// Under FES: depends on the stimulation frequency.
    pub(super) stimulated: bool,
}

/// Natural firing fatigues like stimulation at this frequency, pps.
const NATURAL: f64 = 100.0;

impl<S: vm::Scalar> Fatiguing<S> {
    fn advance(&mut self, input: vm::Input<S>) -> S {
        let natural = S::quantity(NATURAL);
        let frequency = if self.stimulated { input.stimulation_frequency } else { natural };
        self.fatigue.advance(&mut self.state, input.activation, frequency)
    }
}

impl<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize> Running for Stepped<S, R, N> {
    fn row(&self) -> Row {
        let output = self.muscle.observe(&self.state);
        let output = match &self.fatiguing {
            Some(fatiguing) => output.fatigued(fatiguing.state.fitness()),
            None => output,
        };
        row(output, self.f0)
    }

    fn step(&mut self, input: Input) -> Result<Row, RunError> {
        let input = scaled(&input);
        let output = self.muscle.step(&mut self.state, input);
        let output = match &mut self.fatiguing {
            Some(fatiguing) => output.fatigued(fatiguing.advance(input)),
            None => output,
        };
        Ok(row(output, self.f0))
    }

    fn fork(&self) -> Box<dyn Running> {
        Box::new(Self { muscle: Arc::clone(&self.muscle), ..*self })
    }

    fn watch(&self, watch: &mut dyn FnMut(u64)) {
        let fatiguing = self.fatiguing.iter().flat_map(|fatiguing| fatiguing.state.words());
        self.state.words().chain(fatiguing).for_each(|word| watch(word.into()));
    }

    fn save(&self) -> Option<Vec<u64>> {
        let words = self.muscle.save(&self.state);
        let fatiguing =
            self.fatiguing.iter().flat_map(|fatiguing| fatiguing.fatigue.save(&fatiguing.state));
        Some(words.chain(fatiguing).map(Into::into).collect())
    }

    fn stiffness(&self) -> Option<f64> {
        let slope = self.slope?(&self.muscle, &self.state).to_f64() * self.f0_per_length;
        let fitness = self.fatiguing.map_or(1.0, |fatiguing| fatiguing.state.fitness().to_f64());
        Some(slope * fitness)
    }

    fn restore(&mut self, words: &[u64]) -> Result<(), RunError> {
        let refused = |problem: String| RunError::Restore { words: words.len(), problem };
        let bits: Result<Vec<S::Bits>, _> =
            words.iter().map(|&word| S::Bits::try_from(word)).collect();
        let bits =
            bits.map_err(|_| refused("a word is too large for the arithmetic".to_owned()))?;
        let own = vm::State::<S, R, N>::SAVED_WORDS.min(bits.len());
        let (of_muscle, of_fatigue) = bits.split_at(own);
        let problem = |error: vm::RestoreError| refused(error.to_string());
        let state = self.muscle.restore(of_muscle.iter().copied()).map_err(problem)?;
        match &mut self.fatiguing {
            Some(fatiguing) => {
                let words = of_fatigue.iter().copied();
                fatiguing.state = fatiguing.fatigue.restore(words).map_err(problem)?;
            }
            None if !of_fatigue.is_empty() => {
                return Err(refused(format!("this muscle's saved state has {own}")));
            }
            None => {}
        }
        self.state = state;
        Ok(())
    }
}

fn scaled<S: vm::Scalar>(input: &Input) -> vm::Input<S> {
    vm::Input {
        activation: S::from_f64(input.activation),
        path_length: S::path_length(input.path_length),
        stimulation_frequency: S::quantity(input.stimulation_frequency),
    }
}

fn row<S: vm::Scalar>(output: vm::Output<S>, f0: f64) -> Row {
    let sample = Sample {
        force: S::newtons_of(output.force, output.relative_force, f0),
        fascicle_length: output.fascicle_length.to_f64(),
        fascicle_velocity: output.fascicle_velocity.to_f64(),
    };
    (sample, output.status)
}
