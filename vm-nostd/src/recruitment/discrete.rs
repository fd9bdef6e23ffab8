//! Natural discrete recruitment: individual motor units.
//!
//! Uth_j = max(0.001, U_r × cross section of units 1 to j), types in order of rank;
//! f_env_j rises linearly with U from fmin at Uth_j to fmax at U = 1;
//! each unit has its own f_int, f_eff and S; active force Σ pcsa_j Af_j (FL FV + F_pe2).

use super::acting_length::ActingLength;
use super::firing::Firing;
use super::mode::{Moment, Recruited, Recruitment, RecruitmentState, RecruitmentTick};
use super::motor_units::MotorUnits;
use super::unit::{Activity, advance_sag};
use crate::equations::activation_frequency;
use crate::equations::excitation::{self, ExcitationInput};
use crate::equations::sag::{FIRING, share_above};
use crate::error::ParameterError;
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::saved::{RestoreError, Saved};
use crate::scalar::{Arithmetic, Scalar, sealed::Sealed};
use crate::summed::summed;
use crate::tick::range::{Range, share};
use crate::tick::time_step::TimeStep;
use core::marker::PhantomData;

/// Natural discrete recruitment of at most `UNITS` motor units, whose Af depends on the length `A`.
/// The stimulation frequency is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NaturalDiscrete<A, const UNITS: usize>(PhantomData<A>);

impl<A, const UNITS: usize> Sealed for NaturalDiscrete<A, UNITS> {}

impl<S: Scalar, A: ActingLength<S>, const N: usize, const UNITS: usize> Recruitment<S, N>
    for NaturalDiscrete<A, UNITS>
{
    const MODE: u32 = A::MODE;

    type Units = MotorUnits<UNITS>;
    type State = DiscreteState<S, A, UNITS>;
    type Coefficients = Coefficients<S, A, UNITS>;
}

summed! {
    #[derive(Clone, Copy, Debug)]
    pub struct Coefficients<S: Scalar, A: ActingLength<S>, const UNITS: usize> {
        units: [Unit<S, A::Coefficients>; UNITS],
        /// Number of units.
        count: usize,
    }

    valid: |coefficients| (1..=UNITS).contains(&coefficients.count)
}

summed! {
    #[derive(Clone, Copy, Debug)]
    struct Unit<S: Scalar, L> {
        /// Index of its fibre type.
        fiber: usize,
        /// Cross section, as a share of the muscle.
        share: S,
        firing: Firing<S>,
        acting_length: L,
    }
}

/// State of the motor units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteState<S: Scalar, A: ActingLength<S>, const UNITS: usize> {
    units: [UnitState<S, A::State>; UNITS],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct UnitState<S: Scalar, L> {
    /// f_int, f0.5.
    intermediate_frequency: S::Wide,
    /// f_eff, f0.5.
    effective_frequency: S::Wide,
    /// S.
    sag: S::Wide,
    activity: Activity<S>,
    acting_length: L,
}

/// Lower bound of recruitment thresholds.
const LEAST_THRESHOLD: f64 = 0.001;

