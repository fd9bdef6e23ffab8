//! A path that is rarely taken.

/// Marks the branch it is called in as rarely taken, so that the other one is laid out straight.
///
/// `core::hint::cold_path` does so since Rust 1.95; this crate builds with older compilers.
#[cold]
#[inline]
pub(crate) const fn cold_path() {}
