//! Generated parts of the documentation: measured tables and the README's picture.
//!
//! `cargo vm readme`, `cargo vm cycles` and `cargo vm stack` write them with `--write`; tests fail
//! when they drift.

mod closed_loop;
mod fit;
mod picture;
mod place;
mod tables;

pub use closed_loop::closed_loop;
pub use picture::picture;
pub use place::{
    CYCLES, ERROR_BUDGET, FIT, LOOP, MEASURED, PICTURE, Place, RECOVERY, ReadmeError, SCOREBOARD,
    STACK, WORST,
};
pub use tables::{cycles, error_budget, measured, memory, stack, worst};

use crate::verify::Report;

/// The tables generated from an accuracy report, with their places.
pub fn tables(report: &Report) -> Result<[(Place, String); 4], ReadmeError> {
    Ok([
        (WORST, worst(report)),
        (MEASURED, measured(report)),
        (ERROR_BUDGET, error_budget(report)),
        (FIT, fit::table(report, &CYCLES.text()?)?),
    ])
}
