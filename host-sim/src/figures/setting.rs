//! Muscles, path and time step shared by the figures.

use crate::reference::{Mode, Muscle};
use crate::scenario::{paper_muscle, paper_muscle_of_units};

/// A way of recruiting the paper's muscle.
#[derive(Clone, Debug)]
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) mode: Mode,
    pub(super) muscle: Muscle,
}

/// Natural continuous recruitment, and discrete recruitment of 3 + 3 and of 30 + 30 motor units.
pub(super) fn cases() -> [Case; 3] {
    let discrete =
        |name, units| Case { name, mode: Mode::Discrete, muscle: paper_muscle_of_units(units) };
    [
        Case { name: "continuous", mode: Mode::Continuous, muscle: paper_muscle() },
        discrete("discrete 3 + 3", 3),
        discrete("discrete 30 + 30", 30),
    ]
}

/// Path of the paper's static figures and activation sinusoids, m.
pub(super) const PATH: f64 = 0.16;
/// Time step of all figures, s.
pub(super) const TIME_STEP: f64 = 1e-3;
