//! Runs a muscle over a trace of inputs, in any mode and arithmetic.

mod running;
mod stepped;

pub use running::{C_UNITS, MOST_UNITS, Row, RunError, Running};

use crate::model_muscle::{self, with_type_count};
use crate::reference::{Input, Mode, Muscle, Simulation};
use crate::trace::InputTrace;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use stepped::{Fatiguing, Slope, Stepped};
use vm_nostd as vm;

/// Arithmetic of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Arithmetic {
    /// The independent reference: adaptive steps, f64.
    Reference,
    /// vm-nostd in f32, as on the target.
    F32,
    /// vm-nostd in fixed point, as on a target without a floating-point unit.
    Fixed,
    /// vm-nostd in f64: shows the truncation error alone.
    F64,
}

impl Arithmetic {
    /// Name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::F32 => "f32",
            Self::Fixed => "fixed",
            Self::F64 => "f64",
        }
    }
}

/// Name of a mode on the command line and in tables.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Continuous => "continuous",
        Mode::Fes => "fes",
        Mode::Discrete => "discrete",
        Mode::DiscreteEffectiveLength => "discrete-leff",
    }
}

/// An accuracy class of `vm-nostd`; the reference has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// One substep per tick, unless the muscle rings too fast for that.
    Economy,
    /// Substeps of at most 0.25 ms.
    #[default]
    Standard,
    /// Substeps of at most 0.063 ms, and ticks longer than 0.25 ms in equal parts.
    Fine,
}

impl Class {
    /// All of them, the cheapest first.
    pub const ALL: [Self; 3] = [Self::Economy, Self::Standard, Self::Fine];

    /// Its name on the command line, in muscle files and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Economy => "economy",
            Self::Standard => "standard",
            Self::Fine => "fine",
        }
    }

    /// The model's.
    pub fn of_model(self) -> vm::Class {
        match self {
            Self::Economy => vm::Class::Economy,
            Self::Standard => vm::Class::Standard,
            Self::Fine => vm::Class::Fine,
        }
    }
}

/// A muscle of the standard class at rest on a path (m), stepped by `time_step` (s).
pub fn at_rest(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    time_step: f64,
    path_length: f64,
) -> Result<Box<dyn Running>, RunError> {
    at_rest_in_class(muscle, mode, arithmetic, Class::Standard, time_step, path_length)
}

/// A muscle of any class at rest on a path (m), stepped by `time_step` (s).
pub fn at_rest_in_class(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    class: Class,
    time_step: f64,
    path_length: f64,
) -> Result<Box<dyn Running>, RunError> {
    Rest { muscle, class, time_step, path_length }.running(mode, arithmetic)
}

/// Runs a muscle of the standard class over a trace: one row per input; the first is the muscle at
/// rest.
pub fn run(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    trace: &InputTrace,
) -> Result<Vec<Row>, RunError> {
    run_in_class(muscle, mode, arithmetic, Class::Standard, trace)
}

/// Runs a muscle of any class over a trace: one row per input; the first is the muscle at rest.
pub fn run_in_class(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    class: Class,
    trace: &InputTrace,
) -> Result<Vec<Row>, RunError> {
    let path = trace.inputs[0].path_length;
    let mut running = at_rest_in_class(muscle, mode, arithmetic, class, trace.time_step, path)?;
    let mut rows = vec![running.row()];
    for &input in &trace.inputs[1..] {
        rows.push(running.step(input)?);
    }
    Ok(rows)
}

/// Checksum (CRC-64/XZ) of the state bits of every tick.
pub fn fingerprint(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    trace: &InputTrace,
) -> Result<u64, RunError> {
    if arithmetic == Arithmetic::Reference {
        return Err(RunError::NoBits);
    }
    let path = trace.inputs[0].path_length;
    let mut running = at_rest(muscle, mode, arithmetic, trace.time_step, path)?;
    let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
    let mut digest = crc.digest();
    for &input in &trace.inputs[1..] {
        running.step(input)?;
        running.watch(&mut |word| digest.update(&word.to_le_bytes()));
    }
    Ok(digest.finalize())
}

/// Start of a run.
struct Rest<'a> {
    muscle: &'a Muscle,
    class: Class,
    time_step: f64,
    path_length: f64,
}

