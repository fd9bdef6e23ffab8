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
        Mode::Discrete => "discrete",
        Mode::DiscreteEffectiveLength => "discrete-leff",
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
    /// The discrete modes were asked for, and the muscle does not say what units it has.
    #[error(
        "units = (missing), fibre type of rank {0}: the discrete modes need the number of units"
    )]
    NoUnits(u8),
    /// More motor units than are built here.
    #[error("{0} motor units: a muscle has at most {most} here", most = MOST_UNITS)]
    UnitCount(usize),
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
    if matches!(mode, Mode::Discrete | Mode::DiscreteEffectiveLength) {
        count_units(muscle)?;
    }
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
            Mode::Continuous => run_lumped::<S, vm::NaturalContinuous, N>(muscle, trace, watch),
            Mode::Fes => run_lumped::<S, vm::IntramuscularFes, N>(muscle, trace, watch),
            Mode::Discrete => run_discrete::<S, vm::FascicleLength, N>(muscle, trace, watch),
            Mode::DiscreteEffectiveLength => {
                run_discrete::<S, vm::EffectiveLength, N>(muscle, trace, watch)
            }
        },
        else Err(RunError::TypeCount(muscle.fibers.len()))
    )
}

/// A mode that takes each fibre type as one unit.
fn run_lumped<S: vm::Scalar, R: vm::Recruitment<S, N, Units = ()>, const N: usize>(
    muscle: &Muscle,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    run_mode::<S, R, N>(muscle, &(), trace, watch)
}

/// The most motor units that a muscle can have here; in firmware the number is free.
pub const MOST_UNITS: usize = 512;

/// A mode of motor units, with room for at least as many as the muscle has.
fn run_discrete<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize>(
    muscle: &Muscle,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    let count = count_units(muscle)?;
    match count {
        0..=8 => run_units::<S, A, N, 8>(muscle, trace, watch),
        9..=64 => run_units::<S, A, N, 64>(muscle, trace, watch),
        65..=MOST_UNITS => run_units::<S, A, N, MOST_UNITS>(muscle, trace, watch),
        _ => Err(RunError::UnitCount(count)),
    }
}

fn run_units<S: vm::Scalar, A: vm::ActingLength<S>, const N: usize, const UNITS: usize>(
    muscle: &Muscle,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    let units = link::motor_units::<N, UNITS>(muscle)?;
    run_mode::<S, vm::NaturalDiscrete<A, UNITS>, N>(muscle, &units, trace, watch)
}

/// How many motor units a muscle has; refused where a type has none.
fn count_units(muscle: &Muscle) -> Result<usize, RunError> {
    match muscle.fibers.iter().find(|fiber| fiber.units.is_empty()) {
        Some(fiber) => Err(RunError::NoUnits(fiber.fiber_type.rank)),
        None => Ok(muscle.fibers.iter().map(|fiber| fiber.units.len()).sum()),
    }
}

fn run_mode<S: vm::Scalar, R: vm::Recruitment<S, N>, const N: usize>(
    muscle: &Muscle,
    units: &R::Units,
    trace: &InputTrace,
    watch: Watch<'_>,
) -> Result<Vec<Row>, RunError> {
    let step = vm::TimeStep::from_seconds(trace.time_step)?;
    let muscle = vm::Muscle::<S, R, N>::build_with_units(&link::params(muscle), units, step)?;
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
