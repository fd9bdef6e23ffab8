//! The length in the activation-frequency relation of a motor unit.
//!
//! It is the fascicle length L or, with effective length (VM 3.x), the unit's own L_eff:
//! dL_eff/dt = (L - L_eff)³/(T_L (1 - Af)), L_eff = 1 at rest.

use super::mode::Moment;
use crate::params::FiberType;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::scalar::constant::Constant;
use crate::summed::{FromWords, summed};
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;
use core::fmt::Debug;

/// Af depends on the fascicle length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FascicleLength;

/// Af depends on the effective length, which lags the fascicle length; the lag is longer the less
/// active the unit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EffectiveLength;

/// The length in the activation-frequency relation of a unit.
#[doc(hidden)]
pub trait ActingLength<S: Scalar>: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// State of the length.
    type State: Copy + Debug + PartialEq + Send + Sync;
    type Coefficients: Copy + Debug + FromWords + Send + Sync;
    const WORDS: usize;
    /// Mode number of discrete recruitment with this length.
    const MODE: u32;

    /// Coefficients of a type in a muscle with a validity range of fascicle lengths (L_ce0).
    fn new(fiber_type: &FiberType, domain: (f64, f64), step: TimeStep) -> Self::Coefficients;
    fn at_rest() -> Self::State;
    fn words(state: Self::State) -> impl Iterator<Item = S::Bits>;
    fn restored<I: Iterator<Item = S::Bits>>(
        coefficients: &Self::Coefficients,
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError>;

    /// Advances the length by one tick with the unit's mid-tick Af. Returns the mid-tick length, or
    /// `None` if it is the fascicle length.
    fn advance<const N: usize>(
        coefficients: &Self::Coefficients,
        state: &mut Self::State,
        activation: S,
        moment: &Moment<S, N>,
    ) -> Option<S>;
}

impl<S: Scalar> ActingLength<S> for FascicleLength {
    type State = ();
    type Coefficients = ();
    const WORDS: usize = 0;
    const MODE: u32 = 3;

    fn new(_: &FiberType, _: (f64, f64), _: TimeStep) {}
    fn at_rest() {}
    fn words((): ()) -> impl Iterator<Item = S::Bits> {
        core::iter::empty()
    }
    fn restored<I: Iterator<Item = S::Bits>>(
        (): &(),
        _: &mut Saved<I>,
    ) -> Result<(), RestoreError> {
        Ok(())
    }
    fn advance<const N: usize>((): &(), (): &mut (), _: S, _: &Moment<S, N>) -> Option<S> {
        None
    }
}

/// Lower bound of 1 - Af, a divisor. Near Af = 1, n_f has hardly any effect on Af.
const LEAST_INACTIVE: Constant = Constant::new(1e-4);

summed! {
    /// Coefficients of the effective length.
    #[derive(Clone, Copy, Debug)]
    pub struct EffectiveLengthCoefficients<S: Scalar> {
        /// dt/T_L: increase of 1/x² in half a tick for an inactive unit, x = L - L_eff.
        rate: S,
        /// Range of L_eff, in which n_f is defined.
        range: Range<S>,
    }
}

impl<S: Scalar> ActingLength<S> for EffectiveLength {
    type State = S::Wide;
    type Coefficients = EffectiveLengthCoefficients<S>;
    const WORDS: usize = S::WIDE_WORDS;
    const MODE: u32 = 4;

    fn new(fiber_type: &FiberType, domain: (f64, f64), step: TimeStep) -> Self::Coefficients {
        EffectiveLengthCoefficients {
            rate: S::from_f64(step.seconds() / fiber_type.effective_length_time),
            range: Range::new(domain, S::from_f64),
        }
    }

    fn at_rest() -> S::Wide {
        S::ONE.wide()
    }

    fn words(state: S::Wide) -> impl Iterator<Item = S::Bits> {
        S::wide_words(state)
    }

    fn restored<I: Iterator<Item = S::Bits>>(
        coefficients: &Self::Coefficients,
        saved: &mut Saved<I>,
    ) -> Result<S::Wide, RestoreError> {
        saved.wide(&coefficients.range)
    }

    /// x = L - L_eff obeys dx/dt = V - x³/τ, τ = T_L (1 - Af). In each half-tick L is held constant
    /// at its value in the middle of the half; the equation is then solved exactly:
    /// x → x/√(1 + 2 x² t/τ).
    fn advance<const N: usize>(
        coefficients: &Self::Coefficients,
        state: &mut S::Wide,
        activation: S,
        moment: &Moment<S, N>,
    ) -> Option<S> {
        let before = S::of(*state);
        let inactive = (S::ONE - activation).max(S::constant(&LEAST_INACTIVE));
        let quarter = moment.travel.half().half();
        // x at the start of a half-tick, and the share 1 - 1/√grown by which it decreases.
        let step = |length: S, from: S| {
            let distance = coefficients.range.clip(length).0 - from;
            let grown = S::ONE + (distance * distance * coefficients.rate).ratio(inactive);
            (distance, grown.ln().half().lag_response())
        };
        let first = step(moment.fascicle_length - quarter, before);
        let middle = S::of(S::advanced(*state, first.0, first.1));
        let second = step(moment.fascicle_length + quarter, middle);
        *state = S::advanced_by_two(*state, first, second);
        Some(middle)
    }
}
