//! One muscle, any mode and arithmetic, stepped over a trace.

use crate::link::{self, with_type_count};
use crate::reference::{Input, Mode, Muscle, Sample, Simulation, SolverError};
use crate::trace::InputTrace;
use vm_nostd as vm;

/// What a muscle is computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Arithmetic {
    /// The independent reference, adaptive, in f64.
    Reference,
    /// vm-nostd in f32, as on the target.
    F32,
    /// vm-nostd in fixed point, as on a target without a floating-point unit.
    Fixed,
    /// vm-nostd in f64, which shows the error of the scheme alone.
    F64,
}

impl Arithmetic {
    /// Its name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::F32 => "f32",
            Self::Fixed => "fixed",
            Self::F64 => "f64",
        }
    }
}

/// The name of a mode on the command line and in tables.
pub fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Continuous => "continuous",
        Mode::Fes => "fes",
    }
}

/// Why a run stopped.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The muscle or its resting length was refused.
    #[error("{0}")]
    Refused(#[from] vm::ParameterError),
    /// The reference integrator gave up.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The reference has no bits to keep.
    #[error("the reference has no bits to compare")]
    NoBits,
    /// A muscle of so many types is not built here.
    #[error("{0} fibre types: a muscle has 1 to {most} here", most = link::MOST_TYPES)]
    TypeCount(usize),
}

/// What a row of a run yields: force, length and velocity, and what was saturated.
pub type Row = (Sample, vm::Status);

/// Runs a muscle over a trace: one row per input, the first of them the muscle at rest.
pub fn run(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    trace: &InputTrace,
) -> Result<Vec<Row>, RunError> {
    match arithmetic {
        Arithmetic::Reference => run_reference(muscle, mode, trace),
        Arithmetic::F32 => run_vm::<f32>(muscle, mode, trace, &mut |_| {}),
        Arithmetic::Fixed => run_vm::<vm::Fixed>(muscle, mode, trace, &mut |_| {}),
        Arithmetic::F64 => run_vm::<f64>(muscle, mode, trace, &mut |_| {}),
    }
}

fn run_reference(muscle: &Muscle, mode: Mode, trace: &InputTrace) -> Result<Vec<Row>, RunError> {
    let path = trace.inputs[0].path_length;
    let mut simulation = Simulation::at_rest(muscle.clone(), mode, trace.time_step, path);
    let mut rows = vec![(simulation.sample(), vm::Status::empty())];
    for &input in &trace.inputs[1..] {
        rows.push((simulation.step(input)?, vm::Status::empty()));
    }
    Ok(rows)
}

/// What is done with the bits of the state after every tick.
type Watch<'a> = &'a mut dyn FnMut(u64);

/// A checksum (CRC-64/XZ) of the bits of the state after every tick.
pub fn fingerprint(
    muscle: &Muscle,
    mode: Mode,
    arithmetic: Arithmetic,
    trace: &InputTrace,
) -> Result<u64, RunError> {
    let crc = crc::Crc::<u64>::new(&crc::CRC_64_XZ);
    let mut digest = crc.digest();
    let mut watch = |word: u64| digest.update(&word.to_le_bytes());
    match arithmetic {
        Arithmetic::Reference => return Err(RunError::NoBits),
        Arithmetic::F32 => run_vm::<f32>(muscle, mode, trace, &mut watch)?,
        Arithmetic::Fixed => run_vm::<vm::Fixed>(muscle, mode, trace, &mut watch)?,
        Arithmetic::F64 => run_vm::<f64>(muscle, mode, trace, &mut watch)?,
    };
    Ok(digest.finalize())
}

fn run_vm<S: vm::Scalar>(
    muscle: &Muscle,
    mode: Mode,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    with_type_count!(
        muscle,
        N => match mode {
            Mode::Continuous => run_mode::<S, vm::NaturalContinuous, N>(muscle, trace, watch),
            Mode::Fes => run_mode::<S, vm::IntramuscularFes, N>(muscle, trace, watch),
        },
        else Err(RunError::TypeCount(muscle.fibers.len()))
    )
}

fn run_mode<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize>(
    muscle: &Muscle,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    let step = vm::TimeStep::from_seconds(trace.time_step)?;
    let muscle = vm::Muscle::<S, R, N>::build(&link::params(muscle), step)?;
    let mut state = muscle.rest(S::path_length(trace.inputs[0].path_length))?;
    let mut rows = vec![row(muscle.observe(&state))];
    for input in &trace.inputs[1..] {
        rows.push(row(muscle.step(&mut state, scaled(input))));
        state.words().for_each(|word| watch(word.into()));
    }
    Ok(rows)
}

fn scaled<S: vm::Scalar>(input: &Input) -> vm::Input<S> {
    vm::Input {
        activation: S::from_f64(input.activation),
        path_length: S::path_length(input.path_length),
        stimulation_frequency: S::frequency(input.stimulation_frequency),
    }
}

fn row<S: vm::Scalar>(output: vm::Output<S>) -> Row {
    let sample = Sample {
        force: S::newtons(output.force),
        fascicle_length: output.fascicle_length.to_f64(),
        fascicle_velocity: output.fascicle_velocity.to_f64(),
    };
    (sample, output.status)
}

/// The names of the flags that are set, joined by `|`; `ok` where none is.
pub fn status_names(status: vm::Status) -> String {
    let names: Vec<&str> = status.iter_names().map(|(name, _)| name).collect();
    if names.is_empty() { "ok".to_owned() } else { names.join("|") }
}
