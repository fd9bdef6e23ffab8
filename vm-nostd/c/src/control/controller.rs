//! What the functions of prosthesis and FES controller do, in every arithmetic.

use crate::arithmetic::Arithmetic;
use crate::control::{VM_ANTAGONISTS, VmControlInfo};
use crate::derived::admitted;
use crate::kinds::by_types;
use crate::muscle::keep;
use crate::params::VmMuscleParams;
use crate::pointer::{Place, borrow, places, slice};
use crate::result::{Refusal, VmError, VmResult};
use crate::slot::{Header, Memory, Thing, bytes, mark};
use core::mem::MaybeUninit;
use model::{Checksum, Limit, ParameterError, RestoreError, TimeStep};

/// A controller of `N` fibre types.
pub trait Controller<S: Arithmetic>: Sized {
    /// Parameters in C, of any number of types.
    type Params;
    /// Everything that changes from tick to tick.
    type State;
    /// Inputs of a tick.
    type Input;
    /// What a tick commands.
    type Command;

    /// Builds from parameters.
    fn build(params: &Self::Params, step: TimeStep) -> Result<Self, Refusal>;
    /// The state in which it starts at an angle.
    fn start(&self, angle: S) -> Result<Self::State, VmResult>;
    /// A tick.
    fn step(&self, state: &mut Self::State, input: Self::Input) -> Self::Command;
    /// Words of a saved state.
    fn saved_words(&self) -> usize;
    /// These words.
    fn save(&self, state: &Self::State) -> impl Iterator<Item = S::Bits>;
    /// A state from words.
    fn restore(&self, words: impl Iterator<Item = S::Bits>) -> Result<Self::State, RestoreError>;
    /// Checksum of the coefficients.
    fn checksum(&self) -> u32;
}

/// A kind of controllers, of any number of fibre types.
pub trait Family<S: Arithmetic> {
    /// What is in memory.
    const THING: Thing;
    /// Parameters in C.
    type Params: 'static;
    /// Inputs of a tick.
    type Input;
    /// What a tick commands.
    type Command;
    /// With `N` fibre types.
    type Of<const N: usize>: Controller<S, Params = Self::Params, Input = Self::Input, Command = Self::Command>;

    /// Flexor and extensor.
    fn muscles(params: &Self::Params) -> &[VmMuscleParams; VM_ANTAGONISTS];
}

/// A controller and its state in memory.
pub struct Running<S: Arithmetic, C: Controller<S>> {
    controller: C,
    state: C::State,
}

/// That of `N` fibre types.
pub type Of<S, F, const N: usize> = Running<S, <F as Family<S>>::Of<N>>;

fn bytes_of<S: Arithmetic, F: Family<S>, const N: usize>() -> usize {
    bytes::<Of<S, F, N>>()
}

/// Bytes of memory for a number of fibre types.
pub fn needed<S: Arithmetic, F: Family<S>>(types: u32, needed: *mut usize) -> Result<(), VmResult> {
    let place = Place::new(needed)?;
    place.put(by_types!(types, return Err(VmResult::Parameter), bytes_of::<S, F>, ()));
    Ok(())
}

fn build_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
    size: usize,
    params: &F::Params,
    step: TimeStep,
) -> Result<(), Refusal> {
    let needed = bytes::<Of<S, F, N>>();
    if size < needed {
        return Err(Refusal::Size { size, needed });
    }
    let controller = F::Of::<N>::build(params, step)?;
    // Nobody sees this state: the first step is refused until it has been started.
    let state = controller.start(S::ZERO)?;
    let header = Header { mark: mark::<S>(F::THING), mode: 0, types: N as u8, class: 0, rested: 0 };
    memory.put(header, Running::<S, F::Of<N>> { controller, state });
    Ok(())
}

/// Builds a controller in memory.
pub fn build<S: Arithmetic, F: Family<S>, T>(
    memory: *mut T,
    size: usize,
    params: *const F::Params,
    time_step_s: f64,
    error: *mut VmError,
) -> Result<(), Refusal> {
    Place::optional(error)?;
    let memory = Memory::new(memory)?;
    let params = borrow(params)?;
    let muscles = F::muscles(params);
    for (index, muscle) in muscles.iter().enumerate() {
        admitted(muscle).map_err(|refusal| refusal.of_muscle(index))?;
    }
    let [flexor, extensor] = muscles.each_ref().map(|muscle| muscle.fiber_count);
    if extensor != flexor {
        let limit = Limit::Within { least: flexor.into(), most: flexor.into() };
        let value = extensor.into();
        let error = ParameterError { field: "fiber_count", fiber: None, value, limit };
        return Err(Refusal::from(error).of_muscle(1));
    }
    let step = TimeStep::from_seconds(time_step_s)?;
    let none = Err(VmResult::NotBuilt.into());
    by_types!(flexor, none, build_of::<S, F>, (memory, size, params, step))
}

