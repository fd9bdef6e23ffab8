//! The Python package `vm_nostd`: `vm-nostd` and `host-sim` over NumPy arrays.
//!
//! Everything runs in Rust, with the bits of `vm run`. Arguments are checked before anything runs;
//! runs release the interpreter's lock. Names have units.

mod antagonists;
mod arguments;
mod arrays;
mod choices;
mod controller;
mod curves;
mod errors;
mod fatigue;
mod fit;
mod flags;
mod inputs;
mod joint;
mod muscle;
mod prosthesis;
mod recruitment_curve;
mod results;
mod source;
mod state;
mod steady;

use pyo3::prelude::*;

/// What `vm_nostd` is made of.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::arrays::numbers;
    #[pymodule_export]
    use super::controller::FesController;
    #[pymodule_export]
    use super::curves::Curves;
    #[pymodule_export]
    use super::fatigue::Fatigue;
    #[pymodule_export]
    use super::fit::{Fit, fit};
    #[pymodule_export]
    use super::flags::flags;
    #[pymodule_export]
    use super::joint::{Joint, JointPath};
    #[pymodule_export]
    use super::muscle::{Muscle, muscle_names};
    #[pymodule_export]
    use super::prosthesis::Prosthesis;
    #[pymodule_export]
    use super::recruitment_curve::RecruitmentCurve;
    #[pymodule_export]
    use super::state::State;
    #[pymodule_export]
    use super::steady::Steady;
}
