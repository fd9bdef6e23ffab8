//! The FES controller as a controller.

use crate::arithmetic::Arithmetic;
use crate::control::VM_ANTAGONISTS;
use crate::control::controller::{Controller, Family};
use crate::control::fes_params::VmFesParams;
use crate::params::VmMuscleParams;
use crate::result::{Refusal, VmResult};
use crate::slot::Thing;
use model::control::{FesCommand, FesController, FesControllerState, Sensors, Target};
use model::{RestoreError, TimeStep};

/// FES controllers of any number of fibre types.
pub struct FesControllers;

impl<S: Arithmetic> Family<S> for FesControllers {
    const THING: Thing = Thing::Fes;
    type Params = VmFesParams;
    type Input = (Target<S>, Sensors<S>);
    type Command = FesCommand<S>;
    type Of<const N: usize> = FesController<S, N>;

    fn muscles(params: &VmFesParams) -> &[VmMuscleParams; VM_ANTAGONISTS] {
        &params.muscles
    }
}

impl<S: Arithmetic, const N: usize> Controller<S> for FesController<S, N> {
    type Params = VmFesParams;
    type State = FesControllerState<S>;
    type Input = (Target<S>, Sensors<S>);
    type Command = FesCommand<S>;

    fn build(params: &VmFesParams, step: TimeStep) -> Result<Self, Refusal> {
        Ok(Self::build(&params.model()?, step)?)
    }
    fn start(&self, angle: S) -> Result<Self::State, VmResult> {
        Ok(self.start(angle))
    }
    fn step(&self, state: &mut Self::State, (target, sensors): Self::Input) -> Self::Command {
        self.step(state, target, sensors)
    }
    fn saved_words(&self) -> usize {
        self.saved_words()
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
