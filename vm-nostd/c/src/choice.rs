//! Numbers that C chooses by.

use model::{Limit, ParameterError};

/// What a number of C stands for: one of `choices`, which are numbered from 0. Refused with the
/// field's name if it stands for nothing.
pub fn choice<T: Copy>(
    field: &'static str,
    number: u32,
    choices: &[(u32, T)],
) -> Result<T, ParameterError> {
    let chosen = choices.iter().find(|(known, _)| *known == number);
    chosen.map(|(_, choice)| *choice).ok_or(ParameterError {
        field,
        fiber: None,
        value: number.into(),
        limit: Limit::Within { least: 0.0, most: choices.len().saturating_sub(1) as f64 },
    })
}

/// 0 or 1.
pub const FLAG: [(u32, bool); 2] = [(0, false), (1, true)];
