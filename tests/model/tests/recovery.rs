//! Recovery: what a muscle does after inputs that no sensor should deliver.

use model_tests::muscles::{Discrete, Mode, TYPES, any_coefficients, built, config, muscles};
use proptest::prelude::*;
use vm_nostd::{
    EffectiveLength, FascicleLength, FiberParams, Fixed, Input, IntramuscularFes, MuscleParams,
    NaturalContinuous, Scalar, TimeStep,
};

type Params = MuscleParams<TYPES>;

/// Inputs far out of any range, and within: activation, path (m) and frequency.
fn abuse() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let number = || {
        prop_oneof![
            2 => -2.0..2.0_f64,
            1 => -1e3..1e3_f64,
            1 => Just(f64::NAN),
            1 => Just(f64::INFINITY),
            1 => Just(f64::NEG_INFINITY),
        ]
    };
    let activation = prop_oneof![number(), 0.0..=1.0_f64, Just(1.0)];
    let path = prop_oneof![number(), 0.0..0.6_f64];
    let frequency = prop_oneof![number(), 0.0..100.0_f64, Just(500.0)];
    prop::collection::vec((activation, path, frequency), 1..25)
}

/// How far the force is from that of a muscle at rest, % of F0, after 20 ticks of each of the
/// inputs and [`REST`] on a path at a share of the range; and the fascicles' length at rest there,
/// L_ce0.
fn left_after<S: Scalar, R: Mode<S>>(
    params: &Params,
    step: TimeStep,
    inputs: &[(f64, f64, f64)],
    at: f64,
) -> (f64, f64) {
    let muscle = built::<S, R>(params, step);
    let (shortest, longest) = muscle.path_length_range();
    let (shortest, longest) = (S::path_metres(shortest), S::path_metres(longest));
    let middle = S::path_length(0.5 * (shortest + longest));
    let mut state = muscle.rest(middle).expect("a path in range");
    for &(activation, path, frequency) in inputs {
        let input = Input {
            activation: S::from_f64(activation),
            path_length: S::path_length(path),
            stimulation_frequency: S::quantity(frequency),
        };
        for _ in 0..20 {
            muscle.step(&mut state, input);
        }
    }
    let path_length = S::path_length(shortest + (0.01 + 0.98 * at) * (longest - shortest));
    let rest = muscle.observe(&muscle.rest(path_length).expect("a path in range"));
    let input = Input { activation: S::ZERO, path_length, stimulation_frequency: S::quantity(0.0) };
    let mut force = rest.relative_force;
    for _ in 0..(REST / step.seconds()) as usize {
        force = muscle.step(&mut state, input).relative_force;
    }
    let left = 100.0 * (force.to_f64() - rest.relative_force.to_f64()).abs();
    (left, rest.fascicle_length.to_f64())
}

/// Seconds of rest.
const REST: f64 = 3.0;
/// What may be left, % of F0.
const MOST_LEFT: f64 = 0.1;
/// Seconds of rest in which fascicles may still be on their way, at another T_f.
const ON_THE_WAY: f64 = 0.5;

/// The largest Af that the equations leave of a type after [`REST`] at a fascicle length: f_eff is
/// what two lags of T_f leave of f_max, and n_f may be so small that Af falls far slower than that.
fn activation_left(params: &Params, length: f64) -> f64 {
    let (shortest, longest) = params.fascicle_domain();
    let length = length.clamp(shortest, longest);
    let left = |fiber: &FiberParams| {
        let t = &fiber.fiber_type;
        let sag = t.sag.map_or(1.0, |sag| sag.resting_level.max(sag.firing_level));
        let time = (t.excitation.fall + t.excitation.fall_per_activation) / length;
        let constants = (REST - ON_THE_WAY) / time;
        let frequency = sag * t.maximum_frequency * (1.0 + constants) * (-constants).exp();
        let p = &t.activation;
        let exponent = p.exponent + p.length_dependence * (1.0 / length - 1.0);
        fiber.fraction * (1.0 - (-(frequency / (p.scale * exponent)).powf(exponent)).exp())
    };
    params.fibers.iter().map(left).sum()
}

/// Holds a muscle in an arithmetic and all modes to what may be left of its force. Only a muscle of
/// `any` coefficients may be as slow as its equations say.
fn recovers<S: Scalar>(
    params: &Params,
    step: TimeStep,
    inputs: &[(f64, f64, f64)],
    at: f64,
    any: bool,
) {
    let modes = [
        left_after::<S, NaturalContinuous>,
        left_after::<S, IntramuscularFes>,
        left_after::<S, Discrete<FascicleLength>>,
        left_after::<S, Discrete<EffectiveLength>>,
    ];
    for (mode, left_after) in modes.into_iter().enumerate() {
        let (left, length) = left_after(params, step, inputs, at);
        let slow = if any { 100.0 * activation_left(params, length) } else { 0.0 };
        let most = MOST_LEFT + slow;
        assert!(
            left <= most,
            "mode {mode}: {left} % of F0 left, of at most {most}, at {length} L_ce0"
        );
    }
}

/// Usual time steps: shorter ones take as long as they are many.
fn usual_steps() -> impl Strategy<Value = TimeStep> {
    prop_oneof![Just(5e-4), Just(1e-3), Just(2e-3)]
        .prop_map(|seconds| TimeStep::from_seconds(seconds).expect("in range"))
}

proptest! {
    #![proptest_config(config(96))]

    #[test]
    fn after_any_input_a_published_muscle_is_as_at_rest_within_three_seconds(
        params in muscles(),
        step in usual_steps(),
        inputs in abuse(),
        at in 0.0..=1.0_f64,
    ) {
        recovers::<f32>(&params, step, &inputs, at, false);
        recovers::<Fixed>(&params, step, &inputs, at, false);
    }

    #[test]
    fn a_muscle_of_any_coefficients_is_too_unless_its_equations_are_slower(
        params in any_coefficients(),
        step in usual_steps(),
        inputs in abuse(),
        at in 0.0..=1.0_f64,
    ) {
        recovers::<f32>(&params, step, &inputs, at, true);
        recovers::<Fixed>(&params, step, &inputs, at, true);
    }
}
