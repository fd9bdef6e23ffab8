//! Whole-system tests live in `tests/tests`. Here the code blocks of the READMEs are compiled
//! and run, as documentation tests.

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

#[cfg(doctest)]
#[doc = include_str!("../../vm-nostd/README.md")]
pub struct ModelReadme;
