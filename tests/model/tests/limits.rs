//! Every value beyond its limit is refused by name, and every flag is raised by its cause.

use vm_nostd::{
    CompressionParams, ContinuousMuscle, DiscreteMuscle, FesMuscle, Fixed, Input, Limit,
    MotorUnits, MuscleParams, RestoreError, Scalar, Status, TimeStep, UnitSizes,
};
use vm_nostd_cores::MUSCLE;

type Params = MuscleParams<2>;

/// A field, its documented limits, and a setter. The limits are duplicated here on purpose, so that
/// no limit changes unnoticed.
type Row = (&'static str, f64, f64, fn(&mut Params, f64));

const OF_MUSCLE: &[Row] = &[
    ("mass", 1e-5, 30.0, |p, x| p.mass = x),
    ("fascicle_length", 5e-3, 1.0, |p, x| p.fascicle_length = x),
    ("tendon_length", 5e-4, 2.0, |p, x| p.tendon_length = x),
    ("recruitment_saturation", 0.01, 1.0, |p, x| p.recruitment_saturation = x),
    ("tendon.stiffness", 1.0, 200.0, |p, x| p.elements.tendon.stiffness = x),
    ("tendon.toe", 1e-3, 0.05, |p, x| p.elements.tendon.toe = x),
    ("tendon.slack_length", 0.5, 1.5, |p, x| p.elements.tendon.slack_length = x),
    ("parallel.stiffness", 1.0, 200.0, |p, x| p.elements.parallel.stiffness = x),
    ("parallel.toe", 0.01, 0.3, |p, x| p.elements.parallel.toe = x),
    ("parallel.slack_length", 0.8, 1.5, |p, x| p.elements.parallel.slack_length = x),
    ("parallel.viscosity", 1e-3, 1.0, |p, x| p.elements.parallel.viscosity = x),
    ("compression.strength", -1.0, 0.0, |p, x| p.elements.compression.strength = x),
    ("compression.steepness", -40.0, -1.0, |p, x| p.elements.compression.steepness = x),
    ("compression.onset_length", 0.4, 1.0, |p, x| p.elements.compression.onset_length = x),
    ("specific_tension", 1e4, 1e7, |p, x| p.elements.specific_tension = x),
    ("density", 500.0, 2000.0, |p, x| p.elements.density = x),
];

/// Fields of the second, fast type.
const OF_FIBER: &[Row] = &[
    ("fraction", 1e-3, 1.0, |p, x| p.fibers[1].fraction = x),
    ("half_force_frequency", 0.5, 200.0, |p, x| {
        p.fibers[1].fiber_type.half_force_frequency = x;
    }),
    ("minimum_frequency", 0.0, 5.0, |p, x| p.fibers[1].fiber_type.minimum_frequency = x),
    ("maximum_frequency", 0.5, 10.0, |p, x| p.fibers[1].fiber_type.maximum_frequency = x),
    ("force_length.width", 0.1, 10.0, |p, x| p.fibers[1].fiber_type.force_length.width = x),
    ("force_length.skewness", 0.1, 5.0, |p, x| {
        p.fibers[1].fiber_type.force_length.skewness = x;
    }),
    ("force_length.roundness", 1.0, 10.0, |p, x| {
        p.fibers[1].fiber_type.force_length.roundness = x;
    }),
    ("force_velocity.maximum_velocity", -100.0, -0.1, |p, x| {
        p.fibers[1].fiber_type.force_velocity.maximum_velocity = x;
    }),
    ("force_velocity.shortening", -100.0, 100.0, |p, x| {
        p.fibers[1].fiber_type.force_velocity.shortening[1] = x;
    }),
    ("force_velocity.lengthening", -100.0, 100.0, |p, x| {
        p.fibers[1].fiber_type.force_velocity.lengthening[2] = x;
    }),
    ("force_velocity.lengthening_velocity", 0.01, 10.0, |p, x| {
        p.fibers[1].fiber_type.force_velocity.lengthening_velocity = x;
    }),
    ("effective_length_time", 5e-5, 0.01, |p, x| p.fibers[1].fiber_type.effective_length_time = x),
    ("activation.scale", 0.05, 10.0, |p, x| p.fibers[1].fiber_type.activation.scale = x),
    ("activation.exponent", 0.5, 10.0, |p, x| p.fibers[1].fiber_type.activation.exponent = x),
    ("activation.length_dependence", 0.0, 20.0, |p, x| {
        p.fibers[1].fiber_type.activation.length_dependence = x;
    }),
    ("excitation.rise", 5e-3, 0.5, |p, x| p.fibers[1].fiber_type.excitation.rise = x),
    ("excitation.rise_per_frequency", 0.0, 0.5, |p, x| {
        p.fibers[1].fiber_type.excitation.rise_per_frequency = x;
    }),
    ("excitation.fall", 5e-3, 0.5, |p, x| p.fibers[1].fiber_type.excitation.fall = x),
    ("excitation.fall_per_activation", 0.0, 0.5, |p, x| {
        p.fibers[1].fiber_type.excitation.fall_per_activation = x;
    }),
    ("sag.resting_level", 0.01, 10.0, |p, x| {
        p.fibers[1].fiber_type.sag.as_mut().expect("a type that sags").resting_level = x;
    }),
    ("sag.firing_level", 0.01, 10.0, |p, x| {
        p.fibers[1].fiber_type.sag.as_mut().expect("a type that sags").firing_level = x;
    }),
    ("sag.time_constant", 0.01, 10.0, |p, x| {
        p.fibers[1].fiber_type.sag.as_mut().expect("a type that sags").time_constant = x;
    }),
];

/// Fields of the first, slow type.
const OF_SLOW: &[Row] = &[
    ("yielding.depth", 0.0, 0.95, |p, x| {
        p.fibers[0].fiber_type.yielding.as_mut().expect("a type that yields").depth = x;
    }),
    ("yielding.velocity", 0.01, 100.0, |p, x| {
        p.fibers[0].fiber_type.yielding.as_mut().expect("a type that yields").velocity = x;
    }),
    ("yielding.time_constant", 0.05, 10.0, |p, x| {
        p.fibers[0].fiber_type.yielding.as_mut().expect("a type that yields").time_constant = x;
    }),
];

#[test]
fn every_parameter_is_refused_just_beyond_its_limits() {
    assert_eq!(MUSCLE.validate(), Ok(()));
    let rows = [(OF_MUSCLE, None), (OF_FIBER, Some(1)), (OF_SLOW, Some(0))];
    for (rows, fiber) in rows {
        for &(field, least, most, set) in rows {
            let beyond = 1e-6 * (least.abs() + most.abs());
            for value in [least - beyond, most + beyond, f64::INFINITY, f64::NAN] {
                let mut params = MUSCLE;
                set(&mut params, value);
                let error = params.validate().expect_err(field);
                assert_eq!((error.field, error.fiber), (field, fiber), "{value}: {error}");
                assert!(error.value == value || value.is_nan(), "{error}");
                assert_eq!(error.limit, Limit::Within { least, most }, "{field}");
            }
        }
    }
}

#[test]
fn inconsistent_parameters_are_refused() {
    let refused = |change: fn(&mut Params)| {
        let mut params = MUSCLE;
        change(&mut params);
        let error = params.validate().expect_err("a muscle that cannot be");
        (error.field, error.fiber)
    };
    assert_eq!(refused(|p| p.fibers[0].fraction = 0.6001), ("fraction", None));
    assert_eq!(refused(|p| p.fibers[1].fiber_type.rank = 1), ("rank", Some(1)));
    assert_eq!(refused(|p| p.fibers[0].fiber_type.rank = 0), ("rank", Some(0)));
    assert_eq!(refused(|p| p.max_path_length = 0.1), ("max_path_length", None));
    // F_pe2 at 0.5 L_ce0 would be -5e8 F0.
    const STRONGEST: CompressionParams =
        CompressionParams { strength: -1.0, steepness: -40.0, onset_length: 1.0 };
    assert_eq!(
        refused(|p| p.elements.compression = STRONGEST),
        ("compression.strength: force at the shortest length, F0", None)
    );
    assert_eq!(refused(|p| p.max_path_length = 0.25), ("max_path_length", None));
    assert_eq!(refused(|p| p.max_path_length = -1.0), ("max_path_length", None));
    let none = MuscleParams::<0> {
        mass: MUSCLE.mass,
        fascicle_length: MUSCLE.fascicle_length,
        tendon_length: MUSCLE.tendon_length,
        max_path_length: MUSCLE.max_path_length,
        recruitment_saturation: MUSCLE.recruitment_saturation,
        class: MUSCLE.class,
        elements: MUSCLE.elements,
        fibers: [],
    };
    assert_eq!(none.validate().expect_err("no type").limit, Limit::AtLeastOneType);
    for seconds in [0.99e-4, 2.01e-3, f64::NAN] {
        assert_eq!(TimeStep::from_seconds(seconds).expect_err("a step").field, "time_step");
    }
}

#[test]
fn a_threshold_at_full_activation_keeps_the_state_finite() {
    let mut params = MUSCLE;
    params.recruitment_saturation = 1.0;
    params.fibers[0].fraction = 0.999;
    params.fibers[1].fraction = 0.001;
    let muscle = ContinuousMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("valid");
    let mut state = muscle.rest(0.16).expect("in range");
    let input = Input { activation: 1.0, path_length: 0.16, stimulation_frequency: 0.0 };
    for _ in 0..1000 {
        assert!(muscle.step(&mut state, input).force.is_finite());
    }
    assert!(muscle.restore(muscle.save(&state)).is_ok());
}

#[test]
fn the_steepest_activation_does_not_overflow() {
    // Af is nearly a step in frequency here: its power overflows f32 unless limited.
    let mut params = MUSCLE;
    for fiber in &mut params.fibers {
        fiber.fiber_type.half_force_frequency = 0.5;
        fiber.fiber_type.activation.scale = 0.05;
        fiber.fiber_type.activation.exponent = 10.0;
        fiber.fiber_type.excitation.rise_per_frequency = 0.0;
    }
    let steady = |force_of: &dyn Fn(f64) -> f64| force_of(0.16);
    let f32 = steady(&|path| {
        let muscle = FesMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("valid");
        let mut state = muscle.rest(path as f32).expect("in range");
        let input =
            Input { activation: 0.8, path_length: path as f32, stimulation_frequency: 500.0 };
        (0..600).fold(0.0, |_, _| f64::from(muscle.step(&mut state, input).force))
    });
    let f64 = steady(&|path| {
        let muscle = FesMuscle::<f64, 2>::build(&params, TimeStep::MILLISECOND).expect("valid");
        let mut state = muscle.rest(path).expect("in range");
        let input = Input { activation: 0.8, path_length: path, stimulation_frequency: 500.0 };
        (0..600).fold(0.0, |_, _| muscle.step(&mut state, input).force)
    });
    assert!(f64 > 100.0 && (f32 - f64).abs() < 0.05, "{f32} {f64}");
}

fn muscle() -> ContinuousMuscle<f32, 2> {
    ContinuousMuscle::build(&MUSCLE, TimeStep::MILLISECOND).expect("the paper's muscle")
}

#[test]
fn a_state_out_of_range_is_not_restored() {
    let muscle = muscle();
    let words: Vec<u32> = muscle.save(&muscle.rest(0.16).expect("in range")).collect();
    let expected = words.len();
    let refused = |words: Vec<u32>| muscle.restore(words).expect_err("a state to refuse");
    assert_eq!(refused(words[..expected - 1].to_vec()), RestoreError::Length { expected });
    assert_eq!(refused([words.as_slice(), &[0]].concat()), RestoreError::Length { expected });
    // The first word is the fingerprint.
    for word in 1..expected {
        // Mean and variance of speed may be any finite number from 0 on.
        let values = [f32::NAN, f32::INFINITY, -2000.0, 2000.0];
        for &value in if (5..7).contains(&word) { &values[..3] } else { &values[..] } {
            let mut wrong = words.clone();
            wrong[word] = value.to_bits();
            assert_eq!(refused(wrong), RestoreError::Value { word }, "{value}");
        }
    }
    assert!(muscle.restore(words).is_ok());
}

#[test]
fn nan_inputs_count_as_no_activation_and_no_motion() {
    let muscle = muscle();
    let mut state = muscle.rest(0.16).expect("in range");
    let before = muscle.observe(&state).force;
    let nothing =
        Input { activation: f32::NAN, path_length: f32::NAN, stimulation_frequency: f32::NAN };
    for _ in 0..300 {
        let output = muscle.step(&mut state, nothing);
        assert!((output.force - before).abs() < 1e-3, "{} N", output.force);
        assert_eq!(
            output.status,
            Status::ACTIVATION_NOT_FINITE
                | Status::FREQUENCY_NOT_FINITE
                | Status::PATH_LENGTH_NOT_FINITE
        );
    }
}

#[test]
fn flags_of_the_state_are_raised_by_their_causes() {
    let muscle = muscle();
    let (shortest, longest) = muscle.path_length_range();
    let step = |state: &mut _, activation: f32, path_length: f32| {
        muscle.step(state, Input { activation, path_length, stimulation_frequency: 0.0 })
    };

    // A path that jumps by its whole range stretches the fascicles at the velocity limit.
    let mut state = muscle.rest(shortest).expect("in range");
    let jumped = step(&mut state, 0.0, longest);
    assert!(jumped.status.contains(Status::FASCICLE_VELOCITY_LIMITED), "{jumped:?}");
    assert!(jumped.status.contains(Status::MECHANICS_UNSETTLED), "{jumped:?}");

    // A fully active muscle whose path jumps to its shortest: the tendon is slack, and the
    // fascicles shorten at full speed to the end of the state range.
    let mut state = muscle.rest(0.17).expect("in range");
    for _ in 0..300 {
        assert_eq!(step(&mut state, 1.0, 0.17).status, Status::empty());
    }
    let mut flags = Status::empty();
    for _ in 0..300 {
        let output = step(&mut state, 1.0, shortest);
        flags |= output.status;
        if output.status.contains(Status::FASCICLE_LENGTH_LIMITED) {
            assert_eq!(output.fascicle_velocity, 0.0);
        }
        // Past V_max of the slow type, -7.88 L_ce0/s.
        if output.fascicle_velocity < -7.88 {
            assert!(output.status.contains(Status::FASCICLE_OUTSIDE_DOMAIN), "{output:?}");
        }
        assert!((0.51..1.7).contains(&output.fascicle_length), "{output:?}");
    }
    assert!(flags.contains(Status::FASCICLE_LENGTH_LIMITED), "{flags:?}");
}

#[test]
fn fascicle_velocity_is_limited_to_the_state_range() {
    let mut params = MUSCLE;
    for fiber in &mut params.fibers {
        fiber.fiber_type.force_velocity.maximum_velocity = -100.0;
        fiber.fiber_type.force_velocity.shortening = [0.0, 0.0];
    }
    params.elements.parallel.viscosity = 1e-3;
    let muscle = ContinuousMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("valid");
    let (shortest, longest) = muscle.path_length_range();
    let mut held = 0;
    for stretched in 0..60 {
        // Fully active; the path jumps to its longest for some ticks, then to its shortest.
        let mut state = muscle.rest(0.17).expect("in range");
        for tick in 0..400 {
            let end = 300 + stretched;
            let path_length =
                [0.17, longest, shortest][usize::from(tick >= 300) + usize::from(tick >= end)];
            let output = muscle.step(
                &mut state,
                Input { activation: 1.0, path_length, stimulation_frequency: 0.0 },
            );
            let velocity = output.fascicle_velocity;
            assert!(velocity.abs() <= 60.0, "tick {tick}: {output:?}");
            held += u32::from(velocity == -60.0);
            assert!(
                velocity.abs() < 60.0 || output.status.contains(Status::FASCICLE_VELOCITY_LIMITED)
            );
            assert_eq!(muscle.restore(muscle.save(&state)), Ok(state), "tick {tick}");
        }
    }
    assert!(held > 0, "the limit was never reached");
}

#[test]
fn fascicles_beyond_the_validity_range_are_flagged_and_passive_force_is_valid() {
    // The longest path stretches the fascicles until n_f of the slow type is below 0.2.
    let params = Params { max_path_length: 0.218, ..MUSCLE };
    let muscle =
        ContinuousMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND).expect("a valid muscle");
    let (_, longest_fascicle) = params.fascicle_domain();
    let mut state = muscle.rest(0.217).expect("in range");
    let at_rest = muscle.observe(&state);
    assert!(f64::from(at_rest.fascicle_length) > longest_fascicle);
    let input = Input { activation: 0.0, path_length: 0.217, stimulation_frequency: 0.0 };
    for _ in 0..100 {
        let output = muscle.step(&mut state, input);
        assert_eq!(output.status, Status::FASCICLE_OUTSIDE_DOMAIN);
        assert!((output.force - at_rest.force).abs() < 1e-3, "{output:?} {at_rest:?}");
    }
}

