//! Fixed point: no drift, no wrap-around, and the same muscle as in `f32`.
//!
//! CI runs these a second time in a profile that checks every addition for overflow.

use firmware::MUSCLE;
use host_sim::engine::{self, Arithmetic};
use host_sim::reference::{Input as ReferenceInput, Mode};
use host_sim::scenario::paper_muscle;
use host_sim::trace::InputTrace;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use vm_nostd::{
    ContinuousMuscle, FesMuscle, FiberParams, Fixed, Input, IntramuscularFes, Muscle, MuscleParams,
    NaturalContinuous, Recruitment, Scalar, State, TimeStep, feline_vm4, human_vm4, paper_table_1,
};

/// Steady force of the reference, N, at a constant input.
fn settled(mode: Mode, input: ReferenceInput) -> f64 {
    let muscle = paper_muscle();
    let inputs = vec![input; 8_001];
    let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs };
    let rows = engine::run(&muscle, mode, Arithmetic::Reference, &trace).expect("a run");
    rows.last().expect("rows").0.force
}

/// Force after ten minutes of a constant input, N.
fn after_ten_minutes<R: Recruitment<Fixed, 2>>(input: ReferenceInput) -> f64 {
    let muscle = Muscle::<Fixed, R, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let input = Input::<Fixed> {
        activation: Scalar::from_f64(input.activation),
        path_length: Fixed::path_length(input.path_length),
        stimulation_frequency: <Fixed as Scalar>::frequency(input.stimulation_frequency),
    };
    let mut state = muscle.rest(input.path_length).expect("a path in range");
    let mut force = 0;
    for _ in 0..600_000 {
        force = muscle.step(&mut state, input).force;
    }
    Fixed::newtons(force)
}

#[test]
fn ten_minutes_of_a_constant_input_end_at_the_references_steady_state() {
    let f0 = paper_muscle().f0();
    for activation in [0.05, 0.35, 0.8, 1.0] {
        let input = ReferenceInput { activation, path_length: 0.163, stimulation_frequency: 23.0 };
        for (mode, force) in [
            (Mode::Continuous, after_ten_minutes::<NaturalContinuous>(input)),
            (Mode::Fes, after_ten_minutes::<IntramuscularFes>(input)),
        ] {
            let error = 100.0 * (force - settled(mode, input)).abs() / f0;
            assert!(error <= 0.02, "{mode:?}, U {activation}: {error} % of F0");
        }
    }
}

/// Muscles of every published set, in a wide range of sizes, that fixed point takes.
fn muscles() -> impl Strategy<Value = MuscleParams<2>> {
    let sets = prop_oneof![
        Just((paper_table_1::ELEMENTS, [paper_table_1::SLOW, paper_table_1::FAST])),
        Just((human_vm4::ELEMENTS, [human_vm4::SUPER_SLOW, human_vm4::FAST])),
        Just((feline_vm4::ELEMENTS, [feline_vm4::SLOW, feline_vm4::FAST])),
    ];
    (sets, 1e-3..1.0_f64, 0.02..0.3_f64, 0.01..0.3_f64, 0.05..0.95_f64, 1.15..1.6)
        .prop_map(|((elements, types), mass, fascicle, tendon, fraction, longest)| {
            let mut params = MuscleParams {
                mass,
                fascicle_length: fascicle,
                tendon_length: tendon,
                max_path_length: fascicle + tendon,
                recruitment_saturation: 0.8,
                elements,
                fibers: [
                    FiberParams { fraction, fiber_type: types[0] },
                    FiberParams { fraction: 1.0 - fraction, fiber_type: types[1] },
                ],
            };
            params.max_path_length += (longest - params.maximum_fascicle_length()) * fascicle;
            params
        })
        .prop_filter("a valid muscle", |params| {
            ContinuousMuscle::<Fixed, 2>::build(params, TimeStep::MILLISECOND).is_ok()
        })
}

fn steps() -> impl Strategy<Value = TimeStep> {
    (1e-4..2e-3_f64).prop_map(|seconds| TimeStep::from_seconds(seconds).expect("in range"))
}

/// Anything that the bits of an input can be, and often what is inside the domain.
fn any_bits() -> impl Strategy<Value = (i32, i32, i32)> {
    let activation = prop_oneof![any::<i32>(), 0..=1_i32 << 24, Just(i32::MIN), Just(i32::MAX)];
    let path = prop_oneof![any::<i32>(), 0..300_000_000_i32, Just(i32::MIN), Just(i32::MAX)];
    let frequency = prop_oneof![any::<i32>(), 0..40_000_000_i32, Just(i32::MIN), Just(i32::MAX)];
    (activation, path, frequency)
}

