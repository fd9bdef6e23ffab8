//! What the functions of a muscle do, in every arithmetic.

use crate::arithmetic::{Arithmetic, InputOf, OutputOf};
use crate::derived::{admitted, has_types};
use crate::kinds::{Held, Mode, VmMode, by_kind, mode_of};
use crate::params::{VM_CLASS_ECONOMY, VM_CLASS_FINE, VM_CLASS_STANDARD, VmMuscleParams, class_of};
use crate::pointer::{Place, borrow, places, read, slice};
use crate::result::{Refusal, VmError, VmResult};
use crate::slot::{Header, Memory, Thing, bytes, mark};
use crate::units::VmUnits;
use core::mem::MaybeUninit;
use model::{Muscle, State, TimeStep};

/// Bytes of each kind of muscle.
fn bytes_of<S: Arithmetic, R: Mode<S, N>, const N: usize>() -> usize {
    bytes::<Held<S, R, N>>()
}

/// Bytes of memory for a number of types and a mode.
pub fn needed<S: Arithmetic>(types: u32, mode: u32, needed: *mut usize) -> Result<(), VmResult> {
    let place = Place::new(needed)?;
    place.put(by_kind!(types, mode, return Err(VmResult::Parameter), bytes_of::<S>, ()));
    Ok(())
}

/// What build is told.
pub struct Order {
    /// Memory's size.
    pub size: usize,
    pub params: *const VmMuscleParams,
    /// Null for modes without units.
    pub units: *const VmUnits,
    pub mode: u32,
    pub time_step_s: f64,
    pub error: *mut VmError,
}

fn build_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    memory: Memory,
    mode: VmMode,
    params: &VmMuscleParams,
    order: &Order,
) -> Result<(), Refusal> {
    let needed = bytes::<Held<S, R, N>>();
    if order.size < needed {
        return Err(Refusal::Size { size: order.size, needed });
    }
    let units = if order.units.is_null() { None } else { Some(borrow(order.units)?) };
    let model = params.model::<N>()?;
    let step = TimeStep::from_seconds(order.time_step_s)?;
    let units = R::units(&model, units)?;
    let muscle = Muscle::<S, R, N>::build_with_units(&model, &units, step)?;
    // Nobody sees this state: the first step is refused until the muscle is at rest somewhere.
    let state = muscle.rest(S::path_length(model.middle_path()))?;
    memory.put(header::<S, N>(mode, params.accuracy_class), Held { muscle, state });
    Ok(())
}

/// Header of a muscle without a state. Mode and class have been checked.
fn header<S: Arithmetic, const N: usize>(mode: VmMode, class: u32) -> Header {
    let [mode, types, class] = [mode as u8, N as u8, class as u8];
    Header { mark: mark::<S>(Thing::Muscle), mode, types, class, rested: 0 }
}

/// What is asked of words.
pub struct Emitted {
    /// Memory's size.
    pub size: usize,
    pub words: *const u32,
    pub count: usize,
    pub types: u32,
    pub mode: u32,
    pub class: u32,
    pub time_step_s: f64,
    pub error: *mut VmError,
}

fn read_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    memory: Memory,
    mode: VmMode,
    emitted: &Emitted,
) -> Result<(), Refusal> {
    let (size, needed) = (emitted.size, bytes::<Held<S, R, N>>());
    if size < needed {
        return Err(Refusal::Size { size, needed });
    }
    let words = slice(emitted.words, emitted.count)?;
    let class = class_of(emitted.class)?;
    let step = TimeStep::from_seconds(emitted.time_step_s)?;
    let muscle = Muscle::<S, R, N>::from_words(words, class, step)?;
    // Nobody sees this state.
    let state = muscle.rest(muscle.path_length_range().0)?;
    memory.put(header::<S, N>(mode, emitted.class), Held { muscle, state });
    Ok(())
}

/// Reads a muscle from words into memory.
pub fn from_words<S: Arithmetic, T>(memory: *mut T, emitted: &Emitted) -> Result<(), Refusal> {
    Place::optional(emitted.error)?;
    let memory = Memory::new(memory)?;
    let mode = mode_of(emitted.mode)?;
    has_types(emitted.types)?;
    let none = Err(VmResult::NotBuilt.into());
    by_kind!(emitted.types, emitted.mode, none, read_kind::<S>, (memory, mode, emitted))
}