#[test]
fn invalid_motor_units_are_refused_with_field_value_and_limit() {
    let refused = |sizes| MotorUnits::<8>::new(&MUSCLE, sizes).expect_err("units to refuse");
    let three = UnitSizes::Default(3);
    for (sizes, field, fiber, value) in [
        (UnitSizes::Equal(0), "units: count", Some(1), 0.0),
        (UnitSizes::Listed(&[]), "units: count", Some(1), 0.0),
        (UnitSizes::Default(9), "units: count", Some(1), 9.0),
        (UnitSizes::Default(6), "units: total count", None, 9.0),
        (UnitSizes::Geometric(2, 1.5), "units: geometric growth", Some(1), 1.5),
        (UnitSizes::Geometric(2, -0.6), "units: geometric growth", Some(1), -0.6),
        (UnitSizes::Listed(&[1.0, 0.0]), "units: listed size", Some(1), 0.0),
        (UnitSizes::Listed(&[1e12, 1e-12]), SMALLEST, Some(1), 1e-24),
        (UnitSizes::Listed(&[1.0, -1.0]), "units: listed size", Some(1), -1.0),
    ] {
        let error = refused([three, sizes]);
        assert_eq!((error.field, error.fiber, error.value), (field, fiber, value), "{sizes:?}");
        assert!(matches!(error.limit, Limit::Within { .. }));
    }
    let error = refused([three, UnitSizes::Listed(&[f64::NAN])]);
    assert!(error.value.is_nan() && error.field == "units: listed size");
    let units = MotorUnits::<8>::new(&MUSCLE, [three, UnitSizes::Listed(&[1.0, 2.0])]);
    let units = units.expect("five units");
    assert_eq!(units.count(), 5);

    // Units of another muscle are refused.
    let mut other = MUSCLE;
    (other.fibers[0].fraction, other.fibers[1].fraction) = (0.5, 0.5);
    let built =
        DiscreteMuscle::<f32, 2, 8>::build_with_units(&other, &units, TimeStep::MILLISECOND);
    let error = built.expect_err("another muscle");
    assert_eq!((error.field, error.fiber), (SHARE, Some(0)));
    assert!((error.value - 0.6).abs() < 1e-9, "{error}");
}

