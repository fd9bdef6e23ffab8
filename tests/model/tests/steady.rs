//! The inverse model of FES: it reproduces steady forces, and returns the nearest for an
//! unreachable one.

use model_tests::muscles::{TYPES, config, muscles};
use proptest::prelude::*;
use vm_nostd::{FesMuscle, Fixed, MuscleParams, Scalar, Status, Steady, SteadyFes, TimeStep};
use vm_nostd_cores::MUSCLE;

const PATHS: [f64; 4] = [0.13, 0.145, 0.16, 0.175];

fn input<S: Scalar>(activation: f64, path: f64, frequency: f64) -> vm_nostd::Input<S> {
    vm_nostd::Input {
        activation: S::from_f64(activation),
        path_length: S::path_length(path),
        stimulation_frequency: S::quantity(frequency),
    }
}

/// A force in N, in an arithmetic.
fn force<S: Scalar>(newtons: f64) -> S::Force {
    S::from_newtons(newtons)
}

/// The steady force of a stimulation is the steady force of the stimulation that the inverse
/// returns for it.
fn there_and_back<S: Scalar>(
    params: &MuscleParams<TYPES>,
    (activation, path, frequency): (f64, f64, f64),
    unit: f64,
) -> Result<(), TestCaseError> {
    // Fixed point refuses unrepresentable muscles.
    let Ok(steady) = SteadyFes::<S, TYPES>::build(params) else { return Ok(()) };
    let (shortest, longest) = params.path_domain();
    let path = shortest + path * (longest - shortest);
    let input = input::<S>(activation, path, frequency);
    let there = steady.force(input);
    let f0 = params.max_isometric_force();
    prop_assert!((0.0..10.0 * f0).contains(&S::newtons(there.force)), "{:?}", there);
    let back = steady.activation_for(there.force, input.path_length, input.stimulation_frequency);
    let again = steady.force(vm_nostd::Input { activation: back.activation, ..input });
    let difference = (S::newtons(again.force) - S::newtons(there.force)).abs();
    // Fixed point resolves force to 1 mN and tendon extension to 6e-8 L_ce0.
    // Tolerance at the limit of reachable forces.
    let ends = if activation == 0.0 || activation > 0.999_999 { 1e-4 } else { 0.0 };
    let most = (unit + ends) * f0 + 2e-3;
    prop_assert!(difference <= most, "{:e} F0 {:?} {:?}", difference / f0, there, back);
    // A steady force is reachable.
    prop_assert!(!back.status.contains(Status::FORCE_UNREACHABLE), "{:?} {:?}", there, back);
    Ok(())
}

proptest! {
    #![proptest_config(config(2000))]

    #[test]
    fn the_inverse_reproduces_steady_forces_of_any_muscle(
        params in muscles(),
        activation in prop_oneof![0.0..=1.0_f64, Just(1.0), Just(0.0), Just(0.999_999_9)],
        path in 0.0..=1.0_f64,
        frequency in 1.0..80.0_f64,
    ) {
        there_and_back::<f32>(&params, (activation, path, frequency), 1e-5)?;
        there_and_back::<Fixed>(&params, (activation, path, frequency), 6e-5)?;
    }
}

/// An unreachable force is flagged, with the nearest reachable one.
fn unreachable<S: Scalar>() {
    let steady = SteadyFes::<S, 2>::build(&MUSCLE).expect("a muscle");
    let (path, frequency) = (S::path_length(0.16), S::quantity(20.0));
    let newtons = |steady: Steady<S>| S::newtons(steady.force);
    let nothing = steady.force(input(0.0, 0.16, 20.0));
    let all = steady.force(input(1.0, 0.16, 20.0));
    assert!(newtons(all) > 100.0 && newtons(nothing) < 1.0);
    for (wanted, nearest) in
        [(2.0 * newtons(all), all), (1.002 * newtons(all), all), (1e4, all), (-5.0, nothing)]
    {
        let found = steady.activation_for(force::<S>(wanted), path, frequency);
        assert_eq!(found.status, Status::FORCE_UNREACHABLE, "{wanted} N");
        assert_eq!(Steady { status: Status::empty(), ..found }, nearest, "{wanted} N");
    }
    // Without stimulation only the passive force is reachable.
    let found = steady.activation_for(force::<S>(50.0), path, S::quantity(0.0));
    assert_eq!(found.status, Status::FORCE_UNREACHABLE);
    assert!(newtons(found) < 1.0);
    // A path out of range is clipped and flagged as in a tick.
    let found = steady.activation_for(force::<S>(20.0), S::path_length(0.3), frequency);
    assert!(found.status.contains(Status::PATH_LENGTH_CLIPPED));
}

