//! Types of an arithmetic's values.

use super::sealed::Sealed;
use crate::summed::{FromWords, Summed};
use core::fmt::Debug;

/// How an arithmetic represents what is not a number without unit. Sealed.
pub trait Representation: Sealed + Sized {
    /// A word of a saved state.
    type Bits: Copy + Debug + Eq + From<u32> + TryFrom<u64> + Into<u64> + Summed + Send + Sync;
    /// State that adds up small changes, with more resolution than the number itself.
    type Wide: Copy + Debug + PartialEq + Send + Sync;
    /// A musculotendon path length: m in floating point, µm in fixed point.
    type PathLength: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;
    /// A quantity with a unit: stimulation frequency in pps, pulse amplitude in mA, pulse width in
    /// µs.
    type Quantity: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;
    /// A tendon force: N in floating point, mN in fixed point.
    type Force: Copy + Debug + PartialEq + PartialOrd + FromWords + Send + Sync;
}
