//! Properties of every valid muscle with any inputs.

use model_tests::muscles::{Discrete, Mode, TYPES, built, config, muscles, steps};
use proptest::prelude::*;
use vm_nostd::{
    ContinuousMuscle, EffectiveLength, FascicleLength, FesMuscle, Input, IntramuscularFes, Muscle,
    MuscleParams, NaturalContinuous, Output, State, Status, TimeStep,
};

type Params = MuscleParams<TYPES>;

/// Peak force (F0) when a slack tendon snaps taut: the relative velocity of a path that lengthens
/// at 5 L_ce0/s and fascicles that shorten at V_max, times √(stiffness × mass).
///
/// For a very long muscle with a very short tendon this can exceed 3 F0, in the reference as well;
/// such muscles are excluded from the check of that bound.
fn snap(params: &Params) -> f64 {
    let fastest = params
        .fibers
        .iter()
        .map(|fiber| -fiber.fiber_type.force_velocity.maximum_velocity)
        .fold(0.0, f64::max);
    let stiffness =
        params.elements.tendon.stiffness * params.fascicle_length / params.tendon_length;
    let mass = 0.5 * params.mass * params.fascicle_length / params.max_isometric_force();
    (5.0 + fastest) * (stiffness * mass).sqrt()
}

/// A segment of constant inputs: activation, goal of the path (share of its range), its speed
/// (share of the limit), stimulation frequency.
type Segment = (f32, f32, f32, f32);

fn segments() -> impl Strategy<Value = Vec<Segment>> {
    let activation = prop_oneof![3 => 0.0..=1.0_f32, 1 => Just(0.0), 1 => Just(1.0)];
    prop::collection::vec((activation, 0.0..=1.0_f32, 0.0..=1.0_f32, 0.0..80.0_f32), 4..12)
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<f32>(),
        -2.0..2.0_f32,
        Just(f32::NAN),
        Just(f32::INFINITY),
        Just(f32::NEG_INFINITY),
        Just(f32::MIN_POSITIVE / 2.0),
        Just(-0.0),
    ]
}

fn all_finite<R: Mode<f32>>(output: &Output<f32>, state: &State<f32, R, TYPES>) -> bool {
    let numbers = [output.force, output.fascicle_length, output.fascicle_velocity];
    numbers.into_iter().all(f32::is_finite)
        && state.words().all(|word| f32::from_bits(word).is_finite())
}

/// The range in which paths are not clipped, in the muscle's arithmetic.
fn path_range(params: &Params) -> (f32, f32) {
    let (shortest, longest) = params.path_domain();
    (shortest as f32, longest as f32)
}

/// Steps through segments; the path is slower than 5 L_ce0/s and stays in range.
fn drive<R: Mode<f32>>(
    muscle: &Muscle<f32, R, TYPES>,
    params: &Params,
    step: TimeStep,
    segments: &[Segment],
    mut check: impl FnMut(&State<f32, R, TYPES>, Input<f32>, Output<f32>),
) {
    let (shortest, longest) = path_range(params);
    let mut path = shortest + 0.6 * (longest - shortest);
    let mut state = muscle.rest(path).expect("a path in range");
    // Slightly below the limit because the path is rounded.
    let stride = (4.99 * params.fascicle_length * step.seconds()) as f32;
    let ticks = (0.1 / step.seconds()) as usize;
    for &(activation, goal, speed, stimulation_frequency) in segments {
        let goal = shortest + goal * (longest - shortest);
        for _ in 0..ticks {
            path += (goal - path).clamp(-stride * speed, stride * speed);
            path = path.clamp(shortest, longest);
            let input = Input { activation, path_length: path, stimulation_frequency };
            let output = muscle.step(&mut state, input);
            check(&state, input, output);
        }
    }
}

fn stays_in_range<R: Mode<f32>>(params: &Params, step: TimeStep, segments: &[Segment]) {
    let muscle = built::<f32, R>(params, step);
    // Plus the passive force on the longest path.
    let at_rest = muscle.rest(path_range(params).1).expect("a path in range");
    let most = 3.0 * params.max_isometric_force() as f32 + muscle.observe(&at_rest).force;
    let state_flags = Status::FASCICLE_OUTSIDE_DOMAIN
        | Status::FASCICLE_LENGTH_LIMITED
        | Status::FASCICLE_VELOCITY_LIMITED
        | Status::MECHANICS_UNSETTLED;
    let (shortest, longest) = params.fascicle_domain();
    let slowest = params.shortening_velocity();
    drive(&muscle, params, step, segments, |state, input, output| {
        assert!(all_finite(&output, state), "{output:?} {state:?}");
        assert!((0.0..=most).contains(&output.force), "{} N of {most} at {input:?}", output.force);
        assert!(state_flags.contains(output.status), "{:?} for {input:?}", output.status);
        // A state outside the validity range is flagged, within the rounding tolerance of f32.
        let (length, velocity) =
            (f64::from(output.fascicle_length), f64::from(output.fascicle_velocity));
        let inside = (shortest - 1e-6..=longest + 1e-6).contains(&length);
        if !inside || velocity < slowest * (1.0 + 1e-6) {
            assert!(output.status.contains(Status::FASCICLE_OUTSIDE_DOMAIN), "{output:?}");
        }
    });
}

