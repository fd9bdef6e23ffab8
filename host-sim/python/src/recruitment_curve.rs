//! Recruitment curve of an electrode: pulse to activation, and back.

use crate::arrays::{Column, mapped_with_flags};
use crate::choices::{self, with_scalar};
use crate::errors::refused;
use host_sim::muscle_file::curve::refusal;
use pyo3::prelude::*;
use vm_nostd::{Pulse, RecruitmentCurve as Coefficients, RecruitmentCurveParams, Scalar};

/// What is asked of a curve, and what it is a function of.
#[derive(Clone, Copy)]
enum Wanted {
    /// Of amplitude (mA) and width (µs).
    Activation,
    /// mA, of activation and width (µs).
    Amplitude,
    /// µs, of activation and amplitude (mA).
    Width,
}

/// A curve, whatever its arithmetic.
trait Built: Send + Sync {
    fn at(&self, wanted: Wanted, x: f64, y: f64) -> (f64, u16);
}

impl<S: Scalar> Built for Coefficients<S> {
    fn at(&self, wanted: Wanted, x: f64, y: f64) -> (f64, u16) {
        let quantity = |(value, status): (S::Quantity, vm_nostd::PulseStatus)| {
            (S::quantity_value(value), status.bits())
        };
        let y = S::quantity(y);
        match wanted {
            Wanted::Activation => {
                let (activation, status) =
                    self.activation(Pulse { amplitude: S::quantity(x), width: y });
                (activation.to_f64(), status.bits())
            }
            Wanted::Amplitude => quantity(self.amplitude_for(S::from_f64(x), y)),
            Wanted::Width => quantity(self.width_for(S::from_f64(x), y)),
        }
    }
}

/// Recruitment curve of an electrode and a muscle.
///
/// threshold_ma and saturation_ma: amplitudes (mA) of a very long pulse that recruits the first and
/// all fibres; chronaxie_us: pulse width (µs) at which twice these are needed, 50 to 1000; slope:
/// in the middle, relative to a straight line, 1 to 10. arithmetic: "f32", "fixed" or "f64".
/// Arguments of its methods are numbers or arrays; flags are `PulseStatus`.
#[pyclass(module = "vm_nostd", frozen)]
pub struct RecruitmentCurve {
    built: Box<dyn Built>,
    /// SI units.
    pub params: RecruitmentCurveParams,
}

impl RecruitmentCurve {
    /// A curve in SI units.
    pub fn build(params: RecruitmentCurveParams, arithmetic: &str) -> PyResult<Self> {
        let arithmetic = choices::arithmetic(arithmetic)?;
        // In the units of the arguments.
        if let Some((key, value, limit)) = refusal(&params) {
            let field = key.rsplit('.').next().unwrap_or(&key);
            return Err(refused(field, &value, &limit));
        }
        let built = with_scalar!(arithmetic, S => {
            let built = Coefficients::<S>::build(&params).map_err(crate::errors::parameter)?;
            Ok(Box::new(built) as Box<dyn Built>)
        })?;
        Ok(Self { built, params })
    }

    fn mapped<'py>(
        &self,
        py: Python<'py>,
        wanted: Wanted,
        arguments: [(&str, &Bound<'py, PyAny>); 2],
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let [(x_name, x), (y_name, y)] = arguments;
        let (x, y) = (Column::read(x_name, x)?, Column::read(y_name, y)?);
        mapped_with_flags(py, [(x_name, &x), (y_name, &y)], |[x, y]| self.built.at(wanted, x, y))
    }
}

#[pymethods]
impl RecruitmentCurve {
    #[new]
    #[pyo3(signature = (threshold_ma, saturation_ma, chronaxie_us, slope, *, arithmetic="f32"))]
    fn new(
        threshold_ma: f64,
        saturation_ma: f64,
        chronaxie_us: f64,
        slope: f64,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let values = [threshold_ma, saturation_ma, chronaxie_us, slope];
        Self::build(host_sim::muscle_file::curve::of_values(values), arithmetic)
    }

    /// Activation (0 to 1) of a pulse of an amplitude (mA) and a width (µs), and flags.
    fn activation<'py>(
        &self,
        py: Python<'py>,
        amplitude_ma: &Bound<'py, PyAny>,
        width_us: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = [("amplitude_ma", amplitude_ma), ("width_us", width_us)];
        self.mapped(py, Wanted::Activation, arguments)
    }

    /// Amplitude (mA) at which a pulse of a width (µs) has an activation (0 to 1), and flags.
    fn amplitude_for<'py>(
        &self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        width_us: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = [("activation", activation), ("width_us", width_us)];
        self.mapped(py, Wanted::Amplitude, arguments)
    }

    /// Width (µs) at which a pulse of an amplitude (mA) has an activation (0 to 1), and flags.
    fn width_for<'py>(
        &self,
        py: Python<'py>,
        activation: &Bound<'py, PyAny>,
        amplitude_ma: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let arguments = [("activation", activation), ("amplitude_ma", amplitude_ma)];
        self.mapped(py, Wanted::Width, arguments)
    }
}