fn takes_any_bits<R: Recruitment<Fixed, 2>>(
    params: &MuscleParams<2>,
    step: TimeStep,
    inputs: &[(i32, i32, i32)],
) {
    let muscle = Muscle::<Fixed, R, 2>::build(params, step).expect("a valid muscle");
    let mut state = muscle.rest(muscle.path_length_range().1).expect("a path in range");
    for &(activation, path, frequency) in inputs {
        let mut input = Input::<Fixed>::from_integers(0, 0, 0);
        input.activation = Fixed::from_bits(activation);
        input.path_length = Fixed::path_from_bits(path as u32);
        input.stimulation_frequency = fixed::types::I16F16::from_bits(frequency);
        for _ in 0..25 {
            let output = muscle.step(&mut state, input);
            assert!(output.force >= 0, "{output:?}");
            let saved: Vec<u32> = state.words().collect();
            assert_eq!(saved.len(), State::<Fixed, R, 2>::WORDS);
            let restored = muscle.restore(saved).expect("a state that a tick left");
            assert_eq!(restored, state);
        }
    }
}

/// Largest difference of the forces in `f32` and in fixed point, % of F0, on the same inputs.
fn difference<R: Recruitment<f32, 2>, Q: Recruitment<Fixed, 2>>(
    params: &MuscleParams<2>,
    segments: &[(u16, f64, u16)],
) -> f64 {
    let step = TimeStep::MILLISECOND;
    let float = Muscle::<f32, R, 2>::build(params, step).expect("a valid muscle");
    let fixed = Muscle::<Fixed, Q, 2>::build(params, step).expect("a valid muscle");
    let (shortest, longest) = params.path_domain();
    let mut path = shortest + 0.7 * (longest - shortest);
    let mut float_state = float.rest(path as f32).expect("a path in range");
    let mut fixed_state = fixed.rest(Fixed::path_length(path)).expect("a path in range");
    let mut largest = 0.0_f64;
    for &(per_mille, goal, tenths) in segments {
        // Towards a goal at which the tendon is taut, at up to 1 L_ce0/s and without a jerk.
        let goal = shortest + (0.6 + 0.4 * goal) * (longest - shortest);
        let start = path;
        for tick in 0..300 {
            let x = f64::from(tick) / 300.0;
            path = start + (goal - start) * x * x * x * (10.0 + x * (6.0 * x - 15.0));
            let fixed_input =
                Input::<Fixed>::from_integers(per_mille, (path * 1e6).round() as i32, tenths);
            let float_input = Input {
                activation: fixed_input.activation.to_num(),
                path_length: Fixed::path_metres(fixed_input.path_length) as f32,
                stimulation_frequency: fixed_input.stimulation_frequency.to_num(),
            };
            let expected = f64::from(float.step(&mut float_state, float_input).force);
            let found = Fixed::newtons(fixed.step(&mut fixed_state, fixed_input).force);
            largest = largest.max((found - expected).abs());
        }
    }
    100.0 * largest / params.max_isometric_force()
}

fn config(cases: u32) -> ProptestConfig {
    let default = ProptestConfig::default();
    let rng_seed = match default.rng_seed {
        RngSeed::Random => RngSeed::Fixed(0x0066_6978_6564),
        fixed => fixed,
    };
    ProptestConfig { cases, rng_seed, failure_persistence: None, ..default }
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn any_input_leaves_a_state_in_range_and_nothing_wraps_around(
        params in muscles(),
        step in steps(),
        inputs in prop::collection::vec(any_bits(), 1..20),
    ) {
        takes_any_bits::<NaturalContinuous>(&params, step, &inputs);
        takes_any_bits::<IntramuscularFes>(&params, step, &inputs);
    }

    #[test]
    fn it_is_the_same_muscle_as_in_f32(
        params in muscles(),
        // One thousandth is the threshold of the first type: on it, rounding decides.
        segments in prop::collection::vec((2..=1000_u16, 0.0..=1.0_f64, 0..800_u16), 2..6),
    ) {
        let natural = difference::<NaturalContinuous, NaturalContinuous>(&params, &segments);
        let fes = difference::<IntramuscularFes, IntramuscularFes>(&params, &segments);
        prop_assert!(natural <= 0.1 && fes <= 0.1, "natural {natural}, FES {fes} % of F0");
    }
}

#[test]
fn muscles_that_fixed_point_cannot_hold_are_refused_by_name() {
    let refused = |change: fn(&mut MuscleParams<2>)| {
        let mut params = MUSCLE;
        change(&mut params);
        ContinuousMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("f32 takes it");
        let error = FesMuscle::<Fixed, 2>::build(&params, TimeStep::MILLISECOND);
        error.expect_err("fixed point does not").to_string()
    };
    let message = refused(|p| p.fibers[0].fiber_type.half_force_frequency = 2.0);
    assert!(message.contains("half_force_frequency") && message.contains("250"), "{message}");
    let message = refused(|p| p.fibers[1].fiber_type.force_velocity.lengthening_velocity = 0.015);
    assert!(message.contains("lengthening_velocity"), "{message}");
}
