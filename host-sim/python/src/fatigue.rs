//! Fatigue and recovery: fitness, a factor on force.

use crate::arrays::{Column, each_row, number, rows, saved};
use crate::choices::{self, with_scalar};
use crate::errors::{parameter, refused, restore};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyType;
use vm_nostd::{Fatigue as Coefficients, FatigueParams, FatigueState, Scalar, TimeStep};

/// Natural recruitment tires like stimulation at this frequency, pps.
const NATURAL: f64 = 100.0;

/// Fatigue with its state, whatever its arithmetic.
trait Tiring: Send + Sync {
    fn rest(&mut self);
    fn fitness(&self) -> f64;
    fn advance(&mut self, activation: f64, frequency: f64) -> f64;
    fn save(&self) -> Vec<u64>;
    /// The problem, if the words are refused.
    fn restore(&mut self, words: &[u64]) -> Result<(), String>;
}

struct Tired<S: Scalar> {
    fatigue: Coefficients<S>,
    state: FatigueState<S>,
}

impl<S: Scalar> Tiring for Tired<S> {
    fn rest(&mut self) {
        self.state = self.fatigue.rested();
    }

    fn fitness(&self) -> f64 {
        self.state.fitness().to_f64()
    }

    fn advance(&mut self, activation: f64, frequency: f64) -> f64 {
        let (activation, frequency) = (S::from_f64(activation), S::quantity(frequency));
        self.fatigue.advance(&mut self.state, activation, frequency).to_f64()
    }

    fn save(&self) -> Vec<u64> {
        self.fatigue.save(&self.state).map(Into::into).collect()
    }

    fn restore(&mut self, words: &[u64]) -> Result<(), String> {
        let words: Result<Vec<S::Bits>, _> =
            words.iter().map(|&word| S::Bits::try_from(word)).collect();
        let words = words.map_err(|_| "a word is too large for the arithmetic".to_owned())?;
        self.state = self.fatigue.restore(words).map_err(|error| error.to_string())?;
        Ok(())
    }
}

/// Fatigue and recovery of a muscle (Riener, Quintern & Schmidt 1996), with its state.
///
/// fatigue_time_s and recovery_time_s: 1 to 1000 s; least_fitness: 0 to 1; frequency_dependence: 0
/// (none) to 1; time_step_s: 1e-4 to 2e-3; arithmetic: "f32", "fixed" or "f64".
#[pyclass(module = "vm_nostd")]
pub struct Fatigue {
    tiring: Box<dyn Tiring>,
}

impl Fatigue {
    fn build(params: &FatigueParams, time_step_s: f64, arithmetic: &str) -> PyResult<Self> {
        let step = TimeStep::from_seconds(time_step_s).map_err(parameter)?;
        let tiring = with_scalar!(choices::arithmetic(arithmetic)?, S => {
            let fatigue = Coefficients::<S>::build(params, step).map_err(parameter)?;
            let state = fatigue.rested();
            Ok(Box::new(Tired { fatigue, state }) as Box<dyn Tiring>)
        })?;
        Ok(Self { tiring })
    }
}

#[pymethods]
impl Fatigue {
    #[new]
    #[pyo3(signature = (
        fatigue_time_s, recovery_time_s, least_fitness, frequency_dependence,
        *, time_step_s=1e-3, arithmetic="f32"
    ))]
    fn new(
        fatigue_time_s: f64,
        recovery_time_s: f64,
        least_fitness: f64,
        frequency_dependence: f64,
        time_step_s: f64,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let params = FatigueParams {
            fatigue_time: fatigue_time_s,
            recovery_time: recovery_time_s,
            least_fitness,
            frequency_dependence,
        };
        Self::build(&params, time_step_s, arithmetic)
    }

    /// Paralysed human quadriceps (Riener, Quintern & Schmidt 1996).
    #[classmethod]
    #[pyo3(signature = (*, time_step_s=1e-3, arithmetic="f32"))]
    fn quadriceps(_: &Bound<'_, PyType>, time_step_s: f64, arithmetic: &str) -> PyResult<Self> {
        Self::build(&FatigueParams::QUADRICEPS, time_step_s, arithmetic)
    }

    /// Fitness now, 0 to 1.
    #[getter]
    fn fitness(&self) -> f64 {
        self.tiring.fitness()
    }

    /// Rests until fitness is 1.
    fn rest(&mut self) {
        self.tiring.rest();
    }

    /// Advances one tick at an activation (0 to 1) and a stimulation frequency (pps; 100 for
    /// natural recruitment); the new fitness.
    #[pyo3(signature = (activation, stimulation_frequency_pps=100.0))]
    fn advance(&mut self, activation: f64, stimulation_frequency_pps: f64) -> PyResult<f64> {
        let activation = number("activation", activation)?;
        let frequency = number("stimulation_frequency_pps", stimulation_frequency_pps)?;
        Ok(self.tiring.advance(activation, frequency))
    }

    /// Advances one tick per row; the fitness after each. If it is interrupted, the state stays.
    #[pyo3(signature = (activation, stimulation_frequency_pps=None))]
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        stimulation_frequency_pps: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let activation = Column::read("activation", activation)?;
        let frequency = match stimulation_frequency_pps {
            Some(frequency) => Column::read("stimulation_frequency_pps", frequency)?,
            None => Column::Constant(NATURAL),
        };
        let columns = [("activation", &activation), ("stimulation_frequency_pps", &frequency)];
        let count = rows(columns)?.ok_or_else(|| {
            refused("activation", "a number", "one input at least must be an array")
        })?;
        let before = self.tiring.save();
        let tiring = &mut self.tiring;
        let fitness =
            each_row(py, count, |row| tiring.advance(activation.at(row), frequency.at(row)));
        if fitness.is_err() {
            self.tiring.restore(&before).map_err(|problem| restore(before.len(), &problem))?;
        }
        Ok(fitness?.into_pyarray(py))
    }

    /// The state as words, with a fingerprint.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        self.tiring.save().into_pyarray(py)
    }

    /// Takes saved words back; words of other fatigue are refused.
    fn restore(&mut self, words: &Bound<'_, PyAny>) -> PyResult<()> {
        let words = saved(words)?;
        self.tiring.restore(&words).map_err(|problem| restore(words.len(), &problem))
    }
}
