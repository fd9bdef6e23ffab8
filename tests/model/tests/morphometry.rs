//! Fixed point accepts the published morphometry that `f32` accepts, with the same accuracy:
//! fascicles of 1.5 to 50 cm, tendons of 0.05 to 12 fascicle lengths and at most 2 m, F0 of 1 N to
//! 16 kN, every preset alone and mixed.

use model_tests::muscles::config;
use proptest::prelude::*;
use vm_nostd::{
    Class, ElementParams, FascicleLength, FiberParams, FiberType, Fixed, Input, IntramuscularFes,
    MotorUnits, Muscle, MuscleParams, NaturalContinuous, NaturalDiscrete, Recruitment, Scalar,
    Status, SteadyFes, TimeStep, UnitSizes, feline_vm4, human_vm4, paper_table_1,
};

/// Fibre types of each muscle; a single type is repeated.
const TYPES: usize = 3;
type Params = MuscleParams<TYPES>;
type Discrete = NaturalDiscrete<FascicleLength, 6>;

/// The published sets with fibre types in order of rank, each type alone and mixed.
fn sets() -> Vec<(ElementParams, [FiberType; TYPES])> {
    let (human, feline, paper) =
        (human_vm4::ELEMENTS, feline_vm4::ELEMENTS, paper_table_1::ELEMENTS);
    let of_human = [human_vm4::SUPER_SLOW, human_vm4::SLOW, human_vm4::FAST];
    let of_feline = [feline_vm4::SUPER_SLOW, feline_vm4::SLOW, feline_vm4::FAST];
    let of_paper = [paper_table_1::SLOW, paper_table_1::FAST];
    let mut sets = vec![
        (human, of_human),
        (feline, of_feline),
        (paper, [of_paper[0], of_paper[0], of_paper[1]]),
        (human, [human_vm4::SLOW, human_vm4::FAST, human_vm4::FAST]),
        (feline, [feline_vm4::SUPER_SLOW, feline_vm4::SUPER_SLOW, feline_vm4::SLOW]),
    ];
    sets.extend(of_human.map(|alone| (human, [alone; TYPES])));
    sets.extend(of_feline.map(|alone| (feline, [alone; TYPES])));
    sets.extend(of_paper.map(|alone| (paper, [alone; TYPES])));
    sets
}

/// A muscle from a set, fascicle length (m), tendon length (fascicle lengths), F0 (N), two
/// fractions, U_r and L_max.
fn muscle(
    (elements, types): (ElementParams, [FiberType; TYPES]),
    (fascicle_length, ratio, newtons): (f64, f64, f64),
    (first, second, recruitment_saturation, longest): (f64, f64, f64, f64),
) -> Params {
    let tendon_length = (ratio * fascicle_length).min(2.0);
    let fractions = [first, (1.0 - first) * second, (1.0 - first) * (1.0 - second)];
    let mut params = MuscleParams {
        mass: newtons * elements.density * fascicle_length / elements.specific_tension,
        fascicle_length,
        tendon_length,
        max_path_length: fascicle_length + tendon_length,
        recruitment_saturation,
        class: Class::Standard,
        elements,
        fibers: std::array::from_fn(|index| FiberParams {
            fraction: fractions[index],
            fiber_type: types[index],
        }),
    };
    params.max_path_length += (longest - params.maximum_fascicle_length()) * fascicle_length;
    params
}

fn magnitude(least: f64, most: f64) -> impl Strategy<Value = f64> {
    (least.ln()..=most.ln()).prop_map(move |x| x.exp().clamp(least, most))
}