/// Builds a muscle in memory.
pub fn build<S: Arithmetic, T>(memory: *mut T, order: &Order) -> Result<(), Refusal> {
    Place::optional(order.error)?;
    let memory = Memory::new(memory)?;
    let params = admitted(order.params)?;
    let mode = mode_of(order.mode)?;
    let none = Err(VmResult::NotBuilt.into());
    by_kind!(params.fiber_count, order.mode, none, build_kind::<S>, (memory, mode, params, order))
}

/// A muscle in memory.
struct Built {
    memory: Memory,
    header: Header,
}

impl Built {
    fn new<S: Arithmetic, T>(memory: *mut T) -> Result<Self, VmResult> {
        let memory = Memory::new(memory)?;
        Ok(Self { memory, header: memory.header(mark::<S>(Thing::Muscle))? })
    }

    /// One with a state.
    fn rested<S: Arithmetic, T>(memory: *mut T) -> Result<Self, VmResult> {
        let built = Self::new::<S, _>(memory)?;
        if built.header.rested == 1 { Ok(built) } else { Err(VmResult::NotRested) }
    }
}

/// Calls a function of a built muscle's kind.
macro_rules! on {
    ($built:expr, $call:ident::<$S:ty>($($argument:expr),*)) => {{
        let built: &Built = &$built;
        by_kind!(
            built.header.types,
            built.header.mode,
            Err(VmResult::NotBuilt),
            $call::<$S>,
            (built $(, $argument)*)
        )
    }};
}

fn rest_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    path: S::PathLength,
) -> Result<(), VmResult> {
    let held = built.memory.thing::<Held<S, R, N>>();
    held.state = held.muscle.rest(path).map_err(|_| VmResult::Parameter)?;
    built.memory.rested(built.header);
    Ok(())
}

/// Puts a muscle at rest.
pub fn rest<S: Arithmetic, T>(memory: *mut T, path: S::Path) -> Result<(), VmResult> {
    on!(Built::new::<S, _>(memory)?, rest_kind::<S>(S::path_from(path)))
}

fn step_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    input: model::Input<S>,
) -> Result<model::Output<S>, VmResult> {
    let held = built.memory.thing::<Held<S, R, N>>();
    Ok(held.muscle.step(&mut held.state, input))
}

/// Steps a muscle.
pub fn step<S: Arithmetic, T, I: InputOf<S>, O: OutputOf<S>>(
    memory: *mut T,
    input: *const I,
    output: *mut O,
) -> Result<(), VmResult> {
    let place = Place::new(output)?;
    let input = read(input)?.input();
    place.put(O::of(on!(Built::rested::<S, _>(memory)?, step_kind::<S>(input))?));
    Ok(())
}

fn observe_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
) -> Result<model::Output<S>, VmResult> {
    let held = built.memory.thing::<Held<S, R, N>>();
    Ok(held.muscle.observe(&held.state))
}

/// The state as an output.
pub fn observe<S: Arithmetic, T, O: OutputOf<S>>(
    memory: *const T,
    output: *mut O,
) -> Result<(), VmResult> {
    let place = Place::new(output)?;
    place.put(O::of(on!(Built::rested::<S, _>(memory.cast_mut())?, observe_kind::<S>())?));
    Ok(())
}

fn stiffness_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
) -> Result<S, VmResult> {
    R::stiffness(built.memory.thing::<Held<S, R, N>>()).ok_or(VmResult::Parameter)
}

/// Static stiffness of a muscle.
pub fn stiffness<S: Arithmetic, T>(
    memory: *const T,
    stiffness: *mut S::Number,
) -> Result<(), VmResult> {
    let place = Place::new(stiffness)?;
    let found = on!(Built::rested::<S, _>(memory.cast_mut())?, stiffness_kind::<S>())?;
    place.put(found.number());
    Ok(())
}

/// What a muscle says of itself.
pub struct Facts<S: Arithmetic> {
    pub force: S::Newtons,
    pub paths: (S::Path, S::Path),
    pub types: u32,
    pub mode: u32,
    pub class: u32,
    pub words: u32,
}

fn facts_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
) -> Result<Facts<S>, VmResult> {
    let muscle = &built.memory.thing::<Held<S, R, N>>().muscle;
    Ok(Facts {
        force: <S as Arithmetic>::newtons(muscle.max_isometric_force()),
        paths: S::paths(muscle.path_length_range()),
        types: built.header.types.into(),
        mode: built.header.mode.into(),
        class: match u32::from(built.header.class) {
            VM_CLASS_ECONOMY => VM_CLASS_ECONOMY,
            VM_CLASS_FINE => VM_CLASS_FINE,
            _ => VM_CLASS_STANDARD,
        },
        words: State::<S, R, N>::SAVED_WORDS as u32,
    })
}

