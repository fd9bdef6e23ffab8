//! The paper's figures, reproduced as SVG with their numbers in CSV, and its claims.
//!
//! Source: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, section 3.

mod arm;
mod claims;
mod computation;
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
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The arm failed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The folder could not be created.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A table could not be serialised.
    #[error(transparent)]
    Table(#[from] csv::Error),
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

/// The figures and their tables, by the name of the file.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    files: Vec<(&'static str, Vec<u8>)>,
    /// The paper's claims.
    pub claims: Vec<Claim>,
}

impl Figures {
    /// Computes all figures.
    pub fn draw(arithmetic: Arithmetic) -> Result<Self, FiguresError> {
        let mut figures = Self::default();
        let arms = arm::make(&mut figures, arithmetic)?;
        let step = static_force::make(&mut figures, arithmetic)?;
        let dynamics = sinusoids::make(&mut figures, arithmetic)?;
        let costs = computation::make(&mut figures)?;
        figures.claims = claims::judge(&arms, step, &dynamics, &costs);
        let claims = figures.claims.clone();
        figures.table("claims.csv", &claims)?;
        Ok(figures)
    }

    /// Writes all files into a folder, which is created if missing.
    pub fn write(&self, folder: &Path) -> Result<(), FiguresError> {
        std::fs::create_dir_all(folder)
            .map_err(|source| FiguresError::Folder { path: folder.to_owned(), source })?;
        for (name, bytes) in &self.files {
            write_atomically(&folder.join(name), bytes)?;
        }
        Ok(())
    }

    /// The text of a file.
    pub fn file(&self, name: &str) -> Option<&str> {
        let (_, bytes) = self.files.iter().find(|(file, _)| *file == name)?;
        std::str::from_utf8(bytes).ok()
    }

    fn table<T: Serialize>(&mut self, name: &'static str, rows: &[T]) -> Result<(), FiguresError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        rows.iter().try_for_each(|row| writer.serialize(row))?;
        let text = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
        self.files.push((name, text));
        Ok(())
    }

    fn figure(&mut self, name: &'static str, chart: &Chart<'_>) {
        self.files.push((name, chart.draw().into_bytes()));
    }
}

/// Writes all figures to a folder and returns the paper's claims.
pub fn make(folder: &Path, arithmetic: Arithmetic) -> Result<Vec<Claim>, FiguresError> {
    let figures = Figures::draw(arithmetic)?;
    figures.write(folder)?;
    Ok(figures.claims)
}
