//! Fixed point: no drift, no wrap-around, and agreement with `f32`.
//!
//! CI runs these tests again in a profile with overflow checks.

use model_tests::muscles::{Discrete, Mode as AnyMode, built, config, muscles, steps};
use proptest::prelude::*;
use vm_nostd::{
    ActivationParams, Class, CompressionParams, ContinuousMuscle, EffectiveLength, ElementParams,
    ExcitationParams, FascicleLength, FesMuscle, FiberParams, FiberType, Fixed, ForceLengthParams,
    ForceVelocityParams, Input, IntramuscularFes, MuscleParams, NaturalContinuous, ParallelParams,
    RestoreError, SagParams, Scalar, State, TendonParams, TimeStep, YieldParams, human_vm4,
    paper_table_1,
};
use vm_nostd_cores::MUSCLE;

/// Muscles that fixed point accepts.
fn fixed_muscles() -> impl Strategy<Value = MuscleParams<2>> {
    muscles().prop_filter("a valid muscle", |params| {
        ContinuousMuscle::<Fixed, 2>::build(params, TimeStep::MILLISECOND).is_ok()
    })
}

/// A log-uniform number from `least` to `most`.
fn magnitude(least: f64, most: f64) -> impl Strategy<Value = f64> {
    (least.ln()..most.ln()).prop_map(f64::exp)
}

/// A fibre type with any coefficients within the documented limits.
fn any_type() -> impl Strategy<Value = FiberType> {
    let frequencies = (magnitude(0.5, 200.0), 0.0..5.0_f64, 0.0..5.0_f64);
    let length = (magnitude(0.1, 10.0), magnitude(0.1, 5.0), 1.0..10.0_f64);
    let velocity = (
        magnitude(0.1, 100.0),
        -10.0..10.0_f64,
        -10.0..10.0_f64,
        -10.0..0.0_f64,
        -5.0..10.0_f64,
        -10.0..5.0_f64,
        magnitude(0.01, 10.0),
    );
    let activation = (magnitude(0.05, 10.0), magnitude(0.5, 10.0), 0.0..20.0_f64);
    let times =
        [magnitude(5e-3, 0.5), magnitude(1e-4, 0.5), magnitude(5e-3, 0.5), magnitude(1e-4, 0.5)];
    let sag = (magnitude(0.01, 10.0), magnitude(0.01, 10.0), magnitude(0.01, 10.0));
    let yielding = (0.0..0.95_f64, magnitude(0.01, 100.0), magnitude(0.05, 10.0));
    (frequencies, length, velocity, activation, times, sag, yielding).prop_map(
        |(f, l, v, a, t, s, y)| FiberType {
            rank: 1,
            half_force_frequency: f.0,
            minimum_frequency: f.1,
            maximum_frequency: f.1 + f.2,
            force_length: ForceLengthParams { width: l.0, skewness: l.1, roundness: l.2 },
            force_velocity: ForceVelocityParams {
                maximum_velocity: -v.0,
                shortening: [v.1, v.2],
                lengthening: [v.3, v.4, v.5],
                lengthening_velocity: v.6,
            },
            activation: ActivationParams { scale: a.0, exponent: a.1, length_dependence: a.2 },
            excitation: ExcitationParams {
                rise: t[0],
                rise_per_frequency: t[1],
                fall: t[2],
                fall_per_activation: t[3],
            },
            effective_length_time: 8.8e-5,
            sag: Some(SagParams { resting_level: s.0, firing_level: s.1, time_constant: s.2 }),
            yielding: Some(YieldParams { depth: y.0, velocity: y.1, time_constant: y.2 }),
        },
    )
}

