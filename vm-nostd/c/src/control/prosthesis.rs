//! A prosthesis as a controller.

use crate::arithmetic::Arithmetic;
use crate::control::VM_ANTAGONISTS;
use crate::control::controller::{Controller, Family};
use crate::control::prosthesis_params::{VM_DELAY_TICKS, VmProsthesisParams};
use crate::params::VmMuscleParams;
use crate::result::{Refusal, VmResult};
use crate::slot::Thing;
use model::control::{Prosthesis, ProsthesisCommand, ProsthesisInput, ProsthesisState};
use model::{RestoreError, TimeStep};

/// Prostheses of any number of fibre types.
pub struct Prostheses;

impl<S: Arithmetic> Family<S> for Prostheses {
    const THING: Thing = Thing::Prosthesis;
    type Params = VmProsthesisParams;
    type Input = ProsthesisInput<S>;
    type Command = ProsthesisCommand<S>;
    type Of<const N: usize> = Prosthesis<S, N, VM_DELAY_TICKS>;

    fn muscles(params: &VmProsthesisParams) -> &[VmMuscleParams; VM_ANTAGONISTS] {
        &params.muscles
    }
}

impl<S: Arithmetic, const N: usize> Controller<S> for Prosthesis<S, N, VM_DELAY_TICKS> {
    type Params = VmProsthesisParams;
    type State = ProsthesisState<S, N, VM_DELAY_TICKS>;
    type Input = ProsthesisInput<S>;
    type Command = ProsthesisCommand<S>;

    fn build(params: &VmProsthesisParams, step: TimeStep) -> Result<Self, Refusal> {
        Ok(Self::build(&params.model()?, step)?)
    }
    fn start(&self, angle: S) -> Result<Self::State, VmResult> {
        self.rest(angle).map_err(|_| VmResult::Parameter)
    }
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Command {
        self.step(state, input)
    }
    fn saved_words(&self) -> usize {
        Self::State::SAVED_WORDS
    }
    fn save(&self, state: &Self::State) -> impl Iterator<Item = S::Bits> {
        self.save(state)
    }
    fn restore(&self, words: impl Iterator<Item = S::Bits>) -> Result<Self::State, RestoreError> {
        self.restore(words)
    }
    fn checksum(&self) -> u32 {
        self.checksum()
    }
}