/// Any muscle of this domain; its corners as often as its interior.
fn published() -> impl Strategy<Value = Params> {
    let set = prop::sample::select(sets());
    let fascicle = prop_oneof![2 => magnitude(0.015, 0.5), 1 => Just(0.015), 1 => Just(0.5)];
    let ratio = prop_oneof![2 => magnitude(0.05, 12.0), 1 => Just(0.05), 1 => Just(12.0)];
    let force = prop_oneof![2 => magnitude(1.0, 16e3), 1 => Just(1.0), 1 => Just(16e3)];
    let other = (0.05..0.9_f64, 0.05..0.95_f64, 0.3..1.0_f64, 1.15..1.6_f64);
    (set, (fascicle, ratio, force), other).prop_map(|(set, size, other)| muscle(set, size, other))
}

trait Mode<S: Scalar>: Recruitment<S, TYPES> {
    fn units(params: &Params) -> Self::Units;
}

impl<S: Scalar> Mode<S> for NaturalContinuous {
    fn units(_: &Params) {}
}

impl<S: Scalar> Mode<S> for IntramuscularFes {
    fn units(_: &Params) {}
}

impl<S: Scalar> Mode<S> for Discrete {
    fn units(params: &Params) -> MotorUnits<6> {
        MotorUnits::new(params, [UnitSizes::Default(2); TYPES]).expect("valid units")
    }
}