/// A muscle with any parameters within the documented limits that fixed point accepts.
fn any_muscle() -> impl Strategy<Value = MuscleParams<2>> {
    let types = prop_oneof![
        (any_type(), any_type()).prop_map(|(a, b)| [a, b]),
        any_type().prop_map(|a| [a, FiberType { rank: 2, ..human_vm4::FAST }]),
        Just([paper_table_1::SLOW, paper_table_1::FAST]),
    ];
    let size = (magnitude(1e-5, 20.0), magnitude(5e-3, 1.0), magnitude(1e-3, 2.0), 0.8..2.0_f64);
    let tendon = (magnitude(1.0, 200.0), magnitude(1e-3, 0.05), 0.5..1.5_f64);
    let parallel = (magnitude(1.0, 200.0), magnitude(0.01, 0.3), 0.8..1.5_f64, 0.001..1.0_f64);
    let compression = (-1.0..0.0_f64, -40.0..-1.0_f64, 0.4..1.0_f64);
    let other = (magnitude(1e4, 1e7), 0.001..0.999_f64, 0.01..1.0_f64);
    (types, size, tendon, parallel, compression, other)
        .prop_map(|(types, size, t, p, c, (specific_tension, fraction, saturation))| {
            let (mass, fascicle_length, tendon_length, longest) = size;
            let mut params = MuscleParams {
                mass,
                fascicle_length,
                tendon_length,
                max_path_length: fascicle_length + tendon_length,
                recruitment_saturation: saturation,
                class: Class::Standard,
                elements: ElementParams {
                    tendon: TendonParams { stiffness: t.0, toe: t.1, slack_length: t.2 },
                    parallel: ParallelParams {
                        stiffness: p.0,
                        toe: p.1,
                        slack_length: p.2,
                        viscosity: p.3,
                    },
                    compression: CompressionParams {
                        strength: c.0,
                        steepness: c.1,
                        onset_length: c.2,
                    },
                    specific_tension,
                    density: 1060.0,
                },
                fibers: [
                    FiberParams { fraction, fiber_type: types[0] },
                    FiberParams { fraction: 1.0 - fraction, fiber_type: types[1] },
                ],
            };
            let missing = longest - params.maximum_fascicle_length();
            params.max_path_length += missing * fascicle_length;
            params
        })
        .prop_filter("a valid muscle", |params| {
            ContinuousMuscle::<Fixed, 2>::build(params, TimeStep::MILLISECOND).is_ok()
        })
}

/// Inputs of arbitrary bits, biased towards valid values.
fn any_bits() -> impl Strategy<Value = (i32, i32, i32)> {
    let activation = prop_oneof![any::<i32>(), 0..=1_i32 << 24, Just(i32::MIN), Just(i32::MAX)];
    let path = prop_oneof![any::<i32>(), 0..300_000_000_i32, Just(i32::MIN), Just(i32::MAX)];
    let frequency = prop_oneof![any::<i32>(), 0..40_000_000_i32, Just(i32::MIN), Just(i32::MAX)];
    (activation, path, frequency)
}

fn takes_any_bits<R: AnyMode<Fixed>>(
    params: &MuscleParams<2>,
    step: TimeStep,
    inputs: &[(i32, i32, i32)],
) {
    let muscle = built::<Fixed, R>(params, step);
    let mut state = muscle.rest(muscle.path_length_range().1).expect("a path in range");
    for &(activation, path, frequency) in inputs {
        let mut input = Input::<Fixed>::from_integers(0, 0, 0);
        input.activation = Fixed::from_bits(activation);
        input.path_length = Fixed::path_from_bits(path as u32);
        input.stimulation_frequency = fixed::types::I16F16::from_bits(frequency);
        for _ in 0..25 {
            let output = muscle.step(&mut state, input);
            assert!(output.force >= 0, "{output:?}");
            let saved: Vec<u32> = muscle.save(&state).collect();
            assert_eq!(saved.len(), State::<Fixed, R, 2>::SAVED_WORDS);
            let restored = muscle.restore(saved).expect("a saved state");
            assert_eq!(restored, state);
        }
    }
}

