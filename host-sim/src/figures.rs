//! The figures of the paper, measured again: SVG with the numbers beside them in CSV, and what the paper
//! claims against what is found.
//!
//! Source: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, section 3.

mod arm;
mod claims;
mod computation_time;
mod sinusoids;
mod static_force;

pub use arm::{ACTIVATIONS as ARM_ACTIVATIONS, DURATION as ARM_DURATION, START as ARM_START};
pub use claims::Claim;

use crate::arm::ArmError;
use crate::chart::Chart;
use crate::engine::{Arithmetic, RunError};
use crate::reference::{Mode, Muscle};
use crate::scenario::{paper_muscle, paper_muscle_of_units};
use crate::trace::{TraceError, write_atomically};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Why figures could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FiguresError {
    /// A run stopped.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The arm stopped.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The folder could not be made.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A table could not be put together.
    #[error(transparent)]
    Table(#[from] csv::Error),
    /// A figure could not be drawn.
    #[error("a figure could not be drawn: {0}")]
    Draw(String),
}

/// A way of recruiting the paper's muscle.
#[derive(Clone, Debug)]
struct Case {
    name: &'static str,
    mode: Mode,
    muscle: Muscle,
}

/// Natural continuous recruitment, and discrete recruitment of 3 + 3 and of 30 + 30 motor units.
fn cases() -> [Case; 3] {
    let discrete =
        |name, units| Case { name, mode: Mode::Discrete, muscle: paper_muscle_of_units(units) };
    [
        Case { name: "continuous", mode: Mode::Continuous, muscle: paper_muscle() },
        discrete("discrete 3 + 3", 3),
        discrete("discrete 30 + 30", 30),
    ]
}

/// Path of the paper's static figures and activation sinusoids, m.
const PATH: f64 = 0.16;
const TIME_STEP: f64 = 1e-3;

/// Where figures go.
struct Folder<'a>(&'a Path);

impl Folder<'_> {
    fn table<T: Serialize>(&self, name: &str, rows: &[T]) -> Result<(), FiguresError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        rows.iter().try_for_each(|row| writer.serialize(row))?;
        let text = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
        Ok(write_atomically(&self.0.join(name), &text)?)
    }

    fn figure(&self, name: &str, chart: &Chart<'_>) -> Result<(), FiguresError> {
        let svg = chart.draw().map_err(FiguresError::Draw)?;
        Ok(write_atomically(&self.0.join(name), svg.as_bytes())?)
    }
}

/// Makes all figures in a folder, and returns what became of the paper's claims.
pub fn make(folder: &Path, arithmetic: Arithmetic) -> Result<Vec<Claim>, FiguresError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| FiguresError::Folder { path: folder.to_owned(), source })?;
    let folder = Folder(folder);
    let arms = arm::make(&folder, arithmetic)?;
    let curve = static_force::make(&folder, arithmetic)?;
    let dynamics = sinusoids::make(&folder, arithmetic)?;
    let times = computation_time::make(&folder)?;
    let claims = claims::judge(&arms, &curve, &dynamics, &times);
    folder.table("claims.csv", &claims)?;
    Ok(claims)
}
