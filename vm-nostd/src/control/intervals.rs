//! Pulses that are not periodic: the stimulation frequency that the equations are given.
//!
//! **Rule.** The frequency is the reciprocal of the last interval between two pulses, from the
//! second of them on; once more than that interval has passed since the last pulse, it is the
//! reciprocal of the time since. A pulse after a pause, of 0.5 s unless said otherwise, starts a
//! train: until the second pulse of a train the frequency is 0.
//!
//! **What the model can claim.** A periodic train gives its own frequency. A doublet at the start
//! of a train makes the force rise faster, as published (Binder-Macleod & Lee, J. Appl. Physiol. 80
//! (1996) 2051, abstract: human quadriceps, most with a first interval of 5 ms): Af is taken at the
//! high frequency. What it cannot show: the twitch of a single pulse, summation within one
//! interval, the catch-like property (force that stays higher after a doublet).

use crate::error::{ParameterError, within};
use crate::params::limits::MAXIMUM_STIMULATION_FREQUENCY;
use crate::scalar::Scalar;
use crate::summed::summed;
use crate::tick::time_step::TimeStep;

summed! {
    /// Turns pulses into a stimulation frequency.
    #[derive(Clone, Copy, Debug)]
    pub struct Intervals<S: Scalar> {
        /// A tick, and the pause that ends a train, in sixteenths of a second.
        tick: S,
        pause: S,
        unit: S::Factor,
        most: S::Quantity,
        none: S::Quantity,
    }
}

/// Time since the last pulse, and the interval before it; 0 for none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalState<S> {
    since: S,
    last: S,
}

/// Times count in reciprocals of this, s: frequencies of 1 to 500 pps are then 1/16 to 31.
const UNIT: f64 = 16.0;

impl<S: Scalar> Intervals<S> {
    /// The pause that ends a train, s.
    pub const PAUSE: f64 = 0.5;

    /// For a time step and a pause that ends a train (s; 0.05 to 5).
    pub fn build(pause: f64, step: TimeStep) -> Result<Self, ParameterError> {
        within("intervals.pause", pause, 0.05, 5.0)?;
        Ok(Self {
            tick: S::from_f64(step.seconds() * UNIT),
            // Between two ticks: rounding decides nothing.
            pause: S::from_f64((pause - 0.5 * step.seconds()) * UNIT),
            unit: S::quantity_factor(UNIT),
            most: S::quantity(MAXIMUM_STIMULATION_FREQUENCY),
            none: S::quantity(0.0),
        })
    }

    /// No pulse for long.
    pub fn silent(&self) -> IntervalState<S> {
        IntervalState { since: self.pause, last: S::ZERO }
    }

    /// Stimulation frequency (pps, at most 500) in a tick, at whose start there is a pulse or not.
    pub fn step(&self, state: &mut IntervalState<S>, pulse: bool) -> S::Quantity {
        state.since = (state.since + self.tick).min(self.pause);
        if pulse {
            state.last = if state.since < self.pause { state.since } else { S::ZERO };
            state.since = S::ZERO;
        }
        if state.last == S::ZERO || state.since >= self.pause {
            return self.none;
        }
        let frequency = state.since.max(state.last).reciprocal().to_quantity(&self.unit);
        if frequency > self.most { self.most } else { frequency }
    }
}