const SMALLEST: &str = "units: smallest share of a type";
const SHARE: &str = "units: fraction of the type";

#[test]
fn rules_for_unit_sizes_equal_the_listed_sizes() {
    // Equal forces imply equal thresholds and shares.
    let steady = |sizes| {
        let units = MotorUnits::<6>::new(&MUSCLE, [sizes; 2]).expect("valid units");
        let muscle =
            DiscreteMuscle::<f64, 2, 6>::build_with_units(&MUSCLE, &units, TimeStep::MILLISECOND)
                .expect("a valid muscle");
        [0.1, 0.3, 0.5, 0.7].map(|activation| {
            let mut state = muscle.rest(0.16).expect("in range");
            let input = Input { activation, path_length: 0.16, stimulation_frequency: 0.0 };
            (0..1000).fold(0.0, |_, _| muscle.step(&mut state, input).force)
        })
    };
    let close = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(close(steady(UnitSizes::Equal(3)), steady(UnitSizes::Listed(&[5.0, 5.0, 5.0]))));
    let geometric = steady(UnitSizes::Geometric(3, 0.5));
    assert!(close(geometric, steady(UnitSizes::Listed(&[4.0, 6.0, 9.0]))));
    assert!(!close(geometric, steady(UnitSizes::Equal(3))));
    // Default sizes: 3 : 4 : 5 for a slow type (rank 2), 4 : 5 : 6 for a fast one (rank 3).
    let listed = [UnitSizes::Listed(&[3.0, 4.0, 5.0]), UnitSizes::Listed(&[4.0, 5.0, 6.0])];
    let by_default = MotorUnits::<6>::new(&MUSCLE, [UnitSizes::Default(3); 2]).expect("valid");
    assert_eq!(by_default, MotorUnits::new(&MUSCLE, listed).expect("valid"));
}

