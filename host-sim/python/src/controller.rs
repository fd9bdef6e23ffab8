//! FES controller of a joint's angle or torque.

use crate::antagonists::{Antagonists, time_step, words};
use crate::arrays::{number, saved};
use crate::choices::{self, with_count, with_scalar};
use crate::errors::{self, refused};
use crate::joint::Joint;
use crate::recruitment_curve::RecruitmentCurve;
use crate::results::{COMMAND, CONTROL_STATUS, STATUS};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use vm_nostd::control::{
    FesCommand, FesController as Coefficients, FesControllerParams, FesControllerState, GainParams,
    LimbParams, Measured, Modulation, PiParams, Sensors, Target,
};
use vm_nostd::{FatigueParams, Scalar};

/// A command in the units of Python.
struct Command {
    activations: [f64; 2],
    amplitudes_ma: [f64; 2],
    widths_us: [f64; 2],
    torque: f64,
    gain: f64,
    muscles: [u16; 2],
    status: u16,
}

impl<S: Scalar> From<FesCommand<S>> for Command {
    fn from(command: FesCommand<S>) -> Self {
        Self {
            activations: command.activations.map(S::to_f64),
            amplitudes_ma: command.pulses.map(|pulse| S::quantity_value(pulse.amplitude)),
            widths_us: command.pulses.map(|pulse| S::quantity_value(pulse.width)),
            torque: S::quantity_value(command.torque),
            gain: command.gain.to_f64(),
            muscles: command.muscles.map(|status| status.bits()),
            status: command.status.bits(),
        }
    }
}

/// Angle (rad), velocity (rad/s), acceleration (rad/s²), torque (N m) that are wanted.
struct Wanted([f64; 4]);

/// A controller with its state, whatever its arithmetic.
trait Controlling: Send + Sync {
    fn start(&mut self, angle: f64);
    /// `measured`: angle (rad) and torque (N m).
    fn step(&mut self, wanted: &Wanted, measured: [f64; 2]) -> Command;
    fn save(&self) -> Vec<u64>;
    /// The problem, if the words are refused.
    fn restore(&mut self, words: &[u64]) -> Result<(), String>;
}

struct Running<S: Scalar, const N: usize> {
    controller: Coefficients<S, N>,
    state: FesControllerState<S>,
}

impl<S: Scalar, const N: usize> Controlling for Running<S, N> {
    fn start(&mut self, angle: f64) {
        self.state = self.controller.start(S::from_f64(angle));
    }

    fn step(&mut self, wanted: &Wanted, [angle, torque]: [f64; 2]) -> Command {
        let Wanted([wanted, velocity, acceleration, wanted_torque]) = *wanted;
        let target = Target {
            angle: S::from_f64(wanted),
            velocity: S::from_f64(velocity),
            acceleration: S::from_f64(acceleration),
            torque: S::quantity(wanted_torque),
        };
        let sensors = Sensors { angle: S::from_f64(angle), torque: S::quantity(torque) };
        self.controller.step(&mut self.state, target, sensors).into()
    }

    fn save(&self) -> Vec<u64> {
        self.controller.save(&self.state).map(Into::into).collect()
    }

    fn restore(&mut self, given: &[u64]) -> Result<(), String> {
        let words: Vec<S::Bits> = words(given)?;
        self.state = self.controller.restore(words).map_err(|error| error.to_string())?;
        Ok(())
    }
}

/// The constant half of the pulses; the other one carries the command.
fn modulation(amplitude_ma: Option<f64>, width_us: Option<f64>) -> PyResult<Modulation> {
    match (amplitude_ma, width_us) {
        (Some(amplitude), None) => Ok(Modulation::Width { amplitude: amplitude * 1e-3 }),
        (None, Some(width)) => Ok(Modulation::Amplitude { width: width * 1e-6 }),
        _ => Err(refused(
            "pulse_amplitude_ma, pulse_width_us",
            if amplitude_ma.is_some() { "both" } else { "none" },
            "give the one that is constant",
        )),
    }
}

fn measured(name: &str) -> PyResult<Measured> {
    match name {
        "angle" => Ok(Measured::Angle),
        "torque" => Ok(Measured::Torque),
        _ => Err(refused("measured", name, "must be angle or torque")),
    }
}

/// Controller of the angle or torque of a joint with a flexor and an extensor under FES, with its
/// state: feed-forward by the model's inverse, feedback by PI. It starts in the middle of the
/// joint's range. torque_range_nm: -60 to 60 N m if not given. What each parameter does:
/// `vm_nostd::control::FesControllerParams` in Rust.
#[pyclass(module = "vm_nostd")]
pub struct FesController {
    controlling: Box<dyn Controlling>,
}

