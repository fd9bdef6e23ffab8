//! What the functions of a joint do, in every arithmetic.

use crate::arithmetic::Arithmetic;
use crate::control::joint_params::{
    VM_JOINT_ANGLES, VM_JOINT_MUSCLES, VmJointParams, admitted_joint,
};
use crate::pointer::{Place, places, slice};
use crate::result::{Refusal, VmError, VmResult};
use crate::slot::{Header, Memory, Thing, bytes, mark};
use model::control::{Joint, JointMuscle, JointStatus, Placed, Posture};

/// Calls `$call::<S, J, M>` for numbers of angles and muscles; `$none` if there are no such joints.
macro_rules! by_joint {
    ($angles:expr, $muscles:expr, $none:expr, $call:ident::<$S:ty>, $arguments:tt) => {
        match $angles {
            1 => by_joint!(@ 1, $muscles, $none, $call::<$S>, $arguments),
            2 => by_joint!(@ 2, $muscles, $none, $call::<$S>, $arguments),
            _ => $none,
        }
    };
    (@ $J:literal, $muscles:expr, $none:expr, $call:ident::<$S:ty>, ($($argument:expr),*)) => {
        match $muscles {
            1 => $call::<$S, $J, 1>($($argument),*),
            2 => $call::<$S, $J, 2>($($argument),*),
            3 => $call::<$S, $J, 3>($($argument),*),
            4 => $call::<$S, $J, 4>($($argument),*),
            5 => $call::<$S, $J, 5>($($argument),*),
            6 => $call::<$S, $J, 6>($($argument),*),
            _ => $none,
        }
    };
}

/// A posture of as many angles and muscles as there may be.
pub type Largest<S> = Posture<S, VM_JOINT_ANGLES, VM_JOINT_MUSCLES>;

fn bytes_of<S: Arithmetic, const J: usize, const M: usize>() -> usize {
    bytes::<Joint<S, J, M>>()
}

/// Bytes of memory for numbers of angles and muscles.
pub fn needed<S: Arithmetic>(
    angles: u32,
    muscles: u32,
    needed: *mut usize,
) -> Result<(), VmResult> {
    let place = Place::new(needed)?;
    place.put(by_joint!(angles, muscles, return Err(VmResult::Parameter), bytes_of::<S>, ()));
    Ok(())
}

fn build_of<S: Arithmetic, const J: usize, const M: usize>(
    memory: Memory,
    size: usize,
    params: &VmJointParams,
) -> Result<(), Refusal> {
    let needed = bytes::<Joint<S, J, M>>();
    if size < needed {
        return Err(Refusal::Size { size, needed });
    }
    let mut ranges = [params.ranges[0].model(); J];
    ranges.iter_mut().zip(&params.ranges).for_each(|(to, from)| *to = from.model());
    let muscle = |index: usize| -> Result<JointMuscle<J>, Refusal> {
        let muscle = params.muscles.get(index).ok_or(VmResult::Size)?;
        muscle.model().map_err(|error| Refusal::from(error).of_muscle(index))
    };
    let mut muscles = [muscle(0)?; M];
    for (index, place) in muscles.iter_mut().enumerate() {
        *place = muscle(index)?;
    }
    let joint = Joint::<S, J, M>::build(&ranges, &muscles)?;
    // Both fit a byte: they have been checked.
    let header = Header {
        mark: mark::<S>(Thing::Joint),
        mode: J as u8,
        types: M as u8,
        class: 0,
        rested: 1,
    };
    memory.put(header, joint);
    Ok(())
}

/// Builds a joint in memory.
pub fn build<S: Arithmetic, T>(
    memory: *mut T,
    size: usize,
    params: *const VmJointParams,
    error: *mut VmError,
) -> Result<(), Refusal> {
    Place::optional(error)?;
    let memory = Memory::new(memory)?;
    let params = admitted_joint(params)?;
    let none = Err(VmResult::NotBuilt.into());
    let (angles, muscles) = (params.angle_count, params.muscle_count);
    by_joint!(angles, muscles, none, build_of::<S>, (memory, size, params))
}

/// A joint in memory.
fn built<S: Arithmetic, T>(memory: *const T) -> Result<(Memory, Header), VmResult> {
    let memory = Memory::new(memory.cast_mut())?;
    Ok((memory, memory.header(mark::<S>(Thing::Joint))?))
}

/// `N` numbers of C, of at least as many.
fn numbers<S: Arithmetic, const N: usize>(
    pointer: *const S::Number,
    count: usize,
) -> Result<[S; N], VmResult> {
    let given = slice(pointer, count)?.get(..N).ok_or(VmResult::Size)?;
    let mut numbers = [S::ZERO; N];
    numbers.iter_mut().zip(given).for_each(|(to, &from)| *to = S::number_from(from));
    Ok(numbers)
}

/// Copies quantities to C, of which there must be room for all.
fn give<S: Arithmetic, const N: usize>(
    quantities: [S::Quantity; N],
    pointer: *mut S::Amount,
    count: usize,
) -> Result<(), VmResult> {
    let places = places(pointer, count)?.get_mut(..N).ok_or(VmResult::Size)?;
    for (place, quantity) in places.iter_mut().zip(quantities) {
        place.write(S::amount(quantity));
    }
    Ok(())
}

