//! Whole-system tests live in `tests/tests`. Here the code blocks of the READMEs are compiled
//! and run, as documentation tests.

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../../vm-nostd/README.md")]
pub struct ModelReadme;

pub mod debugger;
pub mod machine;

use host_sim::target::{self, Board, TargetError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Prints why a test was skipped; panics if `VM_REQUIRE_TARGET` is set.
pub fn skip(reason: &str) {
    assert!(std::env::var_os("VM_REQUIRE_TARGET").is_none(), "not to be skipped: {reason}");
    // Directly to standard error: the harness captures the output of passing tests.
    writeln!(std::io::stderr(), "SKIPPED: {reason}").expect("standard error is open");
}

/// Builds a program for a board; an error if the target's library is missing. Panics if the build
/// fails.
pub fn build(board: Board, program: &str) -> Result<PathBuf, TargetError> {
    build_with(board, program, &[])
}

/// The same with environment variables.
pub fn build_with(
    board: Board,
    program: &str,
    variables: &[(&str, &Path)],
) -> Result<PathBuf, TargetError> {
    match target::build(board, program, variables) {
        Err(error @ TargetError::Build { .. }) => panic!("{error}"),
        other => other,
    }
}
