//! A muscle: parameters, mode, arithmetic, accuracy class and time step.

use crate::choices;
use crate::curves::Curves;
use crate::errors;
use crate::inputs::inputs;
use crate::recruitment_curve::RecruitmentCurve;
use crate::source;
use crate::state::{State, stepped, trace};
use crate::steady::Steady;
use host_sim::engine::{self, Arithmetic, Class, Running, mode_name};
use host_sim::fit::Start;
use host_sim::model_muscle;
use host_sim::reference::{Mode, Muscle as Parameters};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

/// A muscle of a name (`muscle_names()`), of a muscle file (TOML, by its path), or of a dict with
/// the keys of one (`mass_g`, `fascicle_length_cm`, ...).
///
/// mode: "continuous" (natural), "fes" (intramuscular), "discrete" or "discrete-leff" (motor
/// units). arithmetic: "f32", "fixed", "f64" or "reference". accuracy_class: "economy",
/// "standard" or "fine"; None: that of the muscle file. time_step_s: 1e-4 to 2e-3.
#[pyclass(module = "vm_nostd", frozen)]
pub struct Muscle {
    /// The muscle and its file.
    pub start: Start,
    /// Recruitment mode.
    pub mode: Mode,
    /// Arithmetic.
    pub arithmetic: Arithmetic,
    /// Accuracy class.
    pub class: Class,
    /// s.
    pub time_step: f64,
}

/// How a muscle is computed.
struct Choice<'a> {
    mode: &'a str,
    arithmetic: &'a str,
    accuracy_class: Option<&'a str>,
    time_step_s: f64,
}

impl Muscle {
    fn chosen(start: Start, choice: &Choice<'_>) -> PyResult<Self> {
        let class = choice.accuracy_class.map(choices::class).transpose()?;
        let muscle = Self {
            mode: choices::mode(choice.mode)?,
            arithmetic: choices::arithmetic(choice.arithmetic)?,
            class: class.unwrap_or(start.named.class),
            time_step: choice.time_step_s,
            start,
        };
        host_sim::trace::check_time_step(muscle.time_step, 1.0).map_err(|limit| {
            errors::refused("time_step_s", &muscle.time_step.to_string(), &limit)
        })?;
        // What an arithmetic or a mode refuses is refused now.
        let (shortest, longest) = muscle.path_domain();
        muscle.resting(0.5 * (shortest + longest))?;
        Ok(muscle)
    }

    /// The muscle of a muscle file's text, with the usual time step.
    pub fn of_text(text: &str, mode: &str, arithmetic: &str) -> PyResult<Self> {
        let start = source::text_of_muscle(text, "text")?;
        let choice = Choice { mode, arithmetic, accuracy_class: None, time_step_s: 1e-3 };
        Self::chosen(start, &choice)
    }

    /// The parameters in the paper's symbols.
    pub fn parameters(&self) -> &Parameters {
        &self.start.named.muscle
    }

    fn path_domain(&self) -> (f64, f64) {
        model_muscle::path_domain(self.parameters())
    }

    fn resting(&self, path_length: f64) -> PyResult<Box<dyn Running>> {
        let (shortest, longest) = self.path_domain();
        // The reference would rest anywhere.
        if !(shortest..=longest).contains(&path_length) {
            let limit = format!("must be {shortest} to {longest} at rest");
            return Err(errors::refused("path_length_m", &path_length.to_string(), &limit));
        }
        engine::at_rest_in_class(
            self.parameters(),
            self.mode,
            self.arithmetic,
            self.class,
            self.time_step,
            path_length,
        )
        .map_err(errors::run)
    }
}