fn any_input_is_handled<R: Mode<f32>>(params: &Params, step: TimeStep, inputs: &[(f32, f32, f32)]) {
    let muscle = built::<f32, R>(params, step);
    let (shortest, longest) = path_range(params);
    let mut state = muscle.rest(0.5 * (shortest + longest)).expect("a path in range");
    for &(activation, path_length, stimulation_frequency) in inputs {
        let input = Input { activation, path_length, stimulation_frequency };
        for _ in 0..20 {
            let output = muscle.step(&mut state, input);
            assert!(all_finite(&output, &state), "{input:?}: {output:?} {state:?}");
            assert!(output.force >= 0.0);
            let expected = |value: f32, least: f32, most: f32, clipped, not_finite| {
                if !value.is_finite() {
                    not_finite
                } else if (least..=most).contains(&value) {
                    Status::empty()
                } else {
                    clipped
                }
            };
            let flags = expected(
                activation,
                0.0,
                1.0,
                Status::ACTIVATION_CLIPPED,
                Status::ACTIVATION_NOT_FINITE,
            ) | expected(
                stimulation_frequency,
                0.0,
                500.0,
                Status::FREQUENCY_CLIPPED,
                Status::FREQUENCY_NOT_FINITE,
            ) | expected(
                path_length,
                shortest,
                longest,
                Status::PATH_LENGTH_CLIPPED,
                Status::PATH_LENGTH_NOT_FINITE,
            );
            let of_inputs = Status::ACTIVATION_CLIPPED
                | Status::ACTIVATION_NOT_FINITE
                | Status::FREQUENCY_CLIPPED
                | Status::FREQUENCY_NOT_FINITE
                | Status::PATH_LENGTH_CLIPPED
                | Status::PATH_LENGTH_NOT_FINITE;
            assert_eq!(output.status & of_inputs, flags, "{input:?}");
        }
    }
}

fn continues_identically<R: Mode<f32>>(params: &Params, step: TimeStep, segments: &[Segment]) {
    let muscle = built::<f32, R>(params, step);
    let mut restored: Option<State<f32, R, TYPES>> = None;
    drive(&muscle, params, step, segments, |state, input, output| {
        if let Some(other) = &mut restored {
            let again = muscle.step(other, input);
            assert_eq!(output.force.to_bits(), again.force.to_bits());
            assert!(state.words().eq(other.words()), "{state:?} {other:?}");
        }
        let saved: Vec<u32> = muscle.save(state).collect();
        assert_eq!(saved.len(), State::<f32, R, TYPES>::SAVED_WORDS);
        restored = Some(muscle.restore(saved).expect("a saved state"));
    });
}

