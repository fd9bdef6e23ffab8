//! The length that the activation-frequency relation of a motor unit takes.
//!
//! It is the fascicles' length L; or, with effective length (VM 3.x), n_f of a unit takes its own
//! L_eff: dL_eff/dt = (L - L_eff)³/(T_L (1 - Af)), L_eff = 1 at rest.

use super::mode::Moment;
use crate::checksum::{Summed, summed};
use crate::params::FiberType;
use crate::saved::{RestoreError, Saved};
use crate::scalar::Scalar;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;
use core::fmt::Debug;

/// Af depends on the fascicles' length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FascicleLength;

/// Af depends on an effective length, which follows the fascicles' later the less a unit is active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EffectiveLength;

/// The length that the activation-frequency relation of a unit takes.
#[doc(hidden)]
pub trait ActingLength<S: Scalar>: Copy + Debug + PartialEq + 'static {
    /// What of it changes from tick to tick.
    type State: Copy + Debug + PartialEq;
    type Coefficients: Copy + Debug + Summed;
    const WORDS: usize;
    /// That of the discrete recruitment which takes it.
    const MODE: u32;

    /// Of a type, in a muscle whose equations hold from one fascicle length (L_ce0) to another.
    fn new(fiber_type: &FiberType, domain: (f64, f64), step: TimeStep) -> Self::Coefficients;
    fn at_rest() -> Self::State;
    fn words(state: Self::State) -> impl Iterator<Item = S::Bits>;
    fn restored<I: Iterator<Item = S::Bits>>(
        coefficients: &Self::Coefficients,
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError>;

    /// Advances it by one tick, in the middle of which Af of the unit is `activation`. None where
    /// it is that of the fascicles.
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

/// 1 - Af is not taken as less: n_f has hardly an influence on Af then.
const LEAST_INACTIVE: f64 = 1e-4;

/// Coefficients of the effective length.
#[derive(Clone, Copy, Debug)]
pub struct EffectiveLengthCoefficients<S: Scalar> {
    /// dt/T_L: what 1/x² of the distance x = L - L_eff gains in half a tick, of an inactive unit.
    rate: S,
    least_inactive: S,
    /// Where L_eff is kept: where n_f is defined.
    range: Range<S>,
}

summed!([S: Scalar] EffectiveLengthCoefficients<S> { rate, least_inactive, range });

impl<S: Scalar> ActingLength<S> for EffectiveLength {
    type State = S::LagState;
    type Coefficients = EffectiveLengthCoefficients<S>;
    const WORDS: usize = S::SLOW_WORDS;
    const MODE: u32 = 4;

    fn new(fiber_type: &FiberType, domain: (f64, f64), step: TimeStep) -> Self::Coefficients {
        EffectiveLengthCoefficients {
            rate: S::from_f64(step.seconds() / fiber_type.effective_length_time),
            least_inactive: S::from_f64(LEAST_INACTIVE),
            range: Range::new(domain, S::from_f64),
        }
    }

    fn at_rest() -> S::LagState {
        S::ONE.lag_state()
    }

    fn words(state: S::LagState) -> impl Iterator<Item = S::Bits> {
        S::lag_state_words(state)
    }

    fn restored<I: Iterator<Item = S::Bits>>(
        coefficients: &Self::Coefficients,
        saved: &mut Saved<I>,
    ) -> Result<S::LagState, RestoreError> {
        saved.lag_state(&coefficients.range)
    }

    /// The distance x = L - L_eff obeys dx/dt = V - x³/τ, τ = T_L (1 - Af). In each half of the
    /// tick L is where it is in the middle of that, and the rest is exact: x → x/√(1 + 2 x² t/τ).
    fn advance<const N: usize>(
        coefficients: &Self::Coefficients,
        state: &mut S::LagState,
        activation: S,
        moment: &Moment<S, N>,
    ) -> Option<S> {
        let before = S::of(*state);
        let inactive = (S::ONE - activation).max(coefficients.least_inactive);
        let quarter = moment.travel.half().half();
        // The way to a length, and the share 1 - 1/√grown of it that is gone, as that of a lag.
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