impl Rest<'_> {
    fn running(&self, mode: Mode, arithmetic: Arithmetic) -> Result<Box<dyn Running>, RunError> {
        match arithmetic {
            Arithmetic::Reference => self.reference(mode),
            Arithmetic::F32 => self.of_scalar::<f32>(mode),
            Arithmetic::Fixed => self.of_scalar::<vm::Fixed>(mode),
            Arithmetic::F64 => self.of_scalar::<f64>(mode),
        }
    }

    fn reference(&self, mode: Mode) -> Result<Box<dyn Running>, RunError> {
        if matches!(mode, Mode::Discrete | Mode::DiscreteEffectiveLength) {
            count_units(self.muscle)?;
        }
        let muscle = self.muscle.clone();
        Ok(Box::new(Simulation::at_rest(muscle, mode, self.time_step, self.path_length)))
    }

    fn of_scalar<S: vm::Scalar>(&self, mode: Mode) -> Result<Box<dyn Running>, RunError> {
        with_type_count!(
            self.muscle,
            N => match mode {
                Mode::Continuous => {
                    let slope = vm::Muscle::stiffness;
                    self.of_mode::<S, vm::NaturalContinuous, N>(mode, &(), Some(slope))
                }
                Mode::Fes => {
                    let slope = vm::Muscle::stiffness;
                    self.of_mode::<S, vm::IntramuscularFes, N>(mode, &(), Some(slope))
                }
                Mode::Discrete => self.discrete::<S, vm::FascicleLength, N>(mode),
                Mode::DiscreteEffectiveLength => self.discrete::<S, vm::EffectiveLength, N>(mode),
            },
            else Err(RunError::TypeCount(self.muscle.fibers.len()))
        )
    }

    /// A discrete mode with capacity for at least the motor units of the muscle.
    fn discrete<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize>(
        &self,
        mode: Mode,
    ) -> Result<Box<dyn Running>, RunError> {
        let count = count_units(self.muscle)?;
        match count {
            0..=64 => self.of_units::<S, A, N, 64>(mode),
            65..=MOST_UNITS => self.of_units::<S, A, N, MOST_UNITS>(mode),
            _ => Err(RunError::UnitCount(count)),
        }
    }

    fn of_units<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize, const UNITS: usize>(
        &self,
        mode: Mode,
    ) -> Result<Box<dyn Running>, RunError> {
        let units = model_muscle::motor_units::<N, UNITS>(self.muscle)?;
        self.of_mode::<S, vm::NaturalDiscrete<A, UNITS>, N>(mode, &units, None)
    }

    fn of_mode<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize>(
        &self,
        mode: Mode,
        units: &R::Units,
        slope: Option<Slope<S, R, N>>,
    ) -> Result<Box<dyn Running>, RunError> {
        let step = vm::TimeStep::from_seconds(self.time_step)?;
        let class = self.class.of_model();
        let params = vm::MuscleParams { class, ..model_muscle::params(self.muscle) };
        let muscle = vm::Muscle::<S, R, N>::build_with_units(&params, units, step)?;
        let state = muscle.rest(S::path_length(self.path_length))?;
        let fatigue = self.muscle.fatigue.as_ref().map(model_muscle::fatigue_params);
        let fatiguing = fatigue
            .map(|params| {
                let fatigue = vm::Fatigue::<S>::build(&params, step)?;
                let stimulated = mode == Mode::Fes;
                Ok::<_, RunError>(Fatiguing { fatigue, state: fatigue.rested(), stimulated })
            })
            .transpose()?;
        let f0 = params.max_isometric_force();
        let f0_per_length = f0 / params.fascicle_length;
        let muscle = Arc::new(muscle);
        Ok(Box::new(Stepped { muscle, state, fatiguing, slope, f0, f0_per_length }))
    }
}

impl Running for Simulation {
    fn row(&self) -> Row {
        (self.sample(), vm::Status::empty())
    }

    fn step(&mut self, input: Input) -> Result<Row, RunError> {
        Ok((Simulation::step(self, input)?, vm::Status::empty()))
    }

    fn fork(&self) -> Box<dyn Running> {
        Box::new(self.clone())
    }

    fn watch(&self, _: &mut dyn FnMut(u64)) {}

    fn save(&self) -> Option<Vec<u64>> {
        None
    }

    fn stiffness(&self) -> Option<f64> {
        None
    }

    fn restore(&mut self, words: &[u64]) -> Result<(), RunError> {
        let problem = "the reference has no saved state; copy it instead".to_owned();
        Err(RunError::Restore { words: words.len(), problem })
    }
}

/// Number of motor units of a muscle; an error if a type has none.
pub(crate) fn count_units(muscle: &Muscle) -> Result<usize, RunError> {
    match muscle.fibers.iter().find(|fiber| fiber.units.is_empty()) {
        Some(fiber) => Err(RunError::NoUnits(fiber.fiber_type.rank)),
        None => Ok(muscle.fibers.iter().map(|fiber| fiber.units.len()).sum()),
    }
}

/// Names of the flags that are set, joined by `|`; `ok` if none is.
pub fn status_names(status: vm::Status) -> String {
    let names: Vec<&str> = status.iter_names().map(|(name, _)| name).collect();
    if names.is_empty() { "ok".to_owned() } else { names.join("|") }
}
