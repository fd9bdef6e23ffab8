//! A muscle in memory owned by C.

use crate::result::VmResult;
use core::mem::MaybeUninit;
use model::{
    BankedMuscle, IntramuscularFes, Limit, NaturalContinuous, ParameterError, Scalar, State,
};

/// Fibre types of each muscle.
pub const VM_FIBERS: usize = 2;

/// How a muscle is recruited.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VmMode {
    /// Natural continuous recruitment.
    Continuous = 0,
    /// Intramuscular FES.
    Fes = 1,
}

/// Memory of a muscle in C, aligned to 8 bytes: a mark, and a muscle if the mark is set.
#[repr(C, align(8))]
pub struct Slot<S: Scalar, const MARK: u32> {
    mark: u32,
    muscle: MaybeUninit<BankedMuscle<S, VM_FIBERS>>,
}

/// Words of a saved state, in the larger of both modes.
pub const fn words<S: Scalar>() -> usize {
    let continuous = State::<S, NaturalContinuous, VM_FIBERS>::SAVED_WORDS;
    assert!(continuous == State::<S, IntramuscularFes, VM_FIBERS>::SAVED_WORDS);
    continuous
}

impl<S: Scalar, const MARK: u32> Slot<S, MARK> {
    /// Writes a muscle into uninitialised memory.
    pub fn put(slot: &mut MaybeUninit<Self>, muscle: BankedMuscle<S, VM_FIBERS>) {
        slot.write(Self { mark: MARK, muscle: MaybeUninit::new(muscle) });
    }

    /// The muscle, if there is one.
    pub fn get(&self) -> Result<&BankedMuscle<S, VM_FIBERS>, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: the mark is written only together with a muscle.
        #[allow(unsafe_code)]
        Ok(unsafe { self.muscle.assume_init_ref() })
    }

    /// The muscle, mutable.
    pub fn get_mut(&mut self) -> Result<&mut BankedMuscle<S, VM_FIBERS>, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: as above.
        #[allow(unsafe_code)]
        Ok(unsafe { self.muscle.assume_init_mut() })
    }
}

/// Mode of a number, if there is one.
pub(crate) fn mode_of(mode: u32) -> Result<VmMode, ParameterError> {
    match mode {
        0 => Ok(VmMode::Continuous),
        1 => Ok(VmMode::Fes),
        other => {
            let limit = Limit::Within { least: 0.0, most: 1.0 };
            Err(ParameterError { field: "mode", fiber: None, value: other.into(), limit })
        }
    }
}

/// Copies words to C.
pub(crate) fn keep(words: impl Iterator<Item = u32>, places: &mut [u32]) {
    places.iter_mut().zip(words).for_each(|(place, word)| *place = word);
}
