//! The fine class takes a long tick in parts: it is as a muscle of half the time step.

use model_tests::muscles::{Mode, built};
use vm_nostd::{
    Class, Fixed, Input, IntramuscularFes, MuscleParams, NaturalContinuous, Scalar, Status,
    TimeStep,
};
use vm_nostd_cores::MUSCLE;

/// Steps a muscle at 1 ms and one at 0.5 ms, on a path with the same places at whole milliseconds.
fn alike<S: Scalar, R: Mode<S>>() {
    let params = MuscleParams { class: Class::Fine, ..MUSCLE };
    let half = TimeStep::from_seconds(0.5e-3).expect("a time step");
    let whole = built::<S, R>(&params, TimeStep::MILLISECOND);
    let halves = built::<S, R>(&params, half);
    // Where the place between is exact in floating point; in fixed point it is rounded by 1 nm.
    let path = |half_ms: i32| S::path_length(0.15 + f64::from(half_ms) / 65_536.0);
    let start = path(0);
    let mut states = [&whole, &halves].map(|muscle| muscle.rest(start).expect("in range"));
    for tick in 0..400 {
        let input = |half_ms: i32| Input {
            activation: S::from_f64(if tick < 200 { 0.8 } else { 0.0 }),
            path_length: path((half_ms - 400).abs() - 400),
            stimulation_frequency: S::quantity(if tick % 50 < 25 { 20.0 } else { 35.0 }),
        };
        let [one, other] = &mut states;
        let found = whole.step(one, input(2 * tick + 2));
        let first = halves.step(other, input(2 * tick + 1));
        let expected = halves.step(other, input(2 * tick + 2));
        let distance = |a: S, b: S| (a.to_f64() - b.to_f64()).abs();
        assert!(
            distance(found.relative_force, expected.relative_force) < 1e-5,
            "tick {tick}: {found:?} {expected:?}"
        );
        assert_eq!(found.status, first.status | expected.status, "tick {tick}");
    }
}

#[test]
fn a_fine_millisecond_is_two_halves() {
    alike::<f32, NaturalContinuous>();
    alike::<f64, IntramuscularFes>();
    alike::<Fixed, NaturalContinuous>();
    alike::<Fixed, IntramuscularFes>();
}

/// A flag of any part is one of the tick, and an invalid input is flagged and replaced once.
#[test]
fn flags_of_all_parts_are_raised() {
    let params = MuscleParams { class: Class::Fine, ..MUSCLE };
    let muscle =
        built::<f32, NaturalContinuous>(&params, TimeStep::from_seconds(2e-3).expect("a step"));
    let (shortest, longest) = muscle.path_length_range();
    let mut state = muscle.rest(shortest).expect("in range");
    let input = |path_length| Input { activation: 0.0, path_length, stimulation_frequency: 0.0 };
    let jumped = muscle.step(&mut state, input(longest));
    assert!(jumped.status.contains(Status::MECHANICS_UNSETTLED), "{jumped:?}");
    let kept = muscle.step(&mut state, input(f32::NAN));
    assert!(kept.status.contains(Status::PATH_LENGTH_NOT_FINITE), "{kept:?}");
    assert!(kept.force.is_finite());
    let clipped = muscle.step(&mut state, input(longest + 1.0));
    assert!(clipped.status.contains(Status::PATH_LENGTH_CLIPPED), "{clipped:?}");
}
