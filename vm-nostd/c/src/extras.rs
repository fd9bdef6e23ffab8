//! What the functions of fatigue, recruitment curve and inverse do, in every arithmetic.

use crate::arithmetic::{Arithmetic, InputOf};
use crate::derived::admitted;
use crate::kinds::by_types;
use crate::muscle::keep;
use crate::params::VmMuscleParams;
use crate::pointer::{Place, borrow, borrow_mut, places, read, slice};
use crate::result::{Refusal, VmError, VmResult};
use crate::slot::{Header, Memory, Slot, Thing, bytes, mark};
use model::{
    Fatigue, FatigueParams, FatigueState, RecruitmentCurve, RecruitmentCurveParams, Steady,
    SteadyFes, TimeStep,
};

/// A muscle's fatigue.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmFatigueParams {
    /// T_fat at full activation and 100 pps, s; 1 to 1000.
    pub fatigue_time_s: f64,
    /// T_rec, s; 1 to 1000.
    pub recovery_time_s: f64,
    /// Least fitness; 0 to 1.
    pub least_fitness: f64,
    /// Dependence on frequency; 0 to 1.
    pub frequency_dependence: f64,
}

/// How a muscle answers to the pulses of an electrode.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmCurveParams {
    /// Rheobase of the first recruited fibres, A; 1e-5 to 0.2.
    pub threshold_a: f64,
    /// Amplitude of a very long pulse that recruits all, A; 1.05 thresholds to 0.2.
    pub saturation_a: f64,
    /// Chronaxie, s; 5e-5 to 0.001.
    pub chronaxie_s: f64,
    /// Slope in the middle, as a multiple of that of a straight line; 1 to 10.
    pub slope: f64,
}

impl VmFatigueParams {
    pub(crate) fn model(&self) -> FatigueParams {
        FatigueParams {
            fatigue_time: self.fatigue_time_s,
            recovery_time: self.recovery_time_s,
            least_fitness: self.least_fitness,
            frequency_dependence: self.frequency_dependence,
        }
    }
}

impl VmCurveParams {
    pub(crate) fn model(&self) -> RecruitmentCurveParams {
        RecruitmentCurveParams {
            threshold: self.threshold_a,
            saturation: self.saturation_a,
            chronaxie: self.chronaxie_s,
            slope: self.slope,
        }
    }
}

/// Fatigue with its state.
pub struct Tiring<S: Arithmetic> {
    fatigue: Fatigue<S>,
    state: FatigueState<S>,
}

/// Memory of fatigue.
pub type FatigueSlot<S> = Slot<Tiring<S>>;
/// Memory of a curve.
pub type CurveSlot<S> = Slot<RecruitmentCurve<S>>;

/// Room in C for what is built, if it is large enough.
fn room<T, U>(memory: *mut T, size: usize) -> Result<Place<U>, Refusal> {
    let needed = size_of::<U>();
    let place = Place::new(memory.cast::<U>())?;
    if size < needed { Err(Refusal::Size { size, needed }) } else { Ok(place) }
}

/// Builds fatigue, rested.
pub fn build_fatigue<S: Arithmetic, T>(
    memory: *mut T,
    size: usize,
    params: *const VmFatigueParams,
    time_step_s: f64,
    error: *mut VmError,
) -> Result<(), Refusal> {
    Place::optional(error)?;
    let place = room::<T, FatigueSlot<S>>(memory, size)?;
    let params = read(params)?;
    let step = TimeStep::from_seconds(time_step_s)?;
    let fatigue = Fatigue::build(&params.model(), step)?;
    place.put(Slot::new(mark::<S>(Thing::Fatigue), Tiring { state: fatigue.rested(), fatigue }));
    Ok(())
}

/// Fatigue in memory.
fn tiring<'a, S: Arithmetic, T>(memory: *mut T) -> Result<&'a mut Tiring<S>, VmResult> {
    borrow_mut(memory.cast::<FatigueSlot<S>>())?.get_mut(mark::<S>(Thing::Fatigue))
}

/// A curve in memory.
fn curve<'a, S: Arithmetic, T>(memory: *const T) -> Result<&'a RecruitmentCurve<S>, VmResult> {
    borrow(memory.cast::<CurveSlot<S>>())?.get(mark::<S>(Thing::Curve))
}

/// Advances fatigue by the activation and frequency of a tick.
pub fn advance_fatigue<S: Arithmetic, T, I: InputOf<S>>(
    memory: *mut T,
    input: *const I,
    fitness: *mut S::Number,
) -> Result<(), VmResult> {
    let place = Place::new(fitness)?;
    let input = read(input)?.input();
    let tiring = tiring::<S, _>(memory)?;
    let Tiring { fatigue, state } = tiring;
    let fitness = fatigue.advance(state, input.activation, input.stimulation_frequency);
    place.put(fitness.number());
    Ok(())
}

