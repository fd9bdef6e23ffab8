//! Everything with a checksum is read back from its words, and invalid words are refused.

use crate::beyond_paper::fatigue::{Fatigue, FatigueParams};
use crate::beyond_paper::recruitment_curve::{RecruitmentCurve, RecruitmentCurveParams};
use crate::beyond_paper::steady::SteadyFes;
use crate::control::{
    CommandLimits, ELBOW, Envelope, EnvelopeParams, GainEstimate, GainParams, Intervals, Joint,
    KNEE, Lead, LeadParams, Pi, PiParams, Prosthesis, ProsthesisParams,
};
use crate::mechanics::contraction::Contraction;
use crate::muscle::{ContinuousMuscle, DiscreteMuscle, EffectiveLengthMuscle, FesMuscle};
use crate::params::presets::PAPER_MUSCLE;
use crate::recruitment::{MotorUnits, UnitSizes};
use crate::scalar::Scalar;
use crate::scalar::fixed::{Factor, Fixed};
use crate::summed::{FromWords, Sink, Summed, Words, summed};
use crate::tick::lag::Lag;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

const STEP: TimeStep = TimeStep::MILLISECOND;

impl Sink for Vec<u32> {
    fn add(&mut self, word: u32) {
        self.push(word);
    }
}

fn words(of: &impl Summed) -> Vec<u32> {
    let mut words = Vec::new();
    of.sum(&mut words);
    words
}

fn read<T: FromWords>(words: &[u32]) -> Option<T> {
    let mut rest = Words::new(words);
    T::read(&mut rest).filter(|_| rest.left() == 0)
}

fn there_and_back<T: FromWords>(value: &T) {
    let all = words(value);
    assert_eq!(all.len(), T::WORDS);
    assert_eq!(words(&read::<T>(&all).expect("its own words")), all);
    for length in 0..all.len() {
        assert!(read::<T>(&all[..length]).is_none(), "{length} words");
    }
}

fn muscles_are_read_back<S: Scalar>() {
    let params = &PAPER_MUSCLE;
    let sizes = [UnitSizes::Default(2), UnitSizes::Default(1)];
    let units = MotorUnits::<5>::new(params, sizes).expect("units");
    there_and_back(&ContinuousMuscle::<S, 2>::build(params, STEP).expect("a muscle"));
    there_and_back(&FesMuscle::<S, 2>::build(params, STEP).expect("a muscle"));
    let built = DiscreteMuscle::<S, 2, 5>::build_with_units(params, &units, STEP);
    there_and_back(&built.expect("a muscle"));
    let built = EffectiveLengthMuscle::<S, 2, 5>::build_with_units(params, &units, STEP);
    there_and_back(&built.expect("a muscle"));
    there_and_back(&SteadyFes::<S, 2>::build(params).expect("an inverse"));
    there_and_back(&Fatigue::<S>::build(&FatigueParams::QUADRICEPS, STEP).expect("fatigue"));
    let curve =
        RecruitmentCurveParams { threshold: 6e-3, saturation: 18e-3, chronaxie: 2e-4, slope: 2.0 };
    there_and_back(&RecruitmentCurve::<S>::build(&curve).expect("a curve"));
}

fn controls_are_read_back<S: Scalar>() {
    let knee = KNEE.muscles.map(|muscle| muscle.on_joint());
    there_and_back(&Joint::<S, 1, 2>::build(&[KNEE.range], &knee).expect("a joint"));
    let mut envelope =
        EnvelopeParams { rest: 0.01, maximal: 0.5, cutoff_frequency: 4.0, delay: 3e-3, shape: 0.0 };
    let limits = CommandLimits { least: 5.0, most: 60.0, rate: 1000.0 };
    for shape in [-1.5, 0.0] {
        envelope.shape = shape;
        there_and_back(&Envelope::<S, 3>::build(&envelope, STEP).expect("an envelope"));
        let params = ProsthesisParams {
            range: ELBOW.range,
            muscles: ELBOW.muscles.map(|muscle| muscle.params()),
            paths: ELBOW.muscles.map(|muscle| muscle.path()),
            envelopes: [envelope; 2],
            torque: limits,
            stiffness: limits,
        };
        there_and_back(&Prosthesis::<S, 2, 3>::build(&params, STEP).expect("a prosthesis"));
    }
    let gain = GainParams { time: 10.0, least: 0.5, most: 2.0, excitation: 1.0 };
    there_and_back(&GainEstimate::<S>::build(&gain, 1.0, STEP).expect("an estimate"));
    there_and_back(&Intervals::<S>::build(0.5, STEP).expect("intervals"));
    let lead = LeadParams { rise_time: 0.05, fall_time: 0.06, filter_time: 0.025 };
    there_and_back(&Lead::<S>::build(&lead, STEP).expect("a lead"));
    let pi = PiParams {
        proportional: 15.0,
        integral: 8.0,
        derivative: 3.0,
        derivative_filter: 0.02,
        most: 20.0,
    };
    there_and_back(&Pi::<S>::build(&pi, 1024.0, 1.0, STEP).expect("feedback"));
}