impl<S: Scalar, A: ActingLength<S>, const N: usize, const UNITS: usize> RecruitmentTick<S, N>
    for Coefficients<S, A, UNITS>
{
    const PASSIVE_ONLY_PULLS: bool = false;

    type Units = MotorUnits<UNITS>;
    type State = DiscreteState<S, A, UNITS>;

    fn new(
        params: &MuscleParams<N>,
        units: &Self::Units,
        step: TimeStep,
    ) -> Result<Self, ParameterError> {
        units.validate(params)?;
        let mut cumulative = 0.0;
        let mut coefficients = units.iter().filter_map(|unit| {
            let fiber_type = &params.fibers.get(unit.fiber)?.fiber_type;
            cumulative += unit.share;
            let threshold = params.recruitment_saturation * cumulative;
            let threshold = Arithmetic::min(Arithmetic::max(threshold, LEAST_THRESHOLD), 1.0);
            Some(Unit {
                fiber: unit.fiber,
                share: S::from_f64(unit.share),
                firing: Firing::new(fiber_type, threshold),
                acting_length: A::new(fiber_type, params.fascicle_domain(), step),
            })
        });
        let Some(first) = coefficients.next() else { return Err(units.none()) };
        // Elements from `count` on are unused.
        let mut all = [first; UNITS];
        all.iter_mut().skip(1).zip(coefficients).for_each(|(place, unit)| *place = unit);
        Ok(Self { units: all, count: units.count() })
    }

    fn fits(&self) -> bool {
        self.units.iter().all(|unit| unit.fiber < N)
    }

    fn at_rest(&self, fibers: &[Fiber<S>; N]) -> Self::State {
        let units = self.units.map(|unit| UnitState {
            intermediate_frequency: S::ZERO.wide(),
            effective_frequency: S::ZERO.wide(),
            sag: fibers.get(unit.fiber).map_or(S::ONE, |fiber| fiber.sag.resting_level).wide(),
            activity: Activity::NONE,
            acting_length: A::at_rest(),
        });
        DiscreteState { units }
    }

    fn restored<I: Iterator<Item = S::Bits>>(
        &self,
        fibers: &[Fiber<S>; N],
        saved: &mut Saved<I>,
    ) -> Result<Self::State, RestoreError> {
        let mut state = self.at_rest(fibers);
        for (unit_state, unit) in state.units.iter_mut().zip(&self.units) {
            let frequencies = Range { least: S::ZERO, most: unit.firing.frequency(S::ONE) };
            let levels = fibers.get(unit.fiber).map_or(share(), |fiber| fiber.sag.range());
            *unit_state = UnitState {
                intermediate_frequency: saved.wide(&frequencies)?,
                effective_frequency: saved.wide(&frequencies)?,
                sag: saved.wide(&levels)?,
                activity: Activity::restored(saved)?,
                acting_length: A::restored(&unit.acting_length, saved)?,
            };
        }
        Ok(state)
    }

    fn advance(
        &self,
        fibers: &[Fiber<S>; N],
        state: &mut Self::State,
        moment: &Moment<S, N>,
    ) -> [Recruited<S>; N] {
        let curves = activation_frequency::curves(
            fibers.each_ref().map(|f| &f.activation),
            moment.reciprocal,
        );
        let mut activations = [S::ZERO; N];
        for (unit_state, unit) in state.units.iter_mut().zip(&self.units).take(self.count) {
            let of_type = fibers.get(unit.fiber).zip(curves.get(unit.fiber));
            let yieldings = moment.yieldings.get(unit.fiber);
            let Some((((fiber, curve), yieldings), sum)) =
                of_type.zip(yieldings).zip(activations.get_mut(unit.fiber))
            else {
                continue;
            };
            let drive = unit.firing.frequency(moment.input.activation);
            let before = unit_state.effective_frequency;
            let input = ExcitationInput {
                excitation: &fiber.excitation,
                intermediate: unit_state.intermediate_frequency,
                effective: before,
                drive,
                frequency: drive,
                slowing: unit_state.activity.predicted,
            };
            let [excited] = excitation::advance([input], moment.fascicle_length, moment.reciprocal);
            unit_state.intermediate_frequency = excited.intermediate;
            unit_state.effective_frequency = excited.effective;
            let acting_length = A::advance(
                &unit.acting_length,
                &mut unit_state.acting_length,
                unit_state.activity.predicted,
                moment,
            );
            let [curve] = match acting_length {
                Some(own) => activation_frequency::curves([&fiber.activation], own.reciprocal()),
                None => [*curve],
            };
            let firing = share_above(S::of(before), S::of(excited.effective), S::constant(&FIRING));
            let sag = advance_sag(fiber, &mut unit_state.sag, firing);
            let frequency = excited.effective_at_middle * (*yieldings * sag);
            let activation = curve.at(frequency);
            unit_state.activity = unit_state.activity.next(activation);
            *sum = *sum + unit.share * activation;
        }
        activations.map(|activation| Recruited {
            activation,
            weight: S::ONE,
            change_after_jump: None,
            compression_weight: S::ONE,
        })
    }
}

impl<S: Scalar, A: ActingLength<S>, const UNITS: usize> RecruitmentState<S>
    for DiscreteState<S, A, UNITS>
{
    const WORDS: usize = UNITS * (Activity::<S>::WORDS + 3 * S::WIDE_WORDS + A::WORDS);

    fn words(&self) -> impl Iterator<Item = S::Bits> {
        self.units.into_iter().flat_map(|unit| {
            S::wide_words(unit.intermediate_frequency)
                .chain(S::wide_words(unit.effective_frequency))
                .chain(S::wide_words(unit.sag))
                .chain(unit.activity.words())
                .chain(A::words(unit.acting_length))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::PAPER_MUSCLE;
    use crate::recruitment::acting_length::FascicleLength;
    use crate::recruitment::motor_units::UnitSizes;

    /// Words that nobody emitted may name a type that is not there.
    #[test]
    fn units_of_a_type_that_is_not_there_do_not_fit() {
        let sizes = [UnitSizes::Equal(1), UnitSizes::Equal(2)];
        let units = MotorUnits::<4>::new(&PAPER_MUSCLE, sizes).expect("valid");
        let step = TimeStep::MILLISECOND;
        let mut coefficients =
            Coefficients::<f32, FascicleLength, 4>::new(&PAPER_MUSCLE, &units, step)
                .expect("valid");
        let fits = |c: &_| <_ as RecruitmentTick<f32, 2>>::fits(c);
        assert!(fits(&coefficients));
        coefficients.units[1].fiber = 2;
        assert!(!fits(&coefficients));
    }
}