proptest! {
    #![proptest_config(config(96))]

    #[test]
    fn force_and_state_stay_in_range(
        params in muscles().prop_filter("a snap below F0", |params| snap(params) < 1.0),
        step in steps(),
        s in segments(),
    ) {
        stays_in_range::<NaturalContinuous>(&params, step, &s);
        stays_in_range::<IntramuscularFes>(&params, step, &s);
        stays_in_range::<Discrete<FascicleLength>>(&params, step, &s);
        stays_in_range::<Discrete<EffectiveLength>>(&params, step, &s);
    }

    #[test]
    fn any_input_keeps_the_state_finite_and_raises_the_right_flags(
        params in muscles(),
        step in steps(),
        inputs in prop::collection::vec((any_number(), any_number(), any_number()), 1..20),
    ) {
        any_input_is_handled::<NaturalContinuous>(&params, step, &inputs);
        any_input_is_handled::<IntramuscularFes>(&params, step, &inputs);
        any_input_is_handled::<Discrete<FascicleLength>>(&params, step, &inputs);
        any_input_is_handled::<Discrete<EffectiveLength>>(&params, step, &inputs);
    }

    #[test]
    fn a_restored_state_continues_with_the_same_bits(
        params in muscles(),
        step in steps(),
        s in segments(),
    ) {
        continues_identically::<NaturalContinuous>(&params, step, &s);
        continues_identically::<IntramuscularFes>(&params, step, &s);
        continues_identically::<Discrete<FascicleLength>>(&params, step, &s);
        continues_identically::<Discrete<EffectiveLength>>(&params, step, &s);
    }

    #[test]
    fn a_muscle_at_rest_stays_at_rest(params in muscles(), step in steps(), at in 0.0..=1.0_f32) {
        let (shortest, longest) = path_range(&params);
        let path_length = shortest + at * (longest - shortest);
        let muscle = ContinuousMuscle::<f32, TYPES>::build(&params, step).expect("a valid muscle");
        let mut state = muscle.rest(path_length).expect("a path in range");
        let at_rest = muscle.observe(&state);
        // On a long path passive fascicles may be outside the validity range; passive forces are
        // valid there.
        let beyond = f64::from(at_rest.fascicle_length) > params.fascicle_domain().1;
        let expected = if beyond { Status::FASCICLE_OUTSIDE_DOMAIN } else { Status::empty() };
        let input = Input { activation: 0.0, path_length, stimulation_frequency: 0.0 };
        for _ in 0..500 {
            let output = muscle.step(&mut state, input);
            let change = (output.force - at_rest.force).abs();
            prop_assert!(change <= 1e-5 * params.max_isometric_force() as f32, "{change} N");
            prop_assert!((output.fascicle_length - at_rest.fascicle_length).abs() < 1e-5);
            prop_assert_eq!(output.status, expected);
        }
    }

    #[test]
    fn a_passive_cycle_creates_no_energy(
        params in muscles(),
        cycles in 1..6_u32,
        amplitude in 0.05..0.5_f64,
        period in 0.2..1.0_f64,
    ) {
        // Work of the tendon force along the path, from rest to rest.
        let step = TimeStep::MILLISECOND;
        let muscle = ContinuousMuscle::<f64, TYPES>::build(&params, step).expect("a valid muscle");
        let (shortest, longest) = params.path_domain();
        let middle = longest - 0.5 * amplitude * (longest - shortest);
        let mut state = muscle.rest(middle).expect("a path in range");
        let (mut work, mut turnover) = (0.0, 0.0);
        let mut before = (muscle.observe(&state).force, middle);
        let ticks = (f64::from(cycles) * period / step.seconds()) as u32;
        for tick in 0..=ticks + 1000 {
            let phase = f64::from(tick.min(ticks)) / f64::from(ticks) * f64::from(cycles);
            let swing = (core::f64::consts::TAU * phase).sin();
            let path_length = middle + 0.5 * amplitude * (longest - shortest) * swing;
            let input = Input { activation: 0.0, path_length, stimulation_frequency: 0.0 };
            let force = muscle.step(&mut state, input).force;
            let done = 0.5 * (force + before.0) * (path_length - before.1);
            work += done;
            turnover += done.abs();
            before = (force, path_length);
        }
        // The trapezoid rule is invalid for a force that rings within a tick.
        prop_assert!(work >= -1e-3 * turnover, "{work} J of {turnover} J");
    }
}

/// The force after three seconds of a constant activation at optimal fascicle length.
fn steady_force<R: Mode<f32>>(
    muscle: &Muscle<f32, R, TYPES>,
    params: &Params,
    activation: f32,
    stimulation_frequency: f32,
) -> f32 {
    let slack = params.elements.tendon.slack_length * params.tendon_length;
    // The path range of a short muscle with a long tendon may end before that.
    let path_length = ((params.fascicle_length + 1.02 * slack) as f32).min(path_range(params).1);
    let mut state = muscle.rest(path_length).expect("a path in range");
    let input = Input { activation, path_length, stimulation_frequency };
    let mut force = 0.0;
    for _ in 0..1500 {
        force = muscle.step(&mut state, input).force;
    }
    force
}

proptest! {
    #![proptest_config(config(48))]

    #[test]
    fn steady_force_rises_with_activation(params in muscles(), frequency in 5.0..60.0_f32) {
        let step = TimeStep::from_seconds(2e-3).expect("the longest step");
        let natural = ContinuousMuscle::<f32, TYPES>::build(&params, step).expect("a valid muscle");
        let stimulated = FesMuscle::<f32, TYPES>::build(&params, step).expect("a valid muscle");
        let slack = 1e-5 * params.max_isometric_force() as f32;
        let mut before = (0.0, 0.0);
        for level in 0..=12_u8 {
            let activation = f32::from(level) / 12.0;
            let now = (
                steady_force(&natural, &params, activation, 0.0),
                steady_force(&stimulated, &params, activation, frequency),
            );
            prop_assert!(now.0 >= before.0 - slack, "natural, U {}: {:?}", activation, (before, now));
            prop_assert!(now.1 >= before.1 - slack, "FES, U {}: {:?}", activation, (before, now));
            before = now;
        }
    }
}