#[test]
fn everything_built_is_read_back_from_its_words() {
    muscles_are_read_back::<f32>();
    muscles_are_read_back::<f64>();
    muscles_are_read_back::<Fixed>();
    controls_are_read_back::<f32>();
    controls_are_read_back::<f64>();
    controls_are_read_back::<Fixed>();
}

#[test]
fn numbers_that_no_value_has_are_refused() {
    assert_eq!((read::<bool>(&[1]), read::<bool>(&[2])), (Some(true), None));
    assert_eq!((read::<u8>(&[255]), read::<u8>(&[256])), (Some(255), None));
    assert_eq!(read::<usize>(&[7, 0]), Some(7));
    assert_eq!(read::<usize>(&[7, 1]), usize::try_from(7 + (1_u64 << 32)).ok());
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(read::<f32>(&[value.to_bits()]).is_none());
        assert!(read::<f64>(&words(&f64::from(value))).is_none());
    }
    assert!(read::<[u32; 0]>(&[]).is_none());
    // Mantissa and shift.
    let shifts = (0..=300).filter(|&shift| read::<Factor>(&[1 << 30, shift]).is_some());
    assert!(shifts.eq(1..=62));
    assert!(read::<Range<Fixed>>(&[1, 1]).is_some() && read::<Range<Fixed>>(&[2, 1]).is_none());
    let lag = |shares: [f32; 2]| read::<Lag<f32>>(&shares.map(f32::to_bits)).is_some();
    assert!(lag([0.0, 1.0]) && !lag([-0.1, 1.0]) && !lag([0.5, 1.1]));
    // The number of substeps, from its place in the words of the mechanics.
    let mut mechanics = words(&Contraction::<f32>::new(&PAPER_MUSCLE, STEP));
    let place = mechanics.iter().position(|&word| word == 4).expect("four substeps");
    let counts = (0..300).filter(|&count| {
        mechanics[place] = count;
        read::<Contraction<f32>>(&mechanics).is_some()
    });
    assert!(counts.eq(1..=40));
}

#[test]
fn delays_and_shapes_of_an_envelope_are_checked() {
    let params = EnvelopeParams {
        rest: 0.01,
        maximal: 0.5,
        cutoff_frequency: 4.0,
        delay: 3e-3,
        shape: -1.0,
    };
    let built = Envelope::<f32, 3>::build(&params, STEP).expect("an envelope");
    let all = words(&built);
    // Ticks (two words) and shape (two words) are last.
    let [.., ticks, _, exponent, _] = [0, 1, 2, 3].map(|index| all.len() - 4 + index);
    let with = |place: usize, word: u32| {
        let mut other = all.clone();
        other[place] = word;
        read::<Envelope<f32, 3>>(&other).is_some()
    };
    assert!(with(ticks, 0) && with(ticks, 3) && !with(ticks, 4));
    assert!(with(exponent, (-0.5_f32).to_bits()) && !with(exponent, 0.5_f32.to_bits()));
    // An exponent of 0 has no factor.
    assert!(!with(exponent, 0));
}

mod layouts {
    use super::*;

    summed! {
        #[derive(Clone, Copy)]
        struct Two {
            first: u32,
            second: u32,
        }
    }
    summed! {
        #[derive(Clone, Copy)]
        struct Swapped {
            second: u32,
            first: u32,
        }
    }
    summed! {
        #[derive(Clone, Copy)]
        struct OtherFormat {
            first: u32,
            second: i32,
        }
    }
    summed! {
        #[derive(Clone, Copy)]
        struct Nested<S, const N: usize> {
            first: [S; N],
        }
    }

    #[test]
    fn names_order_and_formats_make_a_layout() {
        let layouts = [
            Two::LAYOUT,
            Swapped::LAYOUT,
            OtherFormat::LAYOUT,
            Nested::<u32, 2>::LAYOUT,
            Nested::<u32, 3>::LAYOUT,
            Nested::<Two, 1>::LAYOUT,
        ];
        for (index, layout) in layouts.iter().enumerate() {
            assert!(layouts[..index].iter().all(|other| other != layout), "{index}");
        }
        assert_eq!(words(&Two { first: 1, second: 2 }), [1, 2]);
        assert_eq!(words(&Swapped { second: 2, first: 1 }), [2, 1]);
        assert_eq!(words(&OtherFormat { first: 1, second: -1 }), [1, u32::MAX]);
        assert_eq!(words(&Nested { first: [1_u32, 2] }), [1, 2]);
    }
}
