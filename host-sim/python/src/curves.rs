//! Curves of a muscle: what its equations give at lengths and rates of the caller's choice.

use crate::arrays::{Column, mapped};
use crate::choices::{with_count, with_scalar};
use crate::errors::{parameter, refused};
use host_sim::engine::Arithmetic;
use host_sim::model_muscle;
use host_sim::reference::Muscle;
use pyo3::prelude::*;
use vm_nostd::{ContinuousMuscle, Scalar, TimeStep};

/// A curve.
#[derive(Clone, Copy)]
enum Curve {
    ForceLength,
    ForceVelocity,
    ActivationFrequency,
    Passive,
    Compression,
    Tendon,
}

/// The curves of a built muscle, whatever its arithmetic.
trait Built: Send + Sync {
    /// A curve of a fibre type, where it is one of a type.
    fn at(&self, curve: Curve, fiber: usize, x: [f64; 2]) -> f64;
}

impl<S: Scalar, const N: usize> Built for ContinuousMuscle<S, N> {
    fn at(&self, curve: Curve, fiber: usize, [x, y]: [f64; 2]) -> f64 {
        let curves = self.curves();
        let (length, other) = (S::from_f64(x), S::from_f64(y));
        let of_type = || curves.fiber(fiber).expect("a type that was looked for");
        match curve {
            Curve::ForceLength => of_type().force_length(length),
            Curve::ForceVelocity => of_type().force_velocity(length, other),
            Curve::ActivationFrequency => of_type().activation_frequency(length, other),
            Curve::Passive => curves.passive(length),
            Curve::Compression => curves.compression(length),
            Curve::Tendon => curves.tendon(S::path_length(y), length),
        }
        .to_f64()
    }
}

/// The curves of a muscle as its ticks compute them, in its arithmetic (not the reference). Fibre
/// types are counted from 0 in order of recruitment. Arguments are numbers or arrays.
#[pyclass(module = "vm_nostd", frozen)]
pub struct Curves {
    built: Box<dyn Built>,
    types: usize,
}

impl Curves {
    /// The curves of a muscle.
    pub fn new(parameters: &Muscle, arithmetic: Arithmetic) -> PyResult<Self> {
        let types = parameters.fibers.len();
        // The time step has no effect here.
        let step = TimeStep::MILLISECOND;
        let built = with_scalar!(arithmetic, S => with_count!("fiber", types, [1 2 3 4 5 6], N => {
            let built = ContinuousMuscle::<S, N>::build(&model_muscle::params(parameters), step);
            Ok(Box::new(built.map_err(parameter)?) as Box<dyn Built>)
        }))?;
        Ok(Self { built, types })
    }

    fn of_type<'py, const N: usize>(
        &self,
        py: Python<'py>,
        (curve, fiber): (Curve, isize),
        arguments: [(&str, &Bound<'py, PyAny>); N],
    ) -> PyResult<Bound<'py, PyAny>> {
        let Some(index) = usize::try_from(fiber).ok().filter(|&index| index < self.types) else {
            let limit = format!("must be 0 to {}", self.types - 1);
            return Err(refused("fiber", &fiber.to_string(), &limit));
        };
        let columns: Vec<Column> = arguments
            .iter()
            .map(|(name, value)| Column::read(name, value))
            .collect::<PyResult<_>>()?;
        let named = std::array::from_fn(|index| (arguments[index].0, &columns[index]));
        mapped(py, named, |x: [f64; N]| {
            self.built.at(curve, index, [x[0], x.get(1).copied().unwrap_or(0.0)])
        })
    }
}

#[pymethods]
impl Curves {
    /// Force-length relation FL of a fibre type, 0 to 1, at a fascicle length in L_ce0.
    fn force_length<'py>(
        &self,
        py: Python<'py>,
        fiber: isize,
        fascicle_length_l0: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = [("fascicle_length_l0", fascicle_length_l0)];
        self.of_type(py, (Curve::ForceLength, fiber), arguments)
    }

    /// Force-velocity relation FV of a fibre type, 1 at rest, at a fascicle length in L_ce0 and a
    /// velocity in L_ce0/s, positive when lengthening.
    fn force_velocity<'py>(
        &self,
        py: Python<'py>,
        fiber: isize,
        fascicle_length_l0: &Bound<'py, PyAny>,
        fascicle_velocity_l0_per_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = [
            ("fascicle_length_l0", fascicle_length_l0),
            ("fascicle_velocity_l0_per_s", fascicle_velocity_l0_per_s),
        ];
        self.of_type(py, (Curve::ForceVelocity, fiber), arguments)
    }

    /// Activation-frequency relation Af of a fibre type, 0 to 1, at a fascicle length in L_ce0 and
    /// a frequency in f0.5 of the type, at least 0.
    fn activation_frequency<'py>(
        &self,
        py: Python<'py>,
        fiber: isize,
        fascicle_length_l0: &Bound<'py, PyAny>,
        frequency_f05: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments =
            [("fascicle_length_l0", fascicle_length_l0), ("frequency_f05", frequency_f05)];
        self.of_type(py, (Curve::ActivationFrequency, fiber), arguments)
    }

    /// Passive force F_pe1 of the parallel element, F0, at a fascicle length in L_ce0.
    fn passive<'py>(
        &self,
        py: Python<'py>,
        fascicle_length_l0: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = [("fascicle_length_l0", fascicle_length_l0)];
        self.of_type(py, (Curve::Passive, 0), arguments)
    }

    /// Thick-filament compression F_pe2 at full activation, F0 and at most 0, at a fascicle length
    /// in L_ce0.
    fn compression<'py>(
        &self,
        py: Python<'py>,
        fascicle_length_l0: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = [("fascicle_length_l0", fascicle_length_l0)];
        self.of_type(py, (Curve::Compression, 0), arguments)
    }

    /// Tendon force F_se, F0, with fascicles of a length in L_ce0 on a path in m.
    fn tendon<'py>(
        &self,
        py: Python<'py>,
        fascicle_length_l0: &Bound<'py, PyAny>,
        path_length_m: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments =
            [("fascicle_length_l0", fascicle_length_l0), ("path_length_m", path_length_m)];
        self.of_type(py, (Curve::Tendon, 0), arguments)
    }
}
