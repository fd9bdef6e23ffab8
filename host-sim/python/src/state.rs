//! A muscle that is being run.

use crate::arrays::saved;
use crate::errors;
use crate::inputs::{input, inputs};
use crate::results::{OUTPUT, STATUS, TRACE};
use host_sim::engine::{Row, Running, mode_name};
use host_sim::reference::{Input, Mode};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

/// Ticks between two looks for Ctrl-C.
const CHUNK: usize = 1000;

/// A muscle with its state: force (N), fascicle length (L_ce0) and velocity (L_ce0/s, positive when
/// lengthening), excitation, fatigue. From `Muscle.at_rest`.
#[pyclass(module = "vm_nostd")]
pub struct State {
    running: Box<dyn Running>,
    mode: Mode,
}

impl State {
    /// A muscle in a mode that is at rest.
    pub fn new(running: Box<dyn Running>, mode: Mode) -> Self {
        Self { running, mode }
    }
}

fn output<'py>(py: Python<'py>, (sample, status): Row) -> PyResult<Bound<'py, PyAny>> {
    let status = STATUS.of(py, (status.bits(),))?;
    OUTPUT.of(py, (sample.force, sample.fascicle_length, sample.fascicle_velocity, status))
}

/// Steps over inputs without the interpreter's lock, a row for each after `rows`.
pub fn stepped(
    py: Python<'_>,
    running: &mut Box<dyn Running>,
    inputs: &[Input],
    rows: &mut Vec<Row>,
) -> PyResult<()> {
    rows.reserve(inputs.len());
    for some in inputs.chunks(CHUNK) {
        py.detach(|| {
            some.iter().try_for_each(|&input| {
                rows.push(running.step(input)?);
                Ok(())
            })
        })
        .map_err(errors::run)?;
        py.check_signals()?;
    }
    Ok(())
}

/// Rows as arrays.
pub fn trace<'py>(py: Python<'py>, rows: &[Row]) -> PyResult<Bound<'py, PyAny>> {
    let column = |of: fn(&Row) -> f64| rows.iter().map(of).collect::<Vec<f64>>().into_pyarray(py);
    let status: Vec<u16> = rows.iter().map(|row| row.1.bits()).collect();
    TRACE.of(
        py,
        (
            column(|row| row.0.force),
            column(|row| row.0.fascicle_length),
            column(|row| row.0.fascicle_velocity),
            status.into_pyarray(py),
        ),
    )
}

#[pymethods]
impl State {
    /// The output as it is now, without flags.
    #[getter]
    fn output<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        output(py, self.running.row())
    }

    /// Steps one tick. Activation 0 to 1; path length in m at the end of the tick; stimulation
    /// frequency in pps, 0 to 500 (mode fes only).
    #[pyo3(signature = (activation, path_length_m, stimulation_frequency_pps=None))]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        activation: f64,
        path_length_m: f64,
        stimulation_frequency_pps: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let input = input(self.mode, activation, path_length_m, stimulation_frequency_pps)?;
        output(py, self.running.step(input).map_err(errors::run)?)
    }

    /// Steps one tick per row; a row of outputs for each. If it is interrupted, the state stays.
    #[pyo3(signature = (activation, path_length_m, stimulation_frequency_pps=None))]
    fn run<'py>(
        &mut self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        path_length_m: &Bound<'py, PyAny>,
        stimulation_frequency_pps: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let inputs = inputs(self.mode, activation, path_length_m, stimulation_frequency_pps)?;
        let mut running = self.running.fork();
        let mut rows = Vec::new();
        stepped(py, &mut running, &inputs, &mut rows)?;
        self.running = running;
        trace(py, &rows)
    }

    /// The state as words, fatigue included, with fingerprints of the muscle. The reference has
    /// none: copy it.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let words = self.running.save().ok_or_else(|| {
            errors::refused("arithmetic", "reference", "has no saved state; copy it instead")
        })?;
        Ok(words.into_pyarray(py))
    }

    /// Static stiffness (N/m): slope of the steady tendon force by the path at the activation that
    /// the muscle has, negative on the descending limb. In modes "continuous" and "fes" only, and
    /// not of the reference.
    fn stiffness_n_per_m(&self) -> PyResult<f64> {
        self.running.stiffness().ok_or_else(|| match self.mode {
            Mode::Continuous | Mode::Fes => {
                errors::refused("arithmetic", "reference", "must be f32, fixed or f64")
            }
            mode => errors::refused("mode", mode_name(mode), "must be continuous or fes"),
        })
    }

    /// Takes saved words back: the same muscle goes on with the same bits, another refuses them.
    fn restore(&mut self, words: &Bound<'_, PyAny>) -> PyResult<()> {
        self.running.restore(&saved(words)?).map_err(errors::run)
    }

    /// An independent copy.
    fn copy(&self) -> Self {
        Self { running: self.running.fork(), mode: self.mode }
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy()
    }
}
