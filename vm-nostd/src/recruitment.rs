//! How activation becomes recruitment; one file per mode.

mod acting_length;
mod continuous;
mod discrete;
mod fes;
mod firing;
mod lumped;
mod motor_units;

pub use acting_length::{ActingLength, EffectiveLength, FascicleLength};
pub use continuous::NaturalContinuous;
pub use discrete::NaturalDiscrete;
pub use fes::IntramuscularFes;
pub use motor_units::{MotorUnits, UnitSizes};

use crate::activation::ActivationCurve;
use crate::checksum::Summed;
use crate::domain::Range;
use crate::error::ParameterError;
use crate::muscle::{Fiber, Input};
use crate::params::MuscleParams;
use crate::scalar::{Scalar, sealed::Sealed};
use crate::state::{RestoreError, Saved};
use crate::time_step::TimeStep;
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
    /// Y of each type at the tick's start and end.
    pub(crate) yieldings: [[S; 2]; N],
}

/// Advances S of a unit by one tick, of which it is `firing` for a share, and says how active it is:
/// Af during the tick, for a frequency (f0.5), Y at start and end, and the curve of its length.
#[inline(always)]
pub(crate) fn activated<S: Scalar>(
    fiber: &Fiber<S>,
    curve: &ActivationCurve<S>,
    sag: &mut S::Slow,
    [yielding, yielding_after]: [S; 2],
    frequency: Course<S>,
    firing: S,
    length_change: S,
) -> Course<S> {
    let sag_after = fiber.sag.advance(*sag, firing);
    let before = yielding * S::of(*sag);
    let after = yielding_after * S::of(sag_after);
    *sag = sag_after;
    let modulation = (before + after).half();
    curve.at(
        frequency.middle * modulation,
        frequency.change * modulation + frequency.middle * (after - before),
        length_change,
    )
}

/// A quantity during a tick: its value at the middle, and its change from start to end.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Course<S> {
    pub(crate) middle: S,
    pub(crate) change: S,
}

impl<S: Scalar> Course<S> {
    pub(crate) fn constant(value: S) -> Self {
        Self { middle: value, change: S::ZERO }
    }

    /// What a share (0..1) with this course will be at the middle of the next tick.
    pub(crate) fn next_share(&self) -> S {
        (self.middle + self.change).max(S::ZERO).min(S::ONE)
    }

    /// The value `time` ticks after the middle.
    pub(crate) fn at(&self, time: S) -> S {
        self.middle + self.change * time
    }
}

/// How a fibre type is recruited during a tick.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Recruited<S> {
    /// Af, in the discrete modes summed over the units by cross section.
    pub(crate) activation: Course<S>,
    /// Share of the muscle's force that the type's filaments add, at Af FL FV = 1.
    pub(crate) weight: Course<S>,
    /// The same for the compression of its thick filaments.
    pub(crate) compression_weight: Course<S>,
}

/// What a share may be.
pub(crate) fn share<S: Scalar>() -> Range<S> {
    Range { least: S::ZERO, most: S::ONE }
}
