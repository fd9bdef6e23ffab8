//! Envelope of an EMG: rectified, low-passed, normalised, delayed, shaped.
//!
//! The samples' magnitude passes two equal lags whose gain together is 1/√2 at the cutoff,
//! T = √(√2 - 1)/(2π f_c). The result is normalised between rest and maximal voluntary contraction,
//! delayed by the electromechanical delay, and shaped to activation:
//!
//! a = (exp(A u) - 1)/(exp(A) - 1), and a = u for A = 0
//!
//! (Buchanan, Lloyd, Manal & Besier, J. Appl. Biomech. 20 (2004) 367-395).

use crate::checksum::Checksum;
use crate::error::{ParameterError, within};
use crate::saved::{RestoreError, Saved};
use crate::scalar::float::square_root;
use crate::scalar::{Kernels, Scalar};
use crate::summed::{FromWords, Sink, Summed, Words, summed};
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::range::share;
use crate::tick::time_step::TimeStep;

/// Parameters of an envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnvelopeParams {
    /// Mean rectified EMG at rest, mV; 0 to 9. More ignores more noise, and weak contractions.
    pub rest: f64,
    /// Mean rectified EMG of a maximal voluntary contraction, mV; 0.001 and 5 % more than at rest,
    /// to 10.
    pub maximal: f64,
    /// Cutoff f_c, Hz; 0.5 to 20. Higher follows faster and lets more ripple through.
    pub cutoff_frequency: f64,
    /// Electromechanical delay, s; 0 to the capacity of the delay line. It moves the command by as
    /// much: 0 for the fastest prosthesis, 0.01 to 0.1 to predict a biological joint.
    pub delay: f64,
    /// Shape A; -3 to 0. More negative raises weak contractions; 0 leaves them.
    pub shape: f64,
}

/// Least maximal EMG, in EMGs at rest: with less the state would hold many ranges of noise.
const LEAST_SIGNAL: f64 = 1.05;
/// From this shape to 0 a parabola differs from (exp(A u) - 1)/(exp(A) - 1) by less than 1e-5, and
/// 1/(exp(A) - 1) exceeds what fixed point holds.
const NEARLY_STRAIGHT: f64 = -0.03;

impl EnvelopeParams {
    /// Validates for a delay line of so many ticks; the error has field, value and limit.
    pub fn validate(&self, step: TimeStep, line: usize) -> Result<(), ParameterError> {
        within("envelope.rest", self.rest, 0.0, 9.0)?;
        // Rounded down, so that 5 % more in decimals is enough.
        let least = (self.rest + 1e-3).max(LEAST_SIGNAL * self.rest * (1.0 - f64::EPSILON));
        within("envelope.maximal", self.maximal, least, 10.0)?;
        within("envelope.cutoff_frequency", self.cutoff_frequency, 0.5, 20.0)?;
        within("envelope.delay", self.delay, 0.0, line as f64 * step.seconds())?;
        within("envelope.shape", self.shape, -3.0, 0.0)
    }
}

/// A, and 1/(exp(A) - 1); none if a parabola does.
#[derive(Clone, Copy, Debug)]
struct Shape<S>(Option<[S; 2]>);

/// Two words; without a shape both are those of 0.
impl<S: Scalar> Summed for Shape<S> {
    fn sum<T: Sink>(&self, sink: &mut T) {
        self.0.unwrap_or([S::ZERO; 2]).sum(sink);
    }
}

impl<S: Scalar> FromWords for Shape<S> {
    const WORDS: usize = <[S; 2]>::WORDS;
    const LAYOUT: Checksum = <[S; 2]>::LAYOUT;

    /// No shape has an exponent of 0.
    fn read(words: &mut Words<'_>) -> Option<Self> {
        match <[S; 2]>::read(words)? {
            [exponent, factor] if exponent < S::ZERO => Some(Self(Some([exponent, factor]))),
            none => (none == [S::ZERO; 2]).then_some(Self(None)),
        }
    }
}

summed! {
    /// An envelope with a delay line of at most `D` ticks.
    #[derive(Clone, Copy, Debug)]
    pub struct Envelope<S: Scalar, const D: usize> {
        /// A/2, of the parabola u (1 + A/2 (u - 1)).
        bend: S,
        greatest: S,
        lag: Lag<S>,
        /// 1/(maximal - rest), per mV, and rest in that unit.
        per_range: S::Factor,
        rest: S,
        ticks: usize,
        shape: Shape<S>,
    }

    valid: |envelope| envelope.ticks <= D
}

