//! A neuromuscular prosthesis: two EMGs to torque and stiffness.

use crate::antagonists::{Antagonists, time_step, words};
use crate::arrays::{number, saved};
use crate::choices::{self, with_count, with_scalar};
use crate::errors;
use crate::joint::Joint;
use crate::results::{PROSTHESIS_COMMAND, PROSTHESIS_STATUS, STATUS};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use vm_nostd::Scalar;
use vm_nostd::control::{
    CommandLimits, EnvelopeParams, Prosthesis as Coefficients, ProsthesisCommand, ProsthesisInput,
    ProsthesisParams, ProsthesisState,
};

/// Ticks of the delay line: the longest electromechanical delay is that many time steps.
const DELAY: usize = 100;

/// A command in the units of Python.
struct Command {
    torque: f64,
    stiffness: f64,
    activations: [f64; 2],
    muscles: [u16; 2],
    status: u16,
}

impl<S: Scalar> From<ProsthesisCommand<S>> for Command {
    fn from(command: ProsthesisCommand<S>) -> Self {
        Self {
            torque: S::quantity_value(command.torque),
            stiffness: S::quantity_value(command.stiffness),
            activations: command.activations.map(S::to_f64),
            muscles: command.muscles.map(|status| status.bits()),
            status: command.status.bits(),
        }
    }
}

/// A prosthesis with its state, whatever its arithmetic.
trait Moving: Send + Sync {
    /// `emg` in mV, `angle` in rad.
    fn step(&mut self, emg: [f64; 2], angle: f64) -> Command;
    fn save(&self) -> Vec<u64>;
    /// The problem, if the words are refused.
    fn restore(&mut self, words: &[u64]) -> Result<(), String>;
}

struct Running<S: Scalar, const N: usize> {
    prosthesis: Coefficients<S, N, DELAY>,
    state: ProsthesisState<S, N, DELAY>,
}

impl<S: Scalar, const N: usize> Moving for Running<S, N> {
    fn step(&mut self, emg: [f64; 2], angle: f64) -> Command {
        let input = ProsthesisInput { emg: emg.map(S::quantity), angle: S::from_f64(angle) };
        self.prosthesis.step(&mut self.state, input).into()
    }

    fn save(&self) -> Vec<u64> {
        self.prosthesis.save(&self.state).map(Into::into).collect()
    }

    fn restore(&mut self, given: &[u64]) -> Result<(), String> {
        let words: Vec<S::Bits> = words(given)?;
        self.state = self.prosthesis.restore(words).map_err(|error| error.to_string())?;
        Ok(())
    }
}

/// Two EMGs drive a virtual flexor and extensor, whose torque and stiffness command a joint; with
/// its state, at rest at an angle (rad).
///
/// envelopes: of flexor and extensor, `Envelope`. torque_limits: least and greatest (N m), and
/// N m/s, -60, 60 and 1000 if not given; stiffness_limits: the same in N m/rad and N m/rad/s, 0,
/// 100 and 1000 if not given.
#[pyclass(module = "vm_nostd")]
pub struct Prosthesis {
    moving: Box<dyn Moving>,
}

#[pymethods]
impl Prosthesis {
    #[new]
    #[pyo3(signature = (
        joint, envelopes, angle_rad, *, torque_limits=(-60.0, 60.0, 1000.0),
        stiffness_limits=(0.0, 100.0, 1000.0), time_step_s=1e-3, arithmetic="f32"
    ))]
    fn new(
        joint: &Bound<'_, Joint>,
        envelopes: [(f64, f64, f64, f64, f64); 2],
        angle_rad: f64,
        torque_limits: (f64, f64, f64),
        stiffness_limits: (f64, f64, f64),
        time_step_s: f64,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let pair = Antagonists::of(joint.get())?;
        let step = time_step(time_step_s)?;
        let angle = number("angle_rad", angle_rad)?;
        let envelope = |(rest, maximal, cutoff_frequency, delay, shape)| EnvelopeParams {
            rest,
            maximal,
            cutoff_frequency,
            delay,
            shape,
        };
        let limits = |(least, most, rate)| CommandLimits { least, most, rate };
        let moving = with_scalar!(choices::arithmetic(arithmetic)?, S => with_count!(
            "fiber", pair.types, [1 2 3], N => {
                let params = ProsthesisParams::<N> {
                    range: pair.range,
                    muscles: pair.params(),
                    paths: pair.paths,
                    envelopes: envelopes.map(envelope),
                    torque: limits(torque_limits),
                    stiffness: limits(stiffness_limits),
                };
                let prosthesis =
                    Coefficients::<S, N, DELAY>::build(&params, step).map_err(errors::joint)?;
                let state = prosthesis.rest(S::from_f64(angle)).map_err(errors::parameter)?;
                Ok(Box::new(Running { prosthesis, state }) as Box<dyn Moving>)
            }
        ))?;
        Ok(Self { moving })
    }

    /// Steps one tick: the EMG of flexor and extensor (mV) and the measured angle (rad).
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        emg_mv: (f64, f64),
        angle_rad: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let emg = [number("emg_mv[0]", emg_mv.0)?, number("emg_mv[1]", emg_mv.1)?];
        let command = self.moving.step(emg, number("angle_rad", angle_rad)?);
        let [flexor, extensor] = command.muscles;
        PROSTHESIS_COMMAND.of(
            py,
            (
                command.torque,
                command.stiffness,
                <(f64, f64)>::from(command.activations),
                (STATUS.of(py, (flexor,))?, STATUS.of(py, (extensor,))?),
                PROSTHESIS_STATUS.of(py, (command.status,))?,
            ),
        )
    }

    /// The state as words, with a fingerprint of the prosthesis.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        self.moving.save().into_pyarray(py)
    }

    /// Takes saved words back; those of another prosthesis are refused.
    fn restore(&mut self, words: &Bound<'_, PyAny>) -> PyResult<()> {
        let words = saved(words)?;
        self.moving.restore(&words).map_err(|problem| errors::restore(words.len(), &problem))
    }
}
