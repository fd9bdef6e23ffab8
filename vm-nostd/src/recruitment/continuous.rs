//! Natural continuous recruitment: one lumped unit per fibre type.
//!
//! Uth_1 = 0.001, Uth_i = U_r × cross section of the types before;
//! dU_eff/dt = (U - U_eff)/T_U, T_U = 0.03 s rising, 0.15 s falling;
//! W_i = (U_eff - Uth_i)/Σ (U_eff - Uth_k), over all recruited types.
//!
//! The paper prints the sum only up to i; its own results, and its authors' program, sum over all
//! recruited types, so that the weights add to 1.

use super::{Course, Recruited, Recruitment, RecruitmentTick};
use crate::domain::Range;
use crate::excitation::Excitation;
use crate::lag::Lag;
use crate::muscle::Input;
use crate::params::MuscleParams;
use crate::sag::{SagParams, share_above};
use crate::scalar::{Scalar, sealed::Sealed};
use crate::state::FiberState;
use crate::time_step::TimeStep;

/// Natural continuous recruitment. The stimulation frequency is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NaturalContinuous;

impl Sealed for NaturalContinuous {}

impl<S: Scalar, const N: usize> Recruitment<S, N> for NaturalContinuous {
    type Coefficients = Coefficients<S, N>;
}

/// Threshold of the first type, and time constants of effective activation (s).
const FIRST_THRESHOLD: f64 = 0.001;
const RISE_TIME: f64 = 0.03;
const FALL_TIME: f64 = 0.15;

#[derive(Clone, Copy, Debug)]
pub struct Coefficients<S: Scalar, const N: usize> {
    rise: Lag<S>,
    fall: Lag<S>,
    firing: S,
    units: [Unit<S>; N],
}

#[derive(Clone, Copy, Debug)]
struct Unit<S: Scalar> {
    /// Uth.
    threshold: S,
    /// fmin.
    minimum_frequency: S,
    /// (fmax - fmin)/(1 - Uth).
    frequency_slope: S::Factor,
}

impl<S: Scalar> Unit<S> {
    /// f_env: from fmin at the threshold to fmax at U = 1, by raw activation.
    fn firing_frequency(&self, activation: S) -> S {
        if activation >= self.threshold {
            self.minimum_frequency + (activation - self.threshold).scaled(&self.frequency_slope)
        } else {
            S::ZERO
        }
    }
}

impl<S: Scalar, const N: usize> RecruitmentTick<S, N> for Coefficients<S, N> {
    const PASSIVE_ONLY_PULLS: bool = false;
    const FORCE_JUMPS: bool = false;

    fn new(params: &MuscleParams<N>, step: TimeStep) -> Self {
        let mut before = 0.0;
        let units = params.fibers.map(|fiber| {
            let t = &fiber.fiber_type;
            let threshold = if before == 0.0 {
                FIRST_THRESHOLD
            } else {
                params.recruitment_saturation * before
            };
            before += fiber.fraction;
            let slope = (t.maximum_frequency - t.minimum_frequency) / (1.0 - threshold);
            Unit {
                threshold: S::from_f64(threshold),
                minimum_frequency: S::from_f64(t.minimum_frequency),
                frequency_slope: S::factor(slope),
            }
        });
        Self {
            rise: Lag::new(RISE_TIME, step),
            fall: Lag::new(FALL_TIME, step),
            firing: S::from_f64(SagParams::FIRING),
            units,
        }
    }

    fn ranges(&self) -> (Range<S>, [Range<S>; N]) {
        let frequencies =
            self.units.map(|unit| Range { least: S::ZERO, most: unit.firing_frequency(S::ONE) });
        (Range { least: S::ZERO, most: S::ONE }, frequencies)
    }

    fn advance(
        &self,
        excitations: [&Excitation<S>; N],
        effective_activation: &mut S::Slow,
        fibers: &mut [FiberState<S>; N],
        activations: &[S; N],
        input: &Input<S>,
        fascicle_length: S,
    ) -> [Recruited<S>; N] {
        let activation = input.activation;
        let start = *effective_activation;
        // U is constant in a tick, and U_eff only tends to it: the branch cannot change within.
        let lag = if activation >= S::of(start) { &self.rise } else { &self.fall };
        let middle = lag.at_middle(start, activation);
        let end = lag.at_end(start, activation);
        *effective_activation = end;
        let change = S::of(end) - S::of(start);

        let (mut sum, mut count) = (S::ZERO, S::ZERO);
        for unit in &self.units {
            if middle >= unit.threshold {
                sum = sum + (middle - unit.threshold);
                count = count + S::ONE;
            }
        }
        // At its own threshold a single type carries everything, whatever the excess.
        let of_sum = |value: S| if sum > S::ZERO { value.ratio(sum) } else { S::ZERO };
        let relative_change = of_sum(change);

        let mut recruited = [Recruited {
            frequency: Course::constant(S::ZERO),
            firing: S::ZERO,
            weight: Course::constant(S::ZERO),
            compression_weight: Course::constant(S::ZERO),
        }; N];
        for ((((result, unit), fiber), excitation), slowing) in
            recruited.iter_mut().zip(&self.units).zip(fibers).zip(excitations).zip(activations)
        {
            let drive = unit.firing_frequency(activation);
            let before = fiber.effective_frequency;
            let excited = excitation.advance(
                (fiber.intermediate_frequency, before),
                drive,
                drive,
                *slowing,
                fascicle_length,
            );
            fiber.intermediate_frequency = excited.intermediate;
            fiber.effective_frequency = excited.effective;

            // U_eff W = U_eff (U_eff - Uth)/sum, and its derivative by U_eff.
            let weight = if middle >= unit.threshold {
                let excess = middle - unit.threshold;
                let value = middle * of_sum(excess);
                let slope = middle + excess - count * value;
                Course { middle: value, change: slope * relative_change }
            } else {
                Course::constant(S::ZERO)
            };
            *result = Recruited {
                frequency: Course {
                    middle: excited.effective_at_middle,
                    change: S::of(excited.effective) - S::of(before),
                },
                firing: share_above(S::of(before), S::of(excited.effective), self.firing),
                weight,
                compression_weight: weight,
            };
        }
        recruited
    }
}
