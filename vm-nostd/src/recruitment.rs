//! How activation becomes recruitment; one file per mode.

mod continuous;
mod fes;

pub use continuous::NaturalContinuous;
pub use fes::IntramuscularFes;

use crate::domain::Range;
use crate::excitation::Excitation;
use crate::muscle::Input;
use crate::params::MuscleParams;
use crate::scalar::{Scalar, sealed::Sealed};
use crate::state::FiberState;
use crate::time_step::TimeStep;
use core::fmt::Debug;

/// A mode of recruitment, for muscles of `N` fibre types.
pub trait Recruitment<S: Scalar, const N: usize>:
    Sealed + Copy + Debug + PartialEq + 'static
{
    #[doc(hidden)]
    type Coefficients: RecruitmentTick<S, N>;
}

/// What the modes do differently in a tick.
#[doc(hidden)]
pub trait RecruitmentTick<S: Scalar, const N: usize>: Sized {
    /// Whether the passive force, filament compression included, is kept from pushing on its own.
    const PASSIVE_ONLY_PULLS: bool;
    /// Whether the force of the filaments may jump where a tick begins.
    const FORCE_JUMPS: bool;

    fn new(params: &MuscleParams<N>, step: TimeStep) -> Self;

    /// Where effective activation, and f_int and f_eff of each type, always are.
    fn ranges(&self) -> (Range<S>, [Range<S>; N]);

    /// Advances effective activation and excitation by one tick, in the middle of which each type
    /// has an activation (Af) and the fascicles have a length.
    fn advance(
        &self,
        excitations: [&Excitation<S>; N],
        effective_activation: &mut S::Slow,
        fibers: &mut [FiberState<S>; N],
        activations: &[S; N],
        input: &Input<S>,
        fascicle_length: S,
    ) -> [Recruited<S>; N];
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

    /// The value `time` ticks after the middle.
    pub(crate) fn at(&self, time: S) -> S {
        self.middle + self.change * time
    }
}

/// How a fibre type is recruited during a tick.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Recruited<S> {
    /// Frequency that acts on the filaments, f0.5.
    pub(crate) frequency: Course<S>,
    /// Share of the tick, 0..1, in which the type counts as firing, for sag.
    pub(crate) firing: S,
    /// Share of the muscle's force that the type's filaments add, at Af FL FV = 1.
    pub(crate) weight: Course<S>,
    /// The same for the compression of its thick filaments.
    pub(crate) compression_weight: Course<S>,
}