/// What a muscle says of itself.
pub fn facts<S: Arithmetic, T>(memory: *const T) -> Result<Facts<S>, VmResult> {
    on!(Built::new::<S, _>(memory.cast_mut())?, facts_kind::<S>())
}

/// Copies words to C, of which there must be room for `needed`.
pub fn keep<S: Arithmetic>(
    words: impl Iterator<Item = S::Bits>,
    needed: usize,
    places: &mut [MaybeUninit<S::Word>],
) -> Result<(), VmResult> {
    if places.len() < needed {
        return Err(VmResult::Size);
    }
    places.iter_mut().zip(words).for_each(|(place, word)| {
        place.write(S::word(word));
    });
    Ok(())
}

fn save_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    places: &mut [MaybeUninit<S::Word>],
) -> Result<(), VmResult> {
    let held = built.memory.thing::<Held<S, R, N>>();
    keep::<S>(held.muscle.save(&held.state), State::<S, R, N>::SAVED_WORDS, places)
}

/// Saves a state.
pub fn save<S: Arithmetic, T>(
    memory: *const T,
    words: *mut S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = places(words, count)?;
    on!(Built::rested::<S, _>(memory.cast_mut())?, save_kind::<S>(words))
}

fn restore_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    words: &[S::Word],
) -> Result<(), VmResult> {
    let held = built.memory.thing::<Held<S, R, N>>();
    let words = words.get(..State::<S, R, N>::SAVED_WORDS).ok_or(VmResult::Size)?;
    held.state = held.muscle.restore(words.iter().map(|&word| word.into()))?;
    built.memory.rested(built.header);
    Ok(())
}

/// Restores a state.
pub fn restore<S: Arithmetic, T>(
    memory: *mut T,
    words: *const S::Word,
    count: usize,
) -> Result<(), VmResult> {
    let words = slice(words, count)?;
    on!(Built::new::<S, _>(memory)?, restore_kind::<S>(words))
}

fn coefficients_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
) -> Result<u32, VmResult> {
    Ok(built.memory.thing::<Held<S, R, N>>().muscle.checksum())
}

fn state_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
) -> Result<u32, VmResult> {
    Ok(built.memory.thing::<Held<S, R, N>>().state.checksum())
}

/// Checksums of coefficients and state.
pub fn checksums<S: Arithmetic, T>(
    memory: *const T,
    coefficients: *mut u32,
    state: *mut u32,
) -> Result<(), VmResult> {
    let (first, second) = (Place::new(coefficients)?, Place::new(state)?);
    let built = Built::rested::<S, _>(memory.cast_mut())?;
    let sums = (on!(built, coefficients_kind::<S>())?, on!(built, state_kind::<S>())?);
    first.put(sums.0);
    second.put(sums.1);
    Ok(())
}

fn fiber_curves_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    fiber: u32,
    at: [S; 3],
) -> Result<[S; 3], VmResult> {
    let curves = built.memory.thing::<Held<S, R, N>>().muscle.curves();
    let curves = curves.fiber(fiber as usize).ok_or(VmResult::Parameter)?;
    let [length, velocity, frequency] = at;
    Ok([
        curves.force_length(length),
        curves.force_velocity(length, velocity),
        curves.activation_frequency(length, frequency),
    ])
}

/// FL, FV and Af of a fibre type at a length, a velocity and a frequency.
pub fn fiber_curves<S: Arithmetic, T>(
    memory: *const T,
    fiber: u32,
    at: [S; 3],
) -> Result<[S; 3], VmResult> {
    on!(Built::new::<S, _>(memory.cast_mut())?, fiber_curves_kind::<S>(fiber, at))
}

fn element_curves_kind<S: Arithmetic, R: Mode<S, N>, const N: usize>(
    built: &Built,
    length: S,
    path: S::PathLength,
) -> Result<[S; 3], VmResult> {
    let curves = built.memory.thing::<Held<S, R, N>>().muscle.curves();
    Ok([curves.passive(length), curves.compression(length), curves.tendon(path, length)])
}

/// F_pe1, F_pe2 and F_se at a fascicle length on a path.
pub fn element_curves<S: Arithmetic, T>(
    memory: *const T,
    length: S,
    path: S::PathLength,
) -> Result<[S; 3], VmResult> {
    on!(Built::new::<S, _>(memory.cast_mut())?, element_curves_kind::<S>(length, path))
}