#[test]
fn all_units_fire_at_fmax_at_full_activation_despite_rounded_thresholds() {
    const UNITS: usize = 32;
    fn force<S: Scalar>(params: &Params, counts: [usize; 2]) -> f64 {
        let sizes = counts.map(UnitSizes::Default);
        let units = MotorUnits::<UNITS>::new(params, sizes).expect("valid units");
        let step = TimeStep::MILLISECOND;
        let muscle = DiscreteMuscle::<S, 2, UNITS>::build_with_units(params, &units, step);
        let muscle = muscle.expect("a valid muscle");
        let path_length = S::path_length(0.16);
        let stimulation_frequency = S::quantity(0.0);
        let input = Input { activation: S::ONE, path_length, stimulation_frequency };
        let mut state = muscle.rest(path_length).expect("in range");
        let force = (0..1000).map(|_| muscle.step(&mut state, input).force).last();
        S::newtons(force.expect("ticks"))
    }
    let mut params = MUSCLE;
    params.recruitment_saturation = 1.0;
    for (slow, fast) in [(0.6, 0.4), (0.5, 0.5), (0.3, 0.7), (0.6, 0.399_999_5)] {
        (params.fibers[0].fraction, params.fibers[1].fraction) = (slow, fast);
        // With all units recruited the force hardly depends on their number and sizes.
        let one = force::<f64>(&params, [1, 1]);
        for counts in [[7, 1], [1, 14], [3, 3], [11, 7], [16, 16]] {
            let found = [
                force::<f64>(&params, counts),
                force::<f32>(&params, counts),
                force::<Fixed>(&params, counts),
            ];
            for force in found {
                assert!(
                    (force - one).abs() < 0.007,
                    "{slow} {fast} {counts:?}: {found:?}, not {one}"
                );
            }
        }
    }
}
