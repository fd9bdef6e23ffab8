//! Generated parts of the documentation: measured tables and the README's picture.
//!
//! Each is written by a command and compared by a test: `cargo vm readme`, `cargo vm cycles` and
//! `cargo vm stack`, each with `--write`.

mod fit;
mod picture;
mod place;
mod tables;

pub use picture::{PICTURE, picture};
pub use place::{
    CYCLES, ERROR_BUDGET, FIT, MEASURED, Place, RECOVERY, ReadmeError, SCOREBOARD, STACK,
};
pub use tables::{cycles, error_budget, measured, memory, stack};

use crate::trace::write_atomically;
use crate::verify::Report;
use place::{path_of, read};

/// All that is generated from a report of accuracy: each table, with its place.
pub fn tables(report: &Report) -> Result<[(Place, String); 3], ReadmeError> {
    Ok([
        (MEASURED, measured(report)),
        (ERROR_BUDGET, error_budget(report)),
        (FIT, fit::table(report, &CYCLES.table()?)?),
    ])
}

/// Whether the stored picture is the one that is drawn.
pub fn picture_is_current(svg: &str) -> Result<bool, ReadmeError> {
    Ok(read(&path_of(PICTURE))? == svg)
}

/// Stores the picture.
pub fn write_picture(svg: &str) -> Result<(), ReadmeError> {
    Ok(write_atomically(&path_of(PICTURE), svg.as_bytes())?)
}
