//! Generated parts of the documentation: measured tables and the README's picture.
//!
//! `cargo vm readme`, `cargo vm cycles` and `cargo vm stack` write them with `--write`; tests fail
//! when they drift.

mod fit;
mod picture;
mod place;
mod tables;

pub use picture::picture;
pub use place::{
    CYCLES, ERROR_BUDGET, FIT, MEASURED, PICTURE, Place, RECOVERY, ReadmeError, SCOREBOARD, STACK,
};
pub use tables::{cycles, error_budget, measured, memory, stack};

use crate::verify::Report;

/// The tables generated from an accuracy report, with their places.
pub fn tables(report: &Report) -> Result<[(Place, String); 3], ReadmeError> {
    Ok([
        (MEASURED, measured(report)),
        (ERROR_BUDGET, error_budget(report)),
        (FIT, fit::table(report, &CYCLES.text()?)?),
    ])
}
