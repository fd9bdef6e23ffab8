//! What a mode of recruitment is.

use crate::checksum::Summed;
use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::io::Input;
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::tick::time_step::TimeStep;
use core::fmt::Debug;

/// A mode of recruitment, for muscles of `N` fibre types.
pub trait Recruitment<S: Scalar, const N: usize>:
    Sealed + Copy + Debug + PartialEq + 'static
{
    /// Tells modes apart in a saved state.
    #[doc(hidden)]
    const MODE: u32;
    /// What there is to say of a muscle in this mode besides its parameters.
    type Units;
    #[doc(hidden)]
    type State: RecruitmentState<S>;
    #[doc(hidden)]
    type Coefficients: RecruitmentTick<S, N, Units = Self::Units, State = Self::State> + Summed;
}

/// What of a mode changes from tick to tick.
#[doc(hidden)]
pub trait RecruitmentState<S: Scalar>: Copy + Debug + PartialEq {
    /// How many words it is saved in.
    const WORDS: usize;

    /// Its bits, always in the same order.
    fn words(&self) -> impl Iterator<Item = S::Bits>;
}

/// What the modes do differently in a tick.
#[doc(hidden)]
pub trait RecruitmentTick<S: Scalar, const N: usize>: Sized {
    /// Whether the passive force, filament compression included, is kept from pushing on its own.
    const PASSIVE_ONLY_PULLS: bool;

    type Units;
    type State;

    fn new(
        params: &MuscleParams<N>,
        units: &Self::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError>;

    /// Not recruited, nor ever was.
    fn at_rest(&self, fibers: &[Fiber<S>; N]) -> Self::State;

    /// The state whose words come next, if every value is one that a tick can leave behind.
    fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError>;

    /// Advances recruitment, excitation and sag by one tick, and says of each type, in their order,
    /// how it is `recruited`.
    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
        recruited: impl FnMut(&Fiber<S>, Recruited<S>),
    );
}

/// What recruitment depends on during a tick.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Moment<S: Scalar, const N: usize> {
    pub(crate) input: Input<S>,
    /// Fascicle length at the middle, L_ce0.
    pub(crate) fascicle_length: S,
    /// How much longer the fascicles become, L_ce0.
    pub(crate) travel: S,
    /// 1/L at the middle, L being where the filaments' equations hold.
    pub(crate) reciprocal: S,
    /// Y of each type at the middle.
    pub(crate) yieldings: [S; N],
}

/// How a fibre type is recruited at the middle of a tick.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Recruited<S> {
    /// Af, in the discrete modes summed over the units by cross section.
    pub(crate) activation: S,
    /// Share of the muscle's force that the type's filaments add, at Af FL FV = 1.
    pub(crate) weight: S,
    /// Change of the weight across the tick, if Af has jumped where the tick starts, as with the
    /// stimulation frequency. Nothing else jumps: elsewhere the change since the last tick tells
    /// that across this one.
    pub(crate) change_after_jump: Option<S>,
    /// Share for the compression of its thick filaments.
    pub(crate) compression_weight: S,
}
