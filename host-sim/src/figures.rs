//! The paper's figures, reproduced as SVG with their numbers in CSV, and its claims.
//!
//! Source: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184, section 3.

mod arm;
mod claim;
mod claims;
mod computation;
mod files;
mod setting;
mod sinusoids;
mod static_force;

pub use arm::{ACTIVATIONS as ARM_ACTIVATIONS, DURATION as ARM_DURATION, START as ARM_START};
pub use claim::Claim;
pub use files::{Figures, FiguresError};

use crate::engine::Arithmetic;
use std::path::Path;

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
}

/// Writes all figures to a folder and returns the paper's claims.
pub fn make(folder: &Path, arithmetic: Arithmetic) -> Result<Vec<Claim>, FiguresError> {
    let figures = Figures::draw(arithmetic)?;
    figures.write(folder)?;
    Ok(figures.claims)
}