/// A muscle that there is not.
fn nowhere<S: Arithmetic, const J: usize>() -> Placed<S, J> {
    Placed { path_length: S::path_length(0.0), moment_arms: [S::ZERO; J], arm_slopes: [S::ZERO; J] }
}

fn posture_of<S: Arithmetic, const J: usize, const M: usize>(
    memory: Memory,
    angles: *const S::Number,
    count: usize,
) -> Result<Largest<S>, VmResult> {
    let posture = memory.thing::<Joint<S, J, M>>().posture(numbers::<S, J>(angles, count)?);
    let mut muscles = [nowhere::<S, VM_JOINT_ANGLES>(); VM_JOINT_MUSCLES];
    for (to, from) in muscles.iter_mut().zip(posture.muscles) {
        to.path_length = from.path_length;
        to.moment_arms.iter_mut().zip(from.moment_arms).for_each(|(to, from)| *to = from);
        to.arm_slopes.iter_mut().zip(from.arm_slopes).for_each(|(to, from)| *to = from);
    }
    Ok(Posture { muscles, status: posture.status })
}

/// Paths and moment arms at angles.
pub fn posture<S: Arithmetic, T>(
    memory: *const T,
    angles: *const S::Number,
    count: usize,
) -> Result<Largest<S>, VmResult> {
    let (memory, header) = built::<S, T>(memory)?;
    let none = Err(VmResult::NotBuilt);
    by_joint!(header.mode, header.types, none, posture_of::<S>, (memory, angles, count))
}

/// The posture of `J` angles and `M` muscles that is in the largest.
fn part<S: Arithmetic, const J: usize, const M: usize>(posture: &Largest<S>) -> Posture<S, J, M> {
    let mut muscles = [nowhere::<S, J>(); M];
    for (to, from) in muscles.iter_mut().zip(posture.muscles) {
        to.moment_arms.iter_mut().zip(from.moment_arms).for_each(|(to, from)| *to = from);
        to.arm_slopes.iter_mut().zip(from.arm_slopes).for_each(|(to, from)| *to = from);
    }
    Posture { muscles, status: JointStatus::empty() }
}

/// Numbers of C and how many there are.
#[derive(Clone, Copy)]
pub struct Given<N> {
    pub numbers: *const N,
    pub count: usize,
}

/// Room in C and how much there is.
#[derive(Clone, Copy)]
pub struct Room<N> {
    pub places: *mut N,
    pub count: usize,
}

fn torques_of<S: Arithmetic, const J: usize, const M: usize>(
    memory: Memory,
    posture: &Largest<S>,
    forces: Given<S::Number>,
    torques: Room<S::Amount>,
) -> Result<(), VmResult> {
    let forces = numbers::<S, M>(forces.numbers, forces.count)?;
    let found = memory.thing::<Joint<S, J, M>>().torques(&part(posture), &forces);
    give::<S, J>(found, torques.places, torques.count)
}

/// Torques of forces.
pub fn torques<S: Arithmetic, T>(
    memory: *const T,
    posture: &Largest<S>,
    forces: Given<S::Number>,
    torques: Room<S::Amount>,
) -> Result<(), VmResult> {
    let (memory, header) = built::<S, T>(memory)?;
    let none = Err(VmResult::NotBuilt);
    by_joint!(header.mode, header.types, none, torques_of::<S>, (memory, posture, forces, torques))
}

fn stiffnesses_of<S: Arithmetic, const J: usize, const M: usize>(
    memory: Memory,
    posture: &Largest<S>,
    (forces, stiffnesses): (Given<S::Number>, Given<S::Number>),
    found: Room<S::Amount>,
) -> Result<(), VmResult> {
    let forces = numbers::<S, M>(forces.numbers, forces.count)?;
    let relative = numbers::<S, M>(stiffnesses.numbers, stiffnesses.count)?;
    let joint = memory.thing::<Joint<S, J, M>>();
    let stiffnesses = joint.stiffnesses(&part(posture), &forces, &relative);
    give::<S, J>(stiffnesses, found.places, found.count)
}

/// Stiffnesses of forces and the muscles' stiffnesses.
pub fn stiffnesses<S: Arithmetic, T>(
    memory: *const T,
    posture: &Largest<S>,
    muscles: (Given<S::Number>, Given<S::Number>),
    found: Room<S::Amount>,
) -> Result<(), VmResult> {
    let (memory, header) = built::<S, T>(memory)?;
    let none = Err(VmResult::NotBuilt);
    let (angles, count) = (header.mode, header.types);
    by_joint!(angles, count, none, stiffnesses_of::<S>, (memory, posture, muscles, found))
}

fn checksum_of<S: Arithmetic, const J: usize, const M: usize>(
    memory: Memory,
) -> Result<u32, VmResult> {
    Ok(memory.thing::<Joint<S, J, M>>().checksum())
}

/// Checksum of a joint.
pub fn checksum<S: Arithmetic, T>(memory: *const T, checksum: *mut u32) -> Result<(), VmResult> {
    let place = Place::new(checksum)?;
    let (memory, header) = built::<S, T>(memory)?;
    let none = Err(VmResult::NotBuilt);
    place.put(by_joint!(header.mode, header.types, none, checksum_of::<S>, (memory))?);
    Ok(())
}
