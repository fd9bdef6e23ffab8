//! Strength of a muscle: its mass or its maximal isometric force.

use super::refusal::Refusal;
use crate::reference::Muscle;

/// A mass that is always valid, kg.
pub(super) const ANY_MASS: f64 = 0.1;

/// One of two keys for the same quantity.
#[derive(Clone, Copy, Debug)]
pub(super) enum Size {
    /// `mass_g`, in kg.
    Mass(f64),
    /// `max_isometric_force_n`, F0 in N.
    Force(f64),
}

impl Size {
    /// From a file; an error if it has both keys or none.
    pub(super) fn of(
        mass_g: Option<f64>,
        max_isometric_force_n: Option<f64>,
    ) -> Result<Self, Refusal> {
        let refuse = |value: String| {
            let limit = "give exactly one of mass_g and max_isometric_force_n".to_owned();
            Err(("mass_g".to_owned(), value, limit))
        };
        match (mass_g, max_isometric_force_n) {
            (Some(grams), None) => Ok(Self::Mass(grams * 1e-3)),
            (None, Some(newtons)) => Ok(Self::Force(newtons)),
            (Some(grams), Some(newtons)) => {
                refuse(format!("{grams}, max_isometric_force_n = {newtons}"))
            }
            (None, None) => refuse("(missing)".to_owned()),
        }
    }

    /// The mass (kg) of a muscle of this size: F0 is specific tension times mass/(density x L_ce0).
    pub(super) fn mass(self, muscle: &Muscle) -> f64 {
        let e = &muscle.elements;
        match self {
            Self::Mass(kilograms) => kilograms,
            Self::Force(newtons) => newtons * e.density * muscle.L_ce0 / e.specific_tension,
        }
    }

    /// A refusal, in terms of the key in the file.
    pub(super) fn refusal(self, (key, value, limit): Refusal) -> Refusal {
        match self {
            Self::Force(newtons) if key == "mass_g" => (
                "max_isometric_force_n".to_owned(),
                newtons.to_string(),
                format!("its mass of {value} g {limit}"),
            ),
            _ => (key, value, limit),
        }
    }
}
