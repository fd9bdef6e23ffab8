//! Intramuscular FES: every fibre type is recruited in proportion to its cross section, at one
//! stimulation frequency.
//!
//! f_env_i = f_stim/f0.5_i, always on, and Af_i uses it directly; the two lags of excitation are
//! driven by U instead and carry the recruitment. Rising Tf = Tf1 L² + Tf2 f_env_i, falling
//! Tf = (Tf3 + Tf4 [U > 0])/L. Sag switches on f_env_i > 0.1.

use super::{Course, Recruited, Recruitment, RecruitmentTick};
use crate::domain::Range;
use crate::excitation::Excitation;
use crate::muscle::Input;
use crate::params::MuscleParams;
use crate::sag::SagParams;
use crate::scalar::{Scalar, sealed::Sealed};
use crate::state::FiberState;
use crate::time_step::TimeStep;

/// Intramuscular FES: activation is the strength of the stimulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntramuscularFes;

impl Sealed for IntramuscularFes {}

impl<S: Scalar, const N: usize> Recruitment<S, N> for IntramuscularFes {
    type Coefficients = Coefficients<S, N>;
}

#[derive(Clone, Copy, Debug)]
pub struct Coefficients<S: Scalar, const N: usize> {
    firing: S,
    units: [Unit<S>; N],
}

#[derive(Clone, Copy, Debug)]
struct Unit<S: Scalar> {
    fraction: S,
    /// 1/f0.5, s.
    per_half_force_frequency: S::Factor,
}

impl<S: Scalar, const N: usize> RecruitmentTick<S, N> for Coefficients<S, N> {
    const PASSIVE_ONLY_PULLS: bool = true;
    /// Af follows the stimulation frequency at once.
    const FORCE_JUMPS: bool = true;

    fn new(params: &MuscleParams<N>, _step: TimeStep) -> Self {
        Self {
            firing: S::from_f64(SagParams::FIRING),
            units: params.fibers.map(|fiber| Unit {
                fraction: S::from_f64(fiber.fraction),
                per_half_force_frequency: S::per_pps(1.0 / fiber.fiber_type.half_force_frequency),
            }),
        }
    }

    fn ranges(&self) -> (Range<S>, [Range<S>; N]) {
        // The two lags carry the recruitment.
        let recruitment = Range { least: S::ZERO, most: S::ONE };
        (Range { least: S::ZERO, most: S::ZERO }, [recruitment; N])
    }

    fn advance(
        &self,
        excitations: [&Excitation<S>; N],
        _effective_activation: &mut S::Slow,
        fibers: &mut [FiberState<S>; N],
        _activations: &[S; N],
        input: &Input<S>,
        fascicle_length: S,
    ) -> [Recruited<S>; N] {
        let slowing = if input.activation > S::ZERO { S::ONE } else { S::ZERO };
        let mut recruited = [Recruited {
            frequency: Course::constant(S::ZERO),
            firing: S::ZERO,
            weight: Course::constant(S::ZERO),
            compression_weight: Course::constant(S::ZERO),
        }; N];
        for (((result, unit), fiber), excitation) in
            recruited.iter_mut().zip(&self.units).zip(fibers).zip(excitations)
        {
            let frequency =
                S::of_frequency(input.stimulation_frequency, &unit.per_half_force_frequency);
            let before = fiber.effective_frequency;
            let excited = excitation.advance(
                (fiber.intermediate_frequency, before),
                input.activation,
                frequency,
                slowing,
                fascicle_length,
            );
            fiber.intermediate_frequency = excited.intermediate;
            fiber.effective_frequency = excited.effective;
            *result = Recruited {
                frequency: Course::constant(frequency),
                firing: if frequency > self.firing { S::ONE } else { S::ZERO },
                weight: Course {
                    middle: unit.fraction * excited.effective_at_middle,
                    change: unit.fraction * (S::of(excited.effective) - S::of(before)),
                },
                compression_weight: Course::constant(unit.fraction),
            };
        }
        recruited
    }
}
