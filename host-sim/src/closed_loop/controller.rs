//! The controllers that are compared.

use super::patient::{ELECTRODE, nominal};
use super::plant::FREQUENCY;
use super::task::{Motion, Task};
use vm_nostd::control::{
    FesController, FesControllerParams, FesControllerState, GainParams, JointError, Measured,
    Modulation, PiParams, Sensors, Target,
};
use vm_nostd::{FatigueParams, Fixed, RecruitmentCurve, Scalar, TimeStep};

/// Amplitude of all pulses, A.
pub const AMPLITUDE: f64 = 0.03;
/// Their greatest width, s.
pub const GREATEST_WIDTH: f64 = 5e-4;

/// Filter time of derivatives, s.
const DERIVATIVE_FILTER: f64 = 0.02;

/// Time constant of the gain's estimate, s: many movements.
const GAIN_TIME: f64 = 5.0;

/// Less co-contraction than this, of the weight's torque, is none.
const NO_COCONTRACTION: f64 = 0.03;

/// Which controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// PI from the angle to the width of the pulses of one muscle or the other.
    Pi,
    /// PI from the angle to recruitment, through the static curve to the width.
    PiCurve,
    /// The same with a derivative, to tell what the model is worth from what damping is.
    PidCurve,
    /// The model's controller in `f32`.
    Model,
    /// The same in fixed point, with the settings tuned in `f32`.
    ModelFixed,
}

impl Kind {
    /// All of them; those that are tuned first.
    pub const ALL: [Self; 5] =
        [Self::Pi, Self::PiCurve, Self::PidCurve, Self::Model, Self::ModelFixed];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pi => "PI",
            Self::PiCurve => "PI + curve",
            Self::PidCurve => "PID + curve",
            Self::Model | Self::ModelFixed => "model",
        }
    }

    /// Arithmetic in tables.
    pub fn arithmetic(self) -> &'static str {
        match self {
            Self::Pi | Self::PiCurve | Self::PidCurve => "f64",
            Self::Model => "f32",
            Self::ModelFixed => "fixed",
        }
    }

    /// Ranges of what is tuned, on a logarithmic scale: gains per rad, per rad and s, and s/rad, of
    /// full stimulation or, of the model, of the weight's torque; of the model also the expected
    /// lag (s), co-contraction (of the weight's torque), and the filter time of the lead (s), from
    /// a pulse's interval up.
    pub fn ranges(self) -> &'static [(f64, f64)] {
        const PI: [(f64, f64); 2] = [(0.01, 10.0), (0.01, 10.0)];
        const PID: [(f64, f64); 3] = [(0.01, 10.0), (0.01, 10.0), (0.003, 1.0)];
        const MODEL: [(f64, f64); 6] =
            [(0.03, 10.0), (0.03, 10.0), (0.01, 1.0), (0.05, 0.2), (0.001, 0.4), (0.025, 0.1)];
        match self {
            Self::Pi | Self::PiCurve => &PI,
            Self::PidCurve => &PID,
            Self::Model | Self::ModelFixed => &MODEL,
        }
    }
}

impl Kind {
    /// The middle of all ranges, chosen by hand: where a tuner begins.
    pub fn untuned(self) -> Settings {
        self.ranges().iter().map(|&(least, most)| (0.5 * (least.ln() + most.ln())).exp()).collect()
    }
}

/// What a tuner has chosen, in the order of [`Kind::ranges`].
pub type Settings = Vec<f64>;

/// A controller in a tick: pulse widths of flexor and extensor, s.
pub enum Controller {
    /// Feedback from the angle to stimulation of one muscle or the other.
    Pi(Pi),
    /// The model's, in `f32`.
    Model(Box<Modelled<f32>>),
    /// The model's, in fixed point.
    ModelFixed(Box<Modelled<Fixed>>),
}

/// PI of the angle.
pub struct Pi {
    proportional: f64,
    integral: f64,
    /// k_d/T_d, and the filtered error.
    derivative: f64,
    filtered: f64,
    sum: f64,
    curve: Option<RecruitmentCurve<f64>>,
}

/// The model's controller and its state.
pub struct Modelled<S: Scalar> {
    controller: FesController<S, 2>,
    state: FesControllerState<S>,
}

