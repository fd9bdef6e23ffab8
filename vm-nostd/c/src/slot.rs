//! A muscle in memory that belongs to C.

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
    /// Naturally, continuous.
    Continuous = 0,
    /// By intramuscular FES.
    Fes = 1,
}

/// Bytes of `S`'s muscles as C has them, of 8-byte alignment: a mark, and a muscle once the mark says so.
#[repr(C, align(8))]
pub struct Slot<S: Scalar, const MARK: u32> {
    mark: u32,
    muscle: MaybeUninit<BankedMuscle<S, VM_FIBERS>>,
}

/// How many words a saved state has, whatever the mode.
pub const fn words<S: Scalar>() -> usize {
    let continuous = State::<S, NaturalContinuous, VM_FIBERS>::SAVED_WORDS;
    assert!(continuous == State::<S, IntramuscularFes, VM_FIBERS>::SAVED_WORDS);
    continuous
}

impl<S: Scalar, const MARK: u32> Slot<S, MARK> {
    /// Puts a muscle into memory that may hold anything.
    pub fn put(slot: &mut MaybeUninit<Self>, muscle: BankedMuscle<S, VM_FIBERS>) {
        slot.write(Self { mark: MARK, muscle: MaybeUninit::new(muscle) });
    }

    /// The muscle, if one was put there.
    pub fn get(&self) -> Result<&BankedMuscle<S, VM_FIBERS>, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: the mark is written only together with a muscle.
        #[allow(unsafe_code)]
        Ok(unsafe { self.muscle.assume_init_ref() })
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self) -> Result<&mut BankedMuscle<S, VM_FIBERS>, VmResult> {
        if self.mark != MARK {
            return Err(VmResult::NotBuilt);
        }
        // SAFETY: as above.
        #[allow(unsafe_code)]
        Ok(unsafe { self.muscle.assume_init_mut() })
    }
}

/// A mode, if there is one of that number.
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

/// Keeps words where C wants them.
pub(crate) fn keep(words: impl Iterator<Item = u32>, places: &mut [u32]) {
    places.iter_mut().zip(words).for_each(|(place, word)| *place = word);
}