/// State of an envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeState<S: Scalar, const D: usize> {
    lags: [S::Wide; 2],
    /// The last normalised values; `next` is the oldest.
    line: [S; D],
    next: usize,
}

impl<S: Scalar, const D: usize> EnvelopeState<S, D> {
    /// Number of [`words`](Self::words).
    pub const WORDS: usize = 2 * S::WIDE_WORDS + D + 1;

    /// The bits.
    pub fn words(&self) -> impl Iterator<Item = S::Bits> {
        let lags = self.lags.into_iter().flat_map(S::wide_words);
        let next = S::Bits::from(self.next as u32);
        lags.chain(self.line.into_iter().map(S::to_bits)).chain(core::iter::once(next))
    }
}

/// Greatest rectified EMG beyond that at rest, in ranges from rest to maximal: artefacts are
/// clipped to it.
const GREATEST: f64 = 8.0;

impl<S: Scalar, const D: usize> Envelope<S, D> {
    /// Builds an envelope for a time step; the error has field, value and limit.
    pub fn build(params: &EnvelopeParams, step: TimeStep) -> Result<Self, ParameterError> {
        params.validate(step, D)?;
        let range = params.maximal - params.rest;
        let pair = square_root(square_root(2.0) - 1.0);
        let time = pair / (2.0 * core::f64::consts::PI * params.cutoff_frequency);
        let shape = params.shape;
        Ok(Self {
            lag: Lag::new(time, step),
            per_range: S::per_quantity(1.0 / range),
            rest: S::from_f64(params.rest / range),
            greatest: S::from_f64(params.rest / range + GREATEST),
            ticks: (params.delay / step.seconds() + 0.5) as usize,
            shape: Shape(
                (shape <= NEARLY_STRAIGHT)
                    .then(|| [S::from_f64(shape), S::from_f64(1.0 / (Kernels::exp(shape) - 1.0))]),
            ),
            bend: S::from_f64(0.5 * shape),
        })
    }

    /// State after a long rest.
    pub fn rested(&self) -> EnvelopeState<S, D> {
        EnvelopeState { lags: [self.rest.wide(); 2], line: [S::ZERO; D], next: 0 }
    }

    /// Takes a sample (mV) and returns the activation, 0..1, and whether the sample was not finite
    /// (then the envelope decays as at rest) or clipped to 8 times the range from rest
    /// to maximal, beyond rest.
    pub fn step(&self, state: &mut EnvelopeState<S, D>, sample: S::Quantity) -> (S, bool) {
        let finite = S::quantity_is_finite(sample);
        let magnitude =
            if finite { S::of_quantity(sample, &self.per_range).abs() } else { self.rest };
        let clipped = magnitude > self.greatest;
        let magnitude = magnitude.min(self.greatest);
        let [first, second] = state.lags;
        let first = self.lag.at_end(first, magnitude);
        let second = self.lag.at_end(second, S::of(first));
        state.lags = [first, second];
        let now = (S::of(second) - self.rest).max(S::ZERO).min(S::ONE);
        let delayed = self.delayed(state, now);
        let activation = match self.shape.0 {
            None => delayed * (S::ONE + self.bend * (delayed - S::ONE)),
            Some([exponent, factor]) => ((exponent * delayed).exp() - S::ONE) * factor,
        };
        (activation.max(S::ZERO).min(S::ONE), clipped || !finite)
    }

    fn delayed(&self, state: &mut EnvelopeState<S, D>, now: S) -> S {
        let Some(place) = state.line.get_mut(state.next) else { return now };
        let oldest = core::mem::replace(place, now);
        state.next = if state.next + 1 < self.ticks { state.next + 1 } else { 0 };
        if self.ticks == 0 { now } else { oldest }
    }

    /// The state whose words come next.
    pub(super) fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        saved: &mut Saved<I>,
    ) -> Result<EnvelopeState<S, D>, RestoreError> {
        let mut state = self.rested();
        let range = Range { least: S::ZERO, most: self.greatest };
        for lag in &mut state.lags {
            *lag = saved.wide(&range)?;
        }
        for value in &mut state.line {
            *value = saved.number(|value| share::<S>().contains(value))?;
        }
        state.next = saved.count(self.ticks.max(1))?;
        Ok(state)
    }
}