/// Saves fatigue.
pub fn save_fatigue<S: Arithmetic, T>(
    memory: *const T,
    words: *mut S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = places(words, count)?;
    let tiring = borrow(memory.cast::<FatigueSlot<S>>())?.get(mark::<S>(Thing::Fatigue))?;
    let needed = FatigueState::<S>::SAVED_WORDS;
    keep::<S>(tiring.fatigue.save(&tiring.state), needed, words)
}

/// Restores fatigue.
pub fn restore_fatigue<S: Arithmetic, T>(
    memory: *mut T,
    words: *const S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = slice(words, count)?;
    let words = words.get(..FatigueState::<S>::SAVED_WORDS).ok_or(VmResult::Size)?;
    let tiring = tiring::<S, _>(memory)?;
    tiring.state = tiring.fatigue.restore(words.iter().map(|&word| word.into()))?;
    Ok(())
}

/// Builds a curve.
pub fn build_curve<S: Arithmetic, T>(
    memory: *mut T,
    size: usize,
    params: *const VmCurveParams,
    error: *mut VmError,
) -> Result<(), Refusal> {
    Place::optional(error)?;
    let place = room::<T, CurveSlot<S>>(memory, size)?;
    let params = read(params)?;
    place.put(Slot::new(mark::<S>(Thing::Curve), RecruitmentCurve::build(&params.model())?));
    Ok(())
}

/// A function of a curve: what it answers, and its flags.
pub fn on_curve<S: Arithmetic, T, A>(
    memory: *const T,
    answer: *mut A,
    status: *mut u16,
    ask: impl FnOnce(&RecruitmentCurve<S>) -> (A, model::PulseStatus),
) -> Result<(), VmResult> {
    let (first, second) = (Place::new(answer)?, Place::new(status)?);
    let (answer, status) = ask(curve::<S, _>(memory)?);
    first.put(answer);
    second.put(status.bits());
    Ok(())
}

/// Checksum of a curve.
pub fn curve_checksum<S: Arithmetic, T>(
    memory: *const T,
    checksum: *mut u32,
) -> Result<(), VmResult> {
    let place = Place::new(checksum)?;
    place.put(curve::<S, _>(memory)?.checksum());
    Ok(())
}

fn build_steady_of<S: Arithmetic, const N: usize>(
    memory: Memory,
    size: usize,
    params: &VmMuscleParams,
) -> Result<(), Refusal> {
    let needed = bytes::<SteadyFes<S, N>>();
    if size < needed {
        return Err(Refusal::Size { size, needed });
    }
    let steady = SteadyFes::<S, N>::build(&params.model::<N>()?)?;
    memory.put(
        Header { mark: mark::<S>(Thing::Steady), mode: 1, types: N as u8, class: 0, rested: 1 },
        steady,
    );
    Ok(())
}

/// Builds an inverse.
pub fn build_steady<S: Arithmetic, T>(
    memory: *mut T,
    size: usize,
    params: *const VmMuscleParams,
    error: *mut VmError,
) -> Result<(), Refusal> {
    Place::optional(error)?;
    let memory = Memory::new(memory)?;
    let params = admitted(params)?;
    let none = Err(VmResult::NotBuilt.into());
    by_types!(params.fiber_count, none, build_steady_of::<S>, (memory, size, params))
}

/// What is asked of an inverse.
#[derive(Clone, Copy)]
pub enum Question<S: Arithmetic> {
    /// The force of an input.
    Force(model::Input<S>),
    /// The activation that holds a force.
    Activation(S::Force, S::PathLength, S::Quantity),
}

fn ask_steady_of<S: Arithmetic, const N: usize>(
    memory: Memory,
    question: Question<S>,
) -> Result<Steady<S>, VmResult> {
    let steady = memory.thing::<SteadyFes<S, N>>();
    Ok(match question {
        Question::Force(input) => steady.force(input),
        Question::Activation(force, path, frequency) => {
            steady.activation_for(force, path, frequency)
        }
    })
}

/// Asks an inverse.
pub fn ask_steady<S: Arithmetic, T>(
    memory: *const T,
    question: Question<S>,
) -> Result<Steady<S>, VmResult> {
    let memory = Memory::new(memory.cast_mut())?;
    let header = memory.header(mark::<S>(Thing::Steady))?;
    let none = Err(VmResult::NotBuilt);
    by_types!(header.types, none, ask_steady_of::<S>, (memory, question))
}