impl Controller {
    /// A controller at the start of a task.
    pub fn new(kind: Kind, task: Task, settings: &[f64]) -> Result<Self, JointError> {
        Ok(match kind {
            Kind::Pi | Kind::PiCurve | Kind::PidCurve => {
                let own = |error| JointError { muscle: None, error };
                let curve = (kind != Kind::Pi).then(|| RecruitmentCurve::build(&ELECTRODE));
                Self::Pi(Pi {
                    proportional: settings[0],
                    integral: settings[1],
                    derivative: settings.get(2).map_or(0.0, |gain| gain / DERIVATIVE_FILTER),
                    filtered: 0.0,
                    sum: 0.0,
                    curve: curve.transpose().map_err(own)?,
                })
            }
            Kind::Model => Self::Model(Box::new(Modelled::new(task, settings)?)),
            Kind::ModelFixed => Self::ModelFixed(Box::new(Modelled::new(task, settings)?)),
        })
    }

    /// One tick: pulse widths of flexor and extensor (s) for a target and a measured angle (rad).
    pub fn step(&mut self, target: Motion, measured: f64) -> [f64; 2] {
        match self {
            Self::Pi(pi) => pi.step(target[0] - measured),
            Self::Model(modelled) => modelled.step(target, measured),
            Self::ModelFixed(modelled) => modelled.step(target, measured),
        }
    }
}

impl Pi {
    fn step(&mut self, error: f64) -> [f64; 2] {
        let ahead = error - self.filtered;
        self.filtered += 1e-3 / DERIVATIVE_FILTER * ahead;
        let wanted = self.proportional * error + self.sum + self.derivative * ahead;
        // Conditional integration, as the model's controller has it.
        let saturated = wanted.abs() >= 1.0 && wanted * error > 0.0;
        if !saturated {
            self.sum = (self.sum + self.integral * error * 1e-3).clamp(-1.0, 1.0);
        }
        [wanted, -wanted].map(|wanted| {
            let share = wanted.clamp(0.0, 1.0);
            match &self.curve {
                None => share * GREATEST_WIDTH,
                Some(_) if share == 0.0 => 0.0,
                Some(curve) => curve.width_for(share, AMPLITUDE * 1e3).0 * 1e-6,
            }
        })
    }
}

/// Parameters of the model's controller for a task, with settings in the order of
/// [`Kind::ranges`].
pub fn params(task: Task, settings: &[f64]) -> FesControllerParams<2> {
    let preset = task.joint();
    let limb = task.limb();
    let weight = limb.gravity + 5.0 * limb.inertia;
    let [proportional, integral, derivative, expected_lag, cocontraction, lead_filter_time] =
        settings[..]
    else {
        unreachable!("six settings")
    };
    FesControllerParams {
        range: preset.range,
        muscles: nominal(task),
        paths: preset.muscles.map(|muscle| muscle.path()),
        limb,
        electrodes: [ELECTRODE; 2],
        modulation: [Modulation::Width { amplitude: AMPLITUDE }; 2],
        stimulation_frequency: FREQUENCY,
        // Even a little of it stimulates at the threshold, of which the controller is not
        // sure.
        cocontraction: if cocontraction < NO_COCONTRACTION { 0.0 } else { cocontraction * weight },
        measured: Measured::Angle,
        feedback: PiParams {
            proportional: proportional * weight,
            integral: integral * weight,
            derivative: derivative * weight,
            derivative_filter: DERIVATIVE_FILTER,
            most: 8.0 * weight,
        },
        expected_lag,
        lead_filter_time,
        fatigue: [Some(FatigueParams::QUADRICEPS); 2],
        least_fitness: 0.3,
        gain: Some(GainParams {
            time: GAIN_TIME,
            least: 0.3,
            most: 2.0,
            excitation: (0.1 * weight).max(0.01),
        }),
        torque: (-10.0 * weight, 10.0 * weight),
    }
}

impl<S: Scalar> Modelled<S> {
    fn new(task: Task, settings: &[f64]) -> Result<Self, JointError> {
        let controller = FesController::build(&params(task, settings), TimeStep::MILLISECOND)?;
        let state = controller.start(S::from_f64(task.start()));
        Ok(Self { controller, state })
    }

    fn step(&mut self, [angle, velocity, acceleration]: Motion, measured: f64) -> [f64; 2] {
        let target = Target {
            angle: S::from_f64(angle),
            velocity: S::from_f64(velocity),
            acceleration: S::from_f64(acceleration),
            torque: S::quantity(0.0),
        };
        let sensors = Sensors { angle: S::from_f64(measured), torque: S::quantity(0.0) };
        let command = self.controller.step(&mut self.state, target, sensors);
        [0, 1].map(|i| {
            // The greatest pulse that recruits nothing is left out.
            let none = command.activations[i] <= S::ZERO;
            let width = S::quantity_value(command.pulses[i].width) * 1e-6;
            if none { 0.0 } else { width.min(GREATEST_WIDTH) }
        })
    }
}
