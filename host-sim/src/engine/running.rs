//! A muscle that is being run, and why it cannot be.

use crate::model_muscle;
use crate::reference::{Input, Sample, SolverError};
use vm_nostd as vm;

/// Most motor units of a muscle on the host; the library has no limit.
pub const MOST_UNITS: usize = 512;

/// Most motor units of a muscle in the C library.
pub const C_UNITS: usize = 64;

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The muscle or its resting length was refused.
    #[error("{0}")]
    Refused(#[from] vm::ParameterError),
    /// The reference integrator failed.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// Only the arithmetics of `vm-nostd` have golden bits.
    #[error("the reference has no golden bits")]
    NoBits,
    /// A discrete mode needs the number of motor units.
    #[error(
        "units = (missing), fibre type of rank {0}: the discrete modes need the number of units"
    )]
    NoUnits(u8),
    /// The caller of a fit wants no more of it.
    #[error("stopped before its end")]
    Stopped,
    /// The reference has no words to restore, and a saved state is that of one muscle only.
    #[error("words = {words}: {problem}")]
    Restore {
        /// How many words were given.
        words: usize,
        /// Why they were refused.
        problem: String,
    },
    /// More motor units than the host supports.
    #[error("{0} motor units: at most {most} are supported", most = MOST_UNITS)]
    UnitCount(usize),
    /// More motor units than the C library has room for.
    #[error("{0} motor units: the C library has room for {most}", most = C_UNITS)]
    UnitsInC(usize),
    /// More fibre types than the host supports.
    #[error("{0} fibre types: 1 to {most} are supported", most = model_muscle::MOST_TYPES)]
    TypeCount(usize),
}

/// Output of a row: force, length and velocity, and the flags.
pub type Row = (Sample, vm::Status);

/// A muscle with its state during a run.
pub trait Running: Send + Sync {
    /// Current output.
    fn row(&self) -> Row;
    /// Steps one tick.
    fn step(&mut self, input: Input) -> Result<Row, RunError>;
    /// Copies muscle and state.
    fn fork(&self) -> Box<dyn Running>;
    /// Calls `watch` with each word of the state; never for the reference.
    fn watch(&self, watch: &mut dyn FnMut(u64));
    /// The state as words, fatigue included, with fingerprints; the reference has none.
    fn save(&self) -> Option<Vec<u64>>;
    /// Slope of the steady force by the path at the present activation, N/m, times the fitness;
    /// none in the discrete modes and of the reference.
    fn stiffness(&self) -> Option<f64>;
    /// Takes saved words back, or refuses them and stays as it is.
    fn restore(&mut self, words: &[u64]) -> Result<(), RunError>;
}