/// A controller in memory.
fn built<S: Arithmetic, F: Family<S>, T>(memory: *mut T) -> Result<(Memory, Header), VmResult> {
    let memory = Memory::new(memory)?;
    Ok((memory, memory.header(mark::<S>(F::THING))?))
}

/// One with a state.
fn started<S: Arithmetic, F: Family<S>, T>(memory: *mut T) -> Result<(Memory, Header), VmResult> {
    let (memory, header) = built::<S, F, T>(memory)?;
    if header.rested == 1 { Ok((memory, header)) } else { Err(VmResult::NotRested) }
}

fn start_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
    angle: S,
) -> Result<(), VmResult> {
    let running = memory.thing::<Of<S, F, N>>();
    running.state = running.controller.start(angle)?;
    Ok(())
}

/// Starts a controller at an angle.
pub fn start<S: Arithmetic, F: Family<S>, T>(
    memory: *mut T,
    angle: S::Number,
) -> Result<(), VmResult> {
    let (memory, header) = built::<S, F, T>(memory)?;
    let (none, angle) = (Err(VmResult::NotBuilt), S::number_from(angle));
    by_types!(header.types, none, start_of::<S, F>, (memory, angle))?;
    memory.rested(header);
    Ok(())
}

fn step_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
    input: F::Input,
) -> Result<F::Command, VmResult> {
    let Running { controller, state } = memory.thing::<Of<S, F, N>>();
    Ok(controller.step(state, input))
}

/// Steps a controller.
pub fn step<S: Arithmetic, F: Family<S>, T>(
    memory: *mut T,
    input: F::Input,
) -> Result<F::Command, VmResult> {
    let (memory, header) = started::<S, F, T>(memory)?;
    by_types!(header.types, Err(VmResult::NotBuilt), step_of::<S, F>, (memory, input))
}

fn words_of<S: Arithmetic, F: Family<S>, const N: usize>(memory: Memory) -> Result<u32, VmResult> {
    Ok(memory.thing::<Of<S, F, N>>().controller.saved_words() as u32)
}

/// What a controller says of itself.
pub fn info<S: Arithmetic, F: Family<S>, T>(
    memory: *const T,
    info: *mut VmControlInfo,
) -> Result<(), VmResult> {
    let place = Place::new(info)?;
    let (memory, header) = built::<S, F, T>(memory.cast_mut())?;
    let state_words = by_types!(header.types, Err(VmResult::NotBuilt), words_of::<S, F>, (memory))?;
    place.put(VmControlInfo { fiber_count: header.types.into(), state_words });
    Ok(())
}

fn save_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
    places: &mut [MaybeUninit<S::Word>],
) -> Result<(), VmResult> {
    let Running { controller, state } = memory.thing::<Of<S, F, N>>();
    keep::<S>(controller.save(state), controller.saved_words(), places)
}

/// Saves a state.
pub fn save<S: Arithmetic, F: Family<S>, T>(
    memory: *const T,
    words: *mut S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = places(words, count)?;
    let (memory, header) = started::<S, F, T>(memory.cast_mut())?;
    by_types!(header.types, Err(VmResult::NotBuilt), save_of::<S, F>, (memory, words))
}

fn restore_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
    words: &[S::Word],
) -> Result<(), VmResult> {
    let Running { controller, state } = memory.thing::<Of<S, F, N>>();
    let words = words.get(..controller.saved_words()).ok_or(VmResult::Size)?;
    *state = controller.restore(words.iter().map(|&word| word.into()))?;
    Ok(())
}

/// Restores a state.
pub fn restore<S: Arithmetic, F: Family<S>, T>(
    memory: *mut T,
    words: *const S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = slice(words, count)?;
    let (memory, header) = built::<S, F, T>(memory)?;
    by_types!(header.types, Err(VmResult::NotBuilt), restore_of::<S, F>, (memory, words))?;
    memory.rested(header);
    Ok(())
}

fn checksums_of<S: Arithmetic, F: Family<S>, const N: usize>(
    memory: Memory,
) -> Result<[u32; 2], VmResult> {
    let Running { controller, state } = memory.thing::<Of<S, F, N>>();
    let mut checksum = Checksum::EMPTY;
    for word in controller.save(state) {
        let word: u64 = word.into();
        [word as u32, (word >> 32) as u32].into_iter().for_each(|half| checksum.add(half));
    }
    Ok([controller.checksum(), checksum.value()])
}

/// Checksums of coefficients and state.
pub fn checksums<S: Arithmetic, F: Family<S>, T>(
    memory: *const T,
    coefficients: *mut u32,
    state: *mut u32,
) -> Result<(), VmResult> {
    let (first, second) = (Place::new(coefficients)?, Place::new(state)?);
    let (memory, header) = started::<S, F, T>(memory.cast_mut())?;
    let none = Err(VmResult::NotBuilt);
    let [coefficients, state] = by_types!(header.types, none, checksums_of::<S, F>, (memory))?;
    first.put(coefficients);
    second.put(state);
    Ok(())
}
