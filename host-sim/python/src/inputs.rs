//! The inputs of a run: three columns, one row per tick.

use crate::arrays::{Column, number, rows};
use crate::errors::refused;
use host_sim::reference::{Input, Mode};
use pyo3::prelude::*;

/// What a mode takes a missing stimulation frequency for.
fn without_frequency(mode: Mode) -> PyResult<f64> {
    match mode {
        Mode::Fes => {
            Err(refused("stimulation_frequency_pps", "None", "must be given in mode fes: 0 to 500"))
        }
        _ => Ok(0.0),
    }
}

/// Inputs of a run: each a number or an array, at least one of them an array.
pub fn inputs(
    mode: Mode,
    activation: &Bound<'_, PyAny>,
    path_length_m: &Bound<'_, PyAny>,
    stimulation_frequency_pps: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Input>> {
    let activation = Column::read("activation", activation)?;
    let path = Column::read("path_length_m", path_length_m)?;
    let frequency = match stimulation_frequency_pps {
        Some(frequency) => Column::read("stimulation_frequency_pps", frequency)?,
        None => Column::Constant(without_frequency(mode)?),
    };
    let columns = [
        ("activation", &activation),
        ("path_length_m", &path),
        ("stimulation_frequency_pps", &frequency),
    ];
    let count = rows(columns)?
        .ok_or_else(|| refused("activation", "a number", "one input at least must be an array"))?;
    let input = |row| Input {
        activation: activation.at(row),
        path_length: path.at(row),
        stimulation_frequency: frequency.at(row),
    };
    Ok((0..count).map(input).collect())
}

/// The input of a tick.
pub fn input(
    mode: Mode,
    activation: f64,
    path_length_m: f64,
    stimulation_frequency_pps: Option<f64>,
) -> PyResult<Input> {
    let frequency = stimulation_frequency_pps.map_or_else(|| without_frequency(mode), Ok)?;
    Ok(Input {
        activation: number("activation", activation)?,
        path_length: number("path_length_m", path_length_m)?,
        stimulation_frequency: number("stimulation_frequency_pps", frequency)?,
    })
}
