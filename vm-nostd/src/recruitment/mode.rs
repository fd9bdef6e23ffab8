//! Traits of a recruitment mode.

use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::io::Input;
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::summed::FromWords;
use crate::tick::time_step::TimeStep;
use core::fmt::Debug;

/// A recruitment mode for muscles of `N` fibre types.
pub trait Recruitment<S: Scalar, const N: usize>:
    Sealed + Copy + Debug + PartialEq + Send + Sync + 'static
{
    /// Identifies the mode in the fingerprint of a saved state.
    #[doc(hidden)]
    const MODE: u32;
    /// Parameters of this mode besides those of the muscle.
    type Units;
    #[doc(hidden)]
    type State: RecruitmentState<S>;
    #[doc(hidden)]
    type Coefficients: RecruitmentTick<S, N, Units = Self::Units, State = Self::State>
        + FromWords
        + Send
        + Sync;
}

/// State of a mode.
#[doc(hidden)]
pub trait RecruitmentState<S: Scalar>: Copy + Debug + PartialEq + Send + Sync {
    /// Number of words.
    const WORDS: usize;

    /// Its words in fixed order.
    fn words(&self) -> impl Iterator<Item = S::Bits>;
}

/// Tick of a mode.
#[doc(hidden)]
pub trait RecruitmentTick<S: Scalar, const N: usize>: Sized {
    /// Whether the passive force, including filament compression, is clamped to non-negative
    /// values.
    const PASSIVE_ONLY_PULLS: bool;

    type Units;
    type State;

    fn new(
        params: &MuscleParams<N>,
        units: &Self::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError>;

    /// Whether coefficients that were read are of `N` fibre types.
    fn fits(&self) -> bool {
        true
    }

    /// The state at rest.
    fn at_rest(&self, fibers: &[Fiber<S>; N]) -> Self::State;

    /// Restores the state from the next words; an error if a value is out of range.
    fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError>;

    /// Advances recruitment, excitation and sag by one tick; returns how each type is recruited.
    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
    ) -> [Recruited<S>; N];
}

/// Inputs of recruitment during a tick.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Moment<S: Scalar, const N: usize> {
    pub(crate) input: Input<S>,
    /// Mid-tick fascicle length, L_ce0.
    pub(crate) fascicle_length: S,
    /// Change of fascicle length during the tick, L_ce0.
    pub(crate) travel: S,
    /// Mid-tick 1/L, with L clamped to the validity range of the filaments' equations.
    pub(crate) reciprocal: S,
    /// Mid-tick Y of each type.
    pub(crate) yieldings: [S; N],
}

/// Mid-tick recruitment of a fibre type.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Recruited<S> {
    /// Af; in the discrete modes the sum over the units, weighted by cross section.
    pub(crate) activation: S,
    /// Share of the muscle's force from the type's filaments at Af FL FV = 1.
    pub(crate) weight: S,
    /// Change of the weight across the tick if Af jumped at its start, as with the stimulation
    /// frequency. Otherwise it is extrapolated from the change since the last tick.
    pub(crate) change_after_jump: Option<S>,
    /// Weight of the compression of its thick filaments.
    pub(crate) compression_weight: S,
}
