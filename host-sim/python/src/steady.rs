//! Steady states: the force that a held input gives, and the activation that holds a force.

use crate::arrays::{Column, mapped_with_flags};
use crate::choices::{with_count, with_scalar};
use crate::errors::{parameter, refused};
use host_sim::engine::{Arithmetic, mode_name};
use host_sim::model_muscle;
use host_sim::reference::{Mode, Muscle};
use pyo3::prelude::*;
use vm_nostd::control::SteadyNatural;
use vm_nostd::{Input, Scalar, SteadyFes};

/// A steady inverse, whatever its mode and arithmetic; forces in F0, paths in m.
trait Held: Send + Sync {
    fn activation_for(&self, force: f64, path: f64, frequency: f64) -> (f64, u16);
    fn force(&self, activation: f64, path: f64, frequency: f64) -> Option<(f64, u16)>;
}

impl<S: Scalar, const N: usize> Held for SteadyFes<S, N> {
    fn activation_for(&self, force: f64, path: f64, frequency: f64) -> (f64, u16) {
        let (path, frequency) = (S::path_length(path), S::quantity(frequency));
        let steady = self.activation_for_relative(S::from_f64(force), path, frequency);
        (steady.activation.to_f64(), steady.status.bits())
    }

    fn force(&self, activation: f64, path: f64, frequency: f64) -> Option<(f64, u16)> {
        let steady = SteadyFes::force(
            self,
            Input {
                activation: S::from_f64(activation),
                path_length: S::path_length(path),
                stimulation_frequency: S::quantity(frequency),
            },
        );
        Some((steady.relative_force.to_f64(), steady.status.bits()))
    }
}

impl<S: Scalar, const N: usize> Held for SteadyNatural<S, N> {
    fn activation_for(&self, force: f64, path: f64, _: f64) -> (f64, u16) {
        let (activation, status) =
            self.nearest_activation(S::from_f64(force), S::path_length(path));
        (activation.to_f64(), status.bits())
    }

    fn force(&self, _: f64, _: f64, _: f64) -> Option<(f64, u16)> {
        None
    }
}

/// The steady inverse of a muscle in mode "fes" or "continuous", in its arithmetic (not the
/// reference). Arguments are numbers or arrays. From `Muscle.steady`.
#[pyclass(module = "vm_nostd", frozen)]
pub struct Steady {
    held: Box<dyn Held>,
    /// F0, N.
    f0: f64,
    stimulated: bool,
}

impl Steady {
    /// The inverse of a muscle.
    pub fn new(parameters: &Muscle, mode: Mode, arithmetic: Arithmetic) -> PyResult<Self> {
        let types = parameters.fibers.len();
        let held = with_scalar!(arithmetic, S => with_count!("fiber", types, [1 2 3 4 5 6], N => {
            let params = model_muscle::params::<N>(parameters);
            match mode {
                Mode::Fes => {
                    let built = SteadyFes::<S, N>::build(&params).map_err(parameter)?;
                    Ok(Box::new(built) as Box<dyn Held>)
                }
                Mode::Continuous => {
                    let built = SteadyNatural::<S, N>::build(&params).map_err(parameter)?;
                    Ok(Box::new(built) as Box<dyn Held>)
                }
                mode => Err(refused("mode", mode_name(mode), "must be fes or continuous")),
            }
        }))?;
        Ok(Self { held, f0: parameters.f0(), stimulated: mode == Mode::Fes })
    }

    fn frequency(&self, given: Option<&Bound<'_, PyAny>>) -> PyResult<Column> {
        let name = "stimulation_frequency_pps";
        match given {
            Some(frequency) => Column::read(name, frequency),
            None if self.stimulated => Err(refused(name, "None", "must be given in mode fes")),
            None => Ok(Column::Constant(0.0)),
        }
    }
}

#[pymethods]
impl Steady {
    /// Activation (0 to 1) that holds a force (N) on a path (m), in mode fes at a stimulation
    /// frequency (pps), and flags: `Status.FORCE_UNREACHABLE` where none does; the activation is
    /// then that of the nearest force.
    #[pyo3(signature = (force_n, path_length_m, stimulation_frequency_pps=None))]
    fn activation_for<'py>(
        &self,
        py: Python<'py>,
        force_n: &Bound<'py, PyAny>,
        path_length_m: &Bound<'py, PyAny>,
        stimulation_frequency_pps: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let force = Column::read("force_n", force_n)?;
        let path = Column::read("path_length_m", path_length_m)?;
        let frequency = self.frequency(stimulation_frequency_pps)?;
        let columns = [
            ("force_n", &force),
            ("path_length_m", &path),
            ("stimulation_frequency_pps", &frequency),
        ];
        mapped_with_flags(py, columns, |[force, path, frequency]| {
            self.held.activation_for(force / self.f0, path, frequency)
        })
    }

    /// Steady tendon force (N) of an activation (0 to 1) on a path (m) at a stimulation frequency
    /// (pps), and flags. Mode fes only.
    fn force<'py>(
        &self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        path_length_m: &Bound<'py, PyAny>,
        stimulation_frequency_pps: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        if !self.stimulated {
            return Err(refused("mode", "continuous", "must be fes: run the muscle instead"));
        }
        let activation = Column::read("activation", activation)?;
        let path = Column::read("path_length_m", path_length_m)?;
        let frequency = self.frequency(Some(stimulation_frequency_pps))?;
        let columns = [
            ("activation", &activation),
            ("path_length_m", &path),
            ("stimulation_frequency_pps", &frequency),
        ];
        mapped_with_flags(py, columns, |[activation, path, frequency]| {
            let held = self.held.force(activation, path, frequency);
            let (force, flags) = held.unwrap_or((f64::NAN, 0));
            (force * self.f0, flags)
        })
    }
}
