//! Seals public traits.

/// Only tested types of this crate implement it.
pub trait Sealed {}