#[pymethods]
impl Muscle {
    #[new]
    #[pyo3(signature = (
        muscle, *, mode="continuous", arithmetic="f32", accuracy_class=None, time_step_s=1e-3
    ))]
    fn new(
        muscle: &Bound<'_, PyAny>,
        mode: &str,
        arithmetic: &str,
        accuracy_class: Option<&str>,
        time_step_s: f64,
    ) -> PyResult<Self> {
        let start = source::muscle(muscle)?;
        Self::chosen(start, &Choice { mode, arithmetic, accuracy_class, time_step_s })
    }

    /// A muscle of the text of a muscle file.
    #[classmethod]
    #[pyo3(signature = (
        text, *, mode="continuous", arithmetic="f32", accuracy_class=None, time_step_s=1e-3
    ))]
    fn from_toml(
        _: &Bound<'_, PyType>,
        text: &str,
        mode: &str,
        arithmetic: &str,
        accuracy_class: Option<&str>,
        time_step_s: f64,
    ) -> PyResult<Self> {
        let start = source::text_of_muscle(text, "text")?;
        Self::chosen(start, &Choice { mode, arithmetic, accuracy_class, time_step_s })
    }

    /// The same muscle with another mode, arithmetic, accuracy class or time step (s).
    #[pyo3(signature = (*, mode=None, arithmetic=None, accuracy_class=None, time_step_s=None))]
    fn replace(
        &self,
        mode: Option<&str>,
        arithmetic: Option<&str>,
        accuracy_class: Option<&str>,
        time_step_s: Option<f64>,
    ) -> PyResult<Self> {
        let choice = Choice {
            mode: mode.unwrap_or(mode_name(self.mode)),
            arithmetic: arithmetic.unwrap_or(self.arithmetic.name()),
            accuracy_class: accuracy_class.or(Some(self.class.name())),
            time_step_s: time_step_s.unwrap_or(self.time_step),
        };
        Self::chosen(self.start.clone(), &choice)
    }

    /// The muscle at rest on a path of a length in m, within `path_domain_m`.
    fn at_rest(&self, path_length_m: f64) -> PyResult<State> {
        Ok(State::new(self.resting(path_length_m)?, self.mode))
    }

    /// Runs from rest: force (N), fascicle length (L_ce0), velocity (L_ce0/s) and status flags, one
    /// row per row of inputs. The first row is the muscle at rest on its path; activation (0 to 1)
    /// and stimulation frequency (pps, 0 to 500; mode fes only) of a row apply to the tick that
    /// ends there, and the path (m) is linear from row to row. The bits are those of `vm run`.
    ///
    /// Inputs are arrays of equal length, or numbers. Out of range they are clipped and flagged;
    /// what is not a finite number is refused.
    #[pyo3(signature = (activation, path_length_m, stimulation_frequency_pps=None))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        path_length_m: &Bound<'py, PyAny>,
        stimulation_frequency_pps: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let inputs = inputs(self.mode, activation, path_length_m, stimulation_frequency_pps)?;
        let Some((first, others)) = inputs.split_first() else {
            return Err(errors::refused("activation", "0 numbers", "must be at least 1"));
        };
        let mut running = self.resting(first.path_length)?;
        let mut rows = vec![running.row()];
        stepped(py, &mut running, others, &mut rows)?;
        trace(py, &rows)
    }

    /// Its curves, in its arithmetic (not the reference).
    fn curves(&self) -> PyResult<Curves> {
        Curves::new(self.parameters(), self.arithmetic)
    }

    /// Its steady inverse, in mode "fes" or "continuous" and its arithmetic (not the reference).
    fn steady(&self) -> PyResult<Steady> {
        Steady::new(self.parameters(), self.mode, self.arithmetic)
    }

    /// The recruitment curve in its file, if there is one.
    #[getter]
    fn recruitment_curve(&self) -> PyResult<Option<RecruitmentCurve>> {
        let arithmetic = match self.arithmetic {
            Arithmetic::Reference => Arithmetic::F64,
            other => other,
        };
        let curve = self.start.named.curve;
        curve.map(|curve| RecruitmentCurve::build(curve, arithmetic.name())).transpose()
    }

    /// Name.
    #[getter]
    fn name(&self) -> &str {
        &self.start.named.name
    }

    /// Recruitment mode.
    #[getter]
    fn mode(&self) -> &'static str {
        mode_name(self.mode)
    }

    /// Arithmetic.
    #[getter]
    fn arithmetic(&self) -> &'static str {
        self.arithmetic.name()
    }

    /// Accuracy class; the reference has none.
    #[getter]
    fn accuracy_class(&self) -> &'static str {
        self.class.name()
    }

    /// Time step, s.
    #[getter]
    fn time_step_s(&self) -> f64 {
        self.time_step
    }

    /// Maximal isometric force F0, N.
    #[getter]
    fn max_isometric_force_n(&self) -> f64 {
        self.parameters().f0()
    }

    /// Mass, kg.
    #[getter]
    fn mass_kg(&self) -> f64 {
        self.parameters().mass
    }

    /// Optimal fascicle length L_ce0, m.
    #[getter]
    fn fascicle_length_m(&self) -> f64 {
        self.parameters().L_ce0
    }

    /// Optimal tendon length L_se0, m: at F0.
    #[getter]
    fn tendon_length_m(&self) -> f64 {
        self.parameters().L_se0
    }

    /// Shortest and longest path on which the muscle can rest, m. Others are clipped and flagged.
    #[getter]
    fn path_domain_m(&self) -> (f64, f64) {
        self.path_domain()
    }

    /// Shares of the fibre types in the cross section, in order of recruitment; they add to 1.
    #[getter]
    fn fractions(&self) -> Vec<f64> {
        self.parameters().fibers.iter().map(|fiber| fiber.fraction).collect()
    }

    /// The muscle as a muscle file, for `vm run --muscle`. Mode, arithmetic and time step are not
    /// in it.
    fn to_toml(&self) -> PyResult<String> {
        let mut table = self.start.table.clone();
        if self.class != self.start.named.class {
            table.insert("class".to_owned(), self.class.name().into());
        }
        toml::to_string(&table)
            .map_err(|error| errors::refused("muscle", "table", &error.to_string()))
    }

    /// What `copy` and `pickle` make the same muscle from.
    fn __getnewargs_ex__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyTuple>, Bound<'py, PyDict>)> {
        let dict = py.import("tomllib")?.call_method1("loads", (self.to_toml()?,))?;
        let choice = PyDict::new(py);
        choice.set_item("mode", self.mode())?;
        choice.set_item("arithmetic", self.arithmetic())?;
        choice.set_item("time_step_s", self.time_step)?;
        Ok((PyTuple::new(py, [dict])?, choice))
    }

    fn __repr__(&self) -> String {
        format!(
            "Muscle({:?}, mode={:?}, arithmetic={:?}, accuracy_class={:?}, time_step_s={})",
            self.name(),
            self.mode(),
            self.arithmetic(),
            self.accuracy_class(),
            self.time_step
        )
    }
}

/// Names of the built-in human muscles.
#[pyfunction]
pub fn muscle_names() -> Vec<String> {
    host_sim::muscles::all().into_iter().map(|muscle| muscle.name).collect()
}