#[test]
fn unreachable_forces_are_flagged_and_the_nearest_is_returned() {
    unreachable::<f32>();
    unreachable::<Fixed>();
    let steady = SteadyFes::<f32, 2>::build(&MUSCLE).expect("a muscle");
    let found = steady.activation_for(f32::NAN, 0.16, 20.0);
    assert_eq!(found.status, Status::FORCE_UNREACHABLE);
    assert_eq!(found.activation, 0.0);
}

/// For forces around the greatest steady one the inverse returns (nearly) full activation, never
/// none.
fn the_greatest<S: Scalar>() {
    let steady = SteadyFes::<S, 2>::build(&MUSCLE).expect("a muscle");
    for path in 0..=100 {
        let path = 0.12 + 0.0006 * f64::from(path);
        for frequency in [5.0, 10.0, 20.0, 30.0, 50.0, 80.0] {
            let all = steady.force(input(1.0, path, frequency));
            for by in [-1e-4, -1e-5, -1e-6, 0.0, 1e-6, 1e-5, 1e-4] {
                let newtons = S::newtons(all.force) + by * MUSCLE.max_isometric_force();
                let wanted = if by == 0.0 { all.force } else { force::<S>(newtons) };
                let (path_length, f) = (S::path_length(path), S::quantity(frequency));
                let found = steady.activation_for(wanted, path_length, f);
                let off = (S::newtons(found.force) - newtons).abs();
                assert!(
                    off <= 1.1e-4 * MUSCLE.max_isometric_force() + 1e-3,
                    "{path} m, {frequency} pps: {found:?}"
                );
                let beyond = found.status.contains(Status::FORCE_UNREACHABLE);
                assert!(!beyond || by >= 9e-5, "{path} m, {frequency} pps, {by:e}: {found:?}");
            }
        }
    }
}

#[test]
fn forces_near_the_greatest_take_full_activation() {
    the_greatest::<f32>();
    the_greatest::<f64>();
    the_greatest::<Fixed>();
}

/// With very long tendons a force may have an unstable equilibrium, which is only returned with a
/// flag.
#[test]
fn with_several_equilibria_the_result_is_stable_or_flagged() {
    let mut flagged = 0;
    for ratio in [30.0, 39.2, 48.0] {
        let (fascicle, tendon) = (0.02, 0.02 * ratio);
        // Mostly fast fibres and long fascicles: Af falls steeply with length at a low frequency.
        let mut muscle = MuscleParams {
            mass: 12e-3,
            fascicle_length: fascicle,
            tendon_length: tendon,
            max_path_length: 0.96 * tendon + 1.6 * fascicle,
            ..MUSCLE
        };
        for (fiber, fraction) in muscle.fibers.iter_mut().zip([0.1, 0.9]) {
            fiber.fraction = fraction;
        }
        let f0 = muscle.max_isometric_force();
        let steady = SteadyFes::<f64, 2>::build(&muscle).expect("a muscle");
        for share in 1..40 {
            for path in 0..60 {
                let path = 0.965 * tendon + (0.55 + 0.02 * f64::from(path)) * fascicle;
                let wanted = f0 * f64::from(share) / 160.0;
                let found = steady.activation_for(wanted, path, 12.0);
                if found.status.contains(Status::FORCE_UNREACHABLE) {
                    flagged += 1;
                    continue;
                }
                let held = steady.force(vm_nostd::Input {
                    activation: found.activation,
                    path_length: path,
                    stimulation_frequency: 12.0,
                });
                assert!((held.force - wanted).abs() <= 1.001e-3 * f0, "{ratio} {path} {wanted}");
            }
        }
    }
    assert!(flagged > 0);
}

/// The model settles at the force of the steady state.
#[test]
fn the_model_settles_in_its_steady_state() {
    let muscle = FesMuscle::<f32, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let steady = SteadyFes::<f32, 2>::build(&MUSCLE).expect("a muscle");
    for path in PATHS {
        let input = input(0.45, path, 20.0);
        let mut state = muscle.rest(path as f32).expect("a path");
        let force = (0..4000).map(|_| muscle.step(&mut state, input).force).last();
        let difference = (force.unwrap_or(f32::NAN) - steady.force(input).force).abs();
        assert!(difference < 4e-6 * 266.0, "{path} m: {difference} N");
    }
}