/// Largest difference of force between `f32` and fixed point on the same inputs, % of F0.
fn difference<R: AnyMode<f32>, Q: AnyMode<Fixed>>(
    params: &MuscleParams<2>,
    segments: &[(u16, f64, u16)],
) -> f64 {
    let step = TimeStep::MILLISECOND;
    let float = built::<f32, R>(params, step);
    let fixed = built::<Fixed, Q>(params, step);
    let (shortest, longest) = params.path_domain();
    let mut path = shortest + 0.7 * (longest - shortest);
    let mut float_state = float.rest(path as f32).expect("a path in range");
    let mut fixed_state = fixed.rest(Fixed::path_length(path)).expect("a path in range");
    let mut largest = 0.0_f64;
    for &(per_mille, goal, tenths) in segments {
        // The path moves smoothly, at up to 1 L_ce0/s, to a goal at which the tendon is taut.
        let goal = shortest + (0.6 + 0.4 * goal) * (longest - shortest);
        let start = path;
        for tick in 0..300 {
            let x = f64::from(tick) / 300.0;
            path = start + (goal - start) * x * x * x * (10.0 + x * (6.0 * x - 15.0));
            let fixed_input =
                Input::<Fixed>::from_integers(per_mille, (path * 1e6).round() as i32, tenths);
            let float_input = Input {
                activation: fixed::types::I8F24::from(fixed_input.activation).to_num(),
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

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn any_input_keeps_the_state_in_range_without_wrap_around(
        params in fixed_muscles(),
        step in steps(),
        inputs in prop::collection::vec(any_bits(), 1..20),
    ) {
        takes_any_bits::<NaturalContinuous>(&params, step, &inputs);
        takes_any_bits::<IntramuscularFes>(&params, step, &inputs);
        takes_any_bits::<Discrete<FascicleLength>>(&params, step, &inputs);
        takes_any_bits::<Discrete<EffectiveLength>>(&params, step, &inputs);
    }

    #[test]
    fn no_accepted_muscle_wraps_around(
        params in any_muscle(),
        step in steps(),
        inputs in prop::collection::vec(any_bits(), 1..20),
    ) {
        // The number of substeps depends on the time step, so a muscle may be refused at this one.
        if ContinuousMuscle::<Fixed, 2>::build(&params, step).is_ok() {
            takes_any_bits::<NaturalContinuous>(&params, step, &inputs);
            takes_any_bits::<IntramuscularFes>(&params, step, &inputs);
            takes_any_bits::<Discrete<FascicleLength>>(&params, step, &inputs);
            takes_any_bits::<Discrete<EffectiveLength>>(&params, step, &inputs);
        }
    }

    #[test]
    fn force_agrees_with_f32(
        params in fixed_muscles(),
        // 0.001 is the threshold of the first type, where rounding decides on recruitment.
        segments in prop::collection::vec((2..=1000_u16, 0.0..=1.0_f64, 0..800_u16), 2..6),
    ) {
        let natural = difference::<NaturalContinuous, NaturalContinuous>(&params, &segments);
        let fes = difference::<IntramuscularFes, IntramuscularFes>(&params, &segments);
        prop_assert!(natural <= 0.1 && fes <= 0.1, "natural {natural}, FES {fes} % of F0");
    }
}

/// Compares resting on a path in metres with resting on a path in the arithmetic's own type.
fn rests_on_metres<S: Scalar>() {
    let muscle = FesMuscle::<S, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    assert_eq!(muscle.rest_at_metres(0.16), muscle.rest(S::path_length(0.16)));
    for path in [-1.0, 0.0, 0.05, 9.0, f64::INFINITY, f64::NAN] {
        let refusal = muscle.rest_at_metres(path).expect_err("out of range");
        assert_eq!((refusal.field, refusal.value.to_bits()), ("path_length", path.to_bits()));
    }
}

#[test]
fn rest_at_metres_agrees_with_rest_in_every_arithmetic() {
    rests_on_metres::<f32>();
    rests_on_metres::<Fixed>();
    rests_on_metres::<f64>();
}

#[test]
fn states_out_of_range_are_refused() {
    let muscle = FesMuscle::<Fixed, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let state = muscle.rest_at_metres(0.16).expect("a path in range");
    let saved: Vec<u32> = muscle.save(&state).collect();
    let whole = |value: u32| value << 24;
    // Word 0 is the fingerprint, 1 and 2 the extension, 5 the weight of F_pe2, 6 and 7 the speed, 8
    // and 9 the gains, 10 and 11 Y of the slow type, which yields and does not sag, 14 and 15 f_env
    // of the first type, 16 to 23 the rest of that type. States that add up small changes have two
    // words, the higher one second.
    for (word, value) in [
        (2, 0x8000_0000), // extension -128
        (2, whole(129)),  // extension -127
        (3, whole(61)),   // velocity
        (4, 0x7FFF_FFFF), // path of 4.19 m
        (5, whole(2)),    // share for the compression
        (6, whole(255)),  // mean speed -1
        (7, whole(255)),  // its variance
        (9, whole(2)),    // gain
        (11, 0),          // Y below 1 - c_Y
        (15, whole(60)),  // f_env of more than 500 pps
        (17, whole(2)),   // f_int above 1 under FES
        (19, whole(100)), // f_eff
        (21, whole(100)), // S of a type without sag
        (22, whole(2)),   // Af
        (23, whole(2)),   // Af predicted
    ] {
        let mut words = saved.clone();
        words[word] = value;
        let refused = muscle.restore(words).expect_err("out of range");
        assert!(matches!(refused, RestoreError::Value { word: w } if w <= word), "word {word}");
    }
    assert_eq!(muscle.restore(saved), Ok(state));
}

#[test]
fn muscles_that_fixed_point_cannot_represent_are_refused_by_name() {
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
    let message = refused(|p| (p.elements.tendon.stiffness, p.elements.tendon.toe) = (5.0, 0.001));
    assert!(message.contains("tendon.toe"), "{message}");
    let message = refused(|p| {
        p.elements.tendon.stiffness = 200.0;
        (p.tendon_length, p.max_path_length) = (0.003, 0.167);
    });
    assert!(message.contains("tendon.stiffness"), "{message}");
    let message = refused(|p| p.mass = 1e-4);
    assert!(message.contains("mass: F0") && message.contains('1'), "{message}");
    let message = refused(|p| {
        (p.elements.compression.strength, p.elements.compression.steepness) = (-1.0, -30.0);
    });
    assert!(message.contains("compression.strength"), "{message}");
    let message = refused(|p| {
        p.elements.parallel.stiffness = 200.0;
        p.max_path_length = 0.11;
    });
    assert!(message.contains("parallel.stiffness: force of the longest"), "{message}");
    let message = refused(|p| {
        (p.elements.parallel.stiffness, p.elements.parallel.toe) = (1.0, 0.01);
        (p.elements.parallel.slack_length, p.max_path_length) = (0.8, 0.11);
    });
    assert!(message.contains("parallel.toe: longest fascicles"), "{message}");
}

/// On a slack tendon two forces of some increments balance: the length is as exact as any.
#[test]
fn a_slack_muscle_rests_where_it_does_in_f64() {
    for ratio in [0.1, 0.5, 2.0] {
        let params = MuscleParams {
            fascicle_length: 0.28,
            tendon_length: 0.28 * ratio,
            max_path_length: 0.28 * (1.45 + 1.03 * ratio),
            mass: 0.9,
            ..MUSCLE
        };
        let fixed = built::<Fixed, IntramuscularFes>(&params, TimeStep::MILLISECOND);
        let exact = built::<f64, IntramuscularFes>(&params, TimeStep::MILLISECOND);
        let (shortest, longest) = params.path_domain();
        for share in [0.05, 0.2, 0.3, 0.4, 0.5] {
            let path = shortest + share * (longest - shortest);
            let found = fixed.observe(&fixed.rest_at_metres(path).expect("in range"));
            let expected = exact.observe(&exact.rest_at_metres(path).expect("in range"));
            let error = (found.fascicle_length.to_f64() - expected.fascicle_length).abs();
            assert!(
                error < 2e-6,
                "{ratio} {share}: {error:e} L_ce0, {} F0",
                expected.relative_force
            );
        }
    }
}

/// Relative forces of a held input at ticks of 0.1 ms, from rest at mid-range.
fn held<S: Scalar, R: AnyMode<S>>(
    params: &MuscleParams<2>,
    activation: f64,
    frequency: f64,
    ticks: usize,
) -> Vec<f64> {
    let muscle = built::<S, R>(params, TimeStep::from_seconds(1e-4).expect("a tick"));
    let (shortest, longest) = params.path_domain();
    let path = 0.4 * shortest + 0.6 * longest;
    let mut state = muscle.rest_at_metres(path).expect("in range");
    let input = Input {
        activation: S::from_f64(activation),
        path_length: S::path_length(path),
        stimulation_frequency: S::quantity(frequency),
    };
    (0..ticks).map(|_| muscle.step(&mut state, input).relative_force.to_f64()).collect()
}

/// Half an increment of length, 2^-25 L_ce0, in a tick of 0.1 ms is 3e-4 L_ce0/s, at which FV
/// differs from 1 by some 3e-4. Fascicles that stood still below it would carry as much too little
/// or too much.
#[test]
fn fascicles_that_creep_by_less_than_an_increment_a_tick_move() {
    for activation in [0.2, 0.5, 1.0] {
        let [found, expected] = [
            held::<Fixed, NaturalContinuous>(&MUSCLE, activation, 0.0, 5000)[4999],
            held::<f64, NaturalContinuous>(&MUSCLE, activation, 0.0, 5000)[4999],
        ];
        let error = (found - expected).abs();
        assert!(error < 3e-6, "{activation}: {found} F0 for {expected}");
    }
}

/// At 500 pps f_int rises in a second: in a tick of 0.1 ms by a ten-thousandth of its distance,
/// which has some thousand increments.
#[test]
fn excitation_that_rises_in_seconds_rises_as_fast_as_in_f64() {
    let mut params = MUSCLE;
    for fiber in &mut params.fibers {
        fiber.fiber_type.half_force_frequency = 8.0;
    }
    let found = held::<Fixed, IntramuscularFes>(&params, 1.0, 500.0, 40_000);
    let expected = held::<f64, IntramuscularFes>(&params, 1.0, 500.0, 40_000);
    let errors = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs());
    let largest = errors.fold(0.0, f64::max);
    assert!(largest < 5e-5, "{largest:e} F0");
}