#[pymethods]
impl FesController {
    #[new]
    #[pyo3(signature = (
        joint, electrodes, *, pulse_amplitude_ma=None, pulse_width_us=None,
        inertia_kg_m2, damping_nm_s_per_rad, gravity_nm, hanging_angle_rad,
        proportional_nm_per_rad, integral_nm_per_rad_s, derivative_nm_s_per_rad=0.0,
        derivative_filter_s=0.02, most_integral_nm=20.0,
        stimulation_frequency_pps=40.0, cocontraction_nm=1.0, measured="angle",
        expected_lag_s=0.06, lead_filter_s=0.025, least_fitness=0.3, torque_range_nm=(-60.0, 60.0),
        fatigue=None, gain=None, time_step_s=1e-3, arithmetic="f32"
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        joint: &Bound<'_, Joint>,
        electrodes: (Py<RecruitmentCurve>, Py<RecruitmentCurve>),
        pulse_amplitude_ma: Option<f64>,
        pulse_width_us: Option<f64>,
        inertia_kg_m2: f64,
        damping_nm_s_per_rad: f64,
        gravity_nm: f64,
        hanging_angle_rad: f64,
        proportional_nm_per_rad: f64,
        integral_nm_per_rad_s: f64,
        derivative_nm_s_per_rad: f64,
        derivative_filter_s: f64,
        most_integral_nm: f64,
        stimulation_frequency_pps: f64,
        cocontraction_nm: f64,
        measured: &str,
        expected_lag_s: f64,
        lead_filter_s: f64,
        least_fitness: f64,
        torque_range_nm: (f64, f64),
        fatigue: Option<[(f64, f64, f64, f64); 2]>,
        gain: Option<(f64, f64, f64, f64)>,
        time_step_s: f64,
        arithmetic: &str,
    ) -> PyResult<Self> {
        let pair = Antagonists::of(joint.get())?;
        let step = time_step(time_step_s)?;
        let tired = |(fatigue_time, recovery_time, least_fitness, frequency_dependence)| {
            Some(FatigueParams { fatigue_time, recovery_time, least_fitness, frequency_dependence })
        };
        let learnt = |(time, least, most, excitation)| GainParams { time, least, most, excitation };
        let modulation = modulation(pulse_amplitude_ma, pulse_width_us)?;
        let measured = self::measured(measured)?;
        let middle = 0.5 * (pair.range.least + pair.range.most);
        let controlling = with_scalar!(choices::arithmetic(arithmetic)?, S => with_count!(
            "fiber", pair.types, [1 2 3], N => {
                let params = FesControllerParams::<N> {
                    range: pair.range,
                    muscles: pair.params(),
                    paths: pair.paths,
                    limb: LimbParams {
                        inertia: inertia_kg_m2,
                        damping: damping_nm_s_per_rad,
                        gravity: gravity_nm,
                        hanging_angle: hanging_angle_rad,
                    },
                    electrodes: [electrodes.0.get().params, electrodes.1.get().params],
                    modulation: [modulation; 2],
                    stimulation_frequency: stimulation_frequency_pps,
                    cocontraction: cocontraction_nm,
                    measured,
                    feedback: PiParams {
                        proportional: proportional_nm_per_rad,
                        integral: integral_nm_per_rad_s,
                        derivative: derivative_nm_s_per_rad,
                        derivative_filter: derivative_filter_s,
                        most: most_integral_nm,
                    },
                    expected_lag: expected_lag_s,
                    lead_filter_time: lead_filter_s,
                    fatigue: fatigue.map_or([None; 2], |pair| pair.map(tired)),
                    least_fitness,
                    gain: gain.map(learnt),
                    torque: torque_range_nm,
                };
                let controller =
                    Coefficients::<S, N>::build(&params, step).map_err(errors::joint)?;
                let state = controller.start(S::from_f64(middle));
                Ok(Box::new(Running { controller, state }) as Box<dyn Controlling>)
            }
        ))?;
        Ok(Self { controlling })
    }

    /// Starts again at an angle (rad), with rested muscles and a gain of 1.
    fn start(&mut self, angle_rad: f64) -> PyResult<()> {
        self.controlling.start(number("angle_rad", angle_rad)?);
        Ok(())
    }

    /// Steps one tick: the wanted angle (rad), its velocity (rad/s) and acceleration (rad/s²), the
    /// wanted torque besides that of the motion (N m), and what is measured: angle (rad), torque
    /// (N m; only if `measured` is "torque").
    #[pyo3(signature = (
        wanted_rad, measured_rad, *, wanted_rad_per_s=0.0, wanted_rad_per_s2=0.0,
        wanted_torque_nm=0.0, measured_torque_nm=0.0
    ))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        wanted_rad: f64,
        measured_rad: f64,
        wanted_rad_per_s: f64,
        wanted_rad_per_s2: f64,
        wanted_torque_nm: f64,
        measured_torque_nm: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let wanted = Wanted([
            number("wanted_rad", wanted_rad)?,
            number("wanted_rad_per_s", wanted_rad_per_s)?,
            number("wanted_rad_per_s2", wanted_rad_per_s2)?,
            number("wanted_torque_nm", wanted_torque_nm)?,
        ]);
        let measured = [
            number("measured_rad", measured_rad)?,
            number("measured_torque_nm", measured_torque_nm)?,
        ];
        let command = self.controlling.step(&wanted, measured);
        let [flexor, extensor] = command.muscles;
        COMMAND.of(
            py,
            (
                <(f64, f64)>::from(command.activations),
                <(f64, f64)>::from(command.amplitudes_ma),
                <(f64, f64)>::from(command.widths_us),
                command.torque,
                command.gain,
                (STATUS.of(py, (flexor,))?, STATUS.of(py, (extensor,))?),
                CONTROL_STATUS.of(py, (command.status,))?,
            ),
        )
    }

    /// The state as words, with a fingerprint of the controller.
    fn save<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        self.controlling.save().into_pyarray(py)
    }

    /// Takes saved words back; those of another controller are refused.
    fn restore(&mut self, words: &Bound<'_, PyAny>) -> PyResult<()> {
        let words = saved(words)?;
        self.controlling.restore(&words).map_err(|problem| errors::restore(words.len(), &problem))
    }
}
