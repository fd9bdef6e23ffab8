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
    /// Y of each type at the middle.
    pub(crate) yieldings: [S; N],
}

/// Advances S of a unit by one tick, of which it is `firing` for a share, and says how active it
/// is: Af at the tick's middle, for a frequency (f0.5) and Y there, and the curve of its length.
#[inline(always)]
pub(crate) fn activated<S: Scalar>(
    fiber: &Fiber<S>,
    curve: &ActivationCurve<S>,
    sag: &mut S::LagState,
    yielding: S,
    frequency: S,
    firing: S,
) -> S {
    let before = S::of(*sag);
    *sag = fiber.sag.advance(*sag, firing);
    curve.at(frequency * (yielding * (before + S::of(*sag)).half()))
}

/// A quantity during a tick: its value at the middle, and its change from start to end.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Course<S> {
    pub(crate) middle: S,
    pub(crate) change: S,
}

impl<S: Scalar> Course<S> {
    /// The value `time` ticks after the middle.
    pub(crate) fn at(&self, time: S) -> S {
        self.middle + self.change * time
    }
}

/// Af of a unit from tick to tick: what its fall time has to be told before Af is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Activity<S> {
    /// Af at the middle of the last tick, 0..1.
    last: S,
    /// Af predicted for the middle of the next, 0..1: as far on as it came last.
    pub(crate) predicted: S,
}

impl<S: Scalar> Activity<S> {
    const WORDS: usize = 2;
    const NONE: Self = Self { last: S::ZERO, predicted: S::ZERO };

    /// What follows Af at the middle of a tick.
    fn next(&self, activation: S) -> Self {
        let share = share();
        let (predicted, _) = share.clip(activation + (activation - self.last));
        Self { last: activation, predicted }
    }

    fn words(self) -> impl Iterator<Item = S::Bits> {
        [self.last.to_bits(), self.predicted.to_bits()].into_iter()
    }

    fn restored<I: Iterator<Item = S::Bits>>(saved: &mut Saved<I>) -> Result<Self, RestoreError> {
        let mut of_share = || saved.number(|value| share().contains(value));
        Ok(Self { last: of_share()?, predicted: of_share()? })
    }
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

/// What a share may be.
pub(crate) fn share<S: Scalar>() -> Range<S> {
    Range { least: S::ZERO, most: S::ONE }
}
