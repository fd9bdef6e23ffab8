//! Hint for branches that are rarely taken.

/// Marks the branch that calls it as rarely taken: the compiler moves it out of the hot path.
///
/// `core::hint::cold_path` does the same since Rust 1.95; this crate supports older compilers.
#[cold]
#[inline]
pub(crate) const fn cold_path() {}