/// Forces (F0) and flags of a second in which activation and path change slowly and the tendon is
/// taut.
fn mild<S: Scalar, R: Mode<S>>(params: &Params, step: TimeStep) -> (Vec<f64>, Status) {
    let muscle = Muscle::<S, R, TYPES>::build_with_units(params, &R::units(params), step)
        .unwrap_or_else(|error| panic!("{error}: {params:?}"));
    let tendon = params.elements.tendon.slack_length + 0.02;
    // The same inputs for all arithmetics: exact in `Fixed`, nearly exact in `f32`.
    let path = |fascicle: f64| {
        let metres = tendon * params.tendon_length + fascicle * params.fascicle_length;
        S::path_length((metres * 1e6).round() * 1e-6)
    };
    let mut state = muscle.rest(path(1.05)).expect("in range");
    let mut forces = Vec::new();
    let mut flags = Status::empty();
    for tick in 0..=(1.0 / step.seconds()) as u32 {
        let time = f64::from(tick) * step.seconds();
        let begun = (time / 0.3).min(1.0);
        let phase = std::f64::consts::TAU * time;
        let smooth = begun * begun * (3.0 - 2.0 * begun);
        let output = muscle.step(
            &mut state,
            Input {
                activation: S::from_f64((400.0 * smooth).round() / 1024.0),
                path_length: path(1.05 + 0.05 * smooth * phase.sin()),
                stimulation_frequency: S::quantity(20.0),
            },
        );
        flags |= output.status;
        forces.push(output.relative_force.to_f64());
    }
    (forces, flags)
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Error that fixed point may add to that of `f32`, F0: a tenth of the promised limit.
const ADDED: f64 = 1e-4;

fn as_accurate_as_f32<R: Mode<f64> + Mode<f32> + Mode<Fixed>>(
    params: &Params,
    step: TimeStep,
) -> [f64; 2] {
    let (exact, unflagged) = mild::<f64, R>(params, step);
    let (float, float_flags) = mild::<f32, R>(params, step);
    let (fixed, fixed_flags) = mild::<Fixed, R>(params, step);
    assert_eq!((float_flags, fixed_flags), (unflagged, unflagged), "{params:?}");
    assert_eq!(unflagged, Status::empty(), "{params:?}");
    [worst(&float, &exact), worst(&fixed, &exact)]
}

proptest! {
    #![proptest_config(config(192))]

    #[test]
    fn fixed_point_accepts_published_muscles_with_the_accuracy_of_f32(params in published(), tick in prop::sample::select(vec![1e-3, 0.5e-3, 2e-3])) {
        let step = TimeStep::from_seconds(tick).expect("a step");
        let found = [
            as_accurate_as_f32::<NaturalContinuous>(&params, step),
            as_accurate_as_f32::<IntramuscularFes>(&params, step),
            as_accurate_as_f32::<Discrete>(&params, step),
        ];
        for [float, fixed] in found {
            prop_assert!(fixed <= float + ADDED, "{fixed} {float} F0: {params:?}");
        }
    }

    #[test]
    fn any_input_bits_keep_the_state_valid(
        params in published(),
        tick in prop::sample::select(vec![1e-4, 1e-3, 2e-3]),
        inputs in prop::collection::vec(bits(), 1..12),
    ) {
        let step = TimeStep::from_seconds(tick).expect("a step");
        takes_any_bits::<NaturalContinuous>(&params, step, &inputs);
        takes_any_bits::<IntramuscularFes>(&params, step, &inputs);
        takes_any_bits::<Discrete>(&params, step, &inputs);
    }
}

/// Arbitrary bits of inputs, with valid paths in a large share.
fn bits() -> impl Strategy<Value = (i32, i32, i32)> {
    let activation = prop_oneof![any::<i32>(), 0..=1_i32 << 24];
    let path = prop_oneof![any::<i32>(), 0..300_000_000_i32, Just(i32::MIN), Just(i32::MAX)];
    (activation, path, any::<i32>())
}

fn takes_any_bits<R: Mode<Fixed>>(params: &Params, step: TimeStep, inputs: &[(i32, i32, i32)]) {
    let muscle = Muscle::<Fixed, R, TYPES>::build_with_units(params, &R::units(params), step)
        .expect("taken");
    let (shortest, longest) = muscle.path_length_range();
    for start in [shortest, longest] {
        let mut state = muscle.rest(start).expect("in range");
        for &(activation, path, frequency) in inputs {
            let mut input = Input::<Fixed>::from_integers(0, 0, 0);
            input.activation = Fixed::from_bits(activation);
            input.path_length = Fixed::path_from_bits(path as u32);
            input.stimulation_frequency = fixed::types::I16F16::from_bits(frequency);
            for _ in 0..10 {
                let output = muscle.step(&mut state, input);
                assert!(output.force >= 0 && output.relative_force >= Fixed::from_bits(0));
                assert_eq!(muscle.restore(muscle.save(&state)), Ok(state), "{output:?}");
            }
        }
    }
}

/// A muscle of 1 N: 1 mN would be a thousandth of F0.
fn one_newton_muscle() -> Params {
    let sets = sets();
    muscle(sets[0], (0.03, 1.0, 1.0), (0.3, 0.5, 0.8, 1.4))
}

#[test]
fn forces_of_a_one_newton_muscle_are_resolved_to_1e_4_of_f0() {
    let params = one_newton_muscle();
    let step = TimeStep::MILLISECOND;
    let (exact, _) = mild::<f64, NaturalContinuous>(&params, step);
    let (fixed, _) = mild::<Fixed, NaturalContinuous>(&params, step);
    assert!(worst(&fixed, &exact) < 1e-4, "{}", worst(&fixed, &exact));
    // A slowly rising force changes by less per tick, not in steps of 1 mN.
    let mut changes: Vec<f64> = fixed.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    changes.retain(|change| *change > 0.0);
    assert!(changes.len() > fixed.len() / 2, "{} of {}", changes.len(), fixed.len());
    assert!(changes.iter().copied().fold(1.0, f64::min) < 1e-6);
    // The inverse model has the same resolution.
    let steady = SteadyFes::<Fixed, TYPES>::build(&params).expect("a muscle");
    let path = Fixed::path_length(params.fascicle_length + params.tendon_length);
    for share in 1..200 {
        let wanted = Fixed::from_f64(f64::from(share) * 1e-3);
        let found = steady.activation_for_relative(wanted, path, <Fixed as Scalar>::quantity(30.0));
        let off = (found.relative_force.to_f64() - wanted.to_f64()).abs();
        assert!(off < 1e-4 && found.status.is_empty(), "{share}: {found:?}");
    }
}
