//! Limits and thresholds: values just inside are accepted, values just outside are refused.

use vm_nostd::{
    ContinuousMuscle, DiscreteMuscle, Input, Limit, MotorUnits, MuscleParams, TimeStep, UnitSizes,
};
use vm_nostd_cores::MUSCLE;

type Params = MuscleParams<2>;

fn changed(change: impl FnOnce(&mut Params)) -> Params {
    let mut params = MUSCLE;
    change(&mut params);
    params
}

#[test]
fn fractions_must_add_to_one_within_1e_6() {
    for off in [-0.9e-6, 0.9e-6] {
        assert_eq!(changed(|p| p.fibers[0].fraction += off).validate(), Ok(()), "{off}");
    }
    for off in [-1.1e-6, 1.1e-6, -2e-5, 2e-5] {
        let error = changed(|p| p.fibers[0].fraction += off).validate().expect_err("a sum");
        assert_eq!((error.field, error.fiber), ("fraction", None), "{off}");
        assert_eq!(error.limit, Limit::SumIsOne { within: 1e-6 });
        assert!((error.value - 1.0 - off).abs() < 1e-12);
    }
}

/// Types are in order of rank; those of the same one may be in any.
#[test]
fn types_may_share_a_rank() {
    let MuscleParams { fibers: [slow, fast], .. } = MUSCLE;
    assert!(slow.fiber_type.rank < fast.fiber_type.rank);
    assert_eq!(changed(|p| p.fibers[1].fiber_type.rank = slow.fiber_type.rank).validate(), Ok(()));
    let refused = changed(|p| p.fibers = [fast, slow]).validate().expect_err("the wrong order");
    let limit = Limit::NotBefore { rank: f64::from(fast.fiber_type.rank) };
    assert_eq!((refused.field, refused.fiber, refused.limit), ("rank", Some(1), limit));
}

/// FV must rise with velocity at every fascicle length: at the shortest, at the longest, and at an
/// extremum of its coefficients in between.
#[test]
fn types_with_a_falling_force_velocity_curve_are_refused() {
    let refused = |shortening: Option<[f64; 2]>, lengthening: Option<[f64; 3]>| {
        let params = changed(|p| {
            let curve = &mut p.fibers[1].fiber_type.force_velocity;
            curve.shortening = shortening.unwrap_or(curve.shortening);
            curve.lengthening = lengthening.unwrap_or(curve.lengthening);
        });
        params.validate().err().map(|error| (error.field, error.fiber))
    };
    let (shortest, longest) = MUSCLE.fascicle_domain();
    assert_eq!(refused(None, None), None);
    let (on_shortening, on_lengthening) = (
        Some(("force_velocity.shortening: cV0 + cV1 L", Some(1))),
        Some(("force_velocity.lengthening: aV0 + aV1 L + aV2 L²", Some(1))),
    );
    // At the longest only: at the shortest another limit applies first.
    let slope = -2.0 / longest;
    assert_eq!(refused(Some([1.0, slope]), None), on_shortening);
    assert_eq!(refused(Some([1.1, slope]), None), None);
    // The coefficient falls, rises or has its maximum in between; the limit there is -1.
    for (lengthening, at) in [
        ([0.0, -1.0 / shortest, 0.0], shortest),
        ([-2.0, 1.0 / longest, 0.0], longest),
        ([-3.0, 4.0, -2.0], 1.0),
    ] {
        let [a0, a1, a2] = lengthening;
        assert!((a0 + a1 * at + a2 * at * at + 1.0).abs() < 1e-12);
        assert_eq!(refused(None, Some([a0 - 1e-6, a1, a2])), None, "{at}");
        assert_eq!(refused(None, Some([a0 + 1e-6, a1, a2])), on_lengthening, "{at}");
    }
}

/// A small first unit is recruited at an activation of 0.001, not before.
#[test]
fn nothing_is_recruited_below_an_activation_of_0_001() {
    let input =
        |activation| Input { activation, path_length: 0.16_f32, stimulation_frequency: 0.0 };
    let continuous =
        ContinuousMuscle::<f32, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("valid");
    let sizes = [UnitSizes::Listed(&[1.0, 1000.0]), UnitSizes::Default(1)];
    let units = MotorUnits::<4>::new(&MUSCLE, sizes).expect("units");
    let step = TimeStep::MILLISECOND;
    let discrete =
        DiscreteMuscle::<f32, 2, 4>::build_with_units(&MUSCLE, &units, step).expect("valid");
    for (activation, fires) in [(0.000_99, false), (0.001_01, true)] {
        let mut state = discrete.rest(0.16).expect("in range");
        let mut idle = state;
        for _ in 0..100 {
            let _ = discrete.step(&mut state, input(activation));
            let _ = discrete.step(&mut idle, input(0.0));
        }
        assert_eq!(state != idle, fires, "discrete at {activation}");

        // Below the threshold effective activation follows, but the frequency stays 0.
        let mut state = continuous.rest(0.16).expect("in range");
        for _ in 0..2000 {
            let _ = continuous.step(&mut state, input(activation));
        }
        let with = continuous.observe(&state).force;
        let mut idle = continuous.rest(0.16).expect("in range");
        for _ in 0..2000 {
            let _ = continuous.step(&mut idle, input(0.0));
        }
        let without = continuous.observe(&idle).force;
        assert_eq!(with != without, fires, "continuous at {activation}: {with} N, {without} N");
    }
}
