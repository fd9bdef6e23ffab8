//! Limits and thresholds: values just inside are accepted, values just outside are refused.

use vm_nostd::{
    ContinuousMuscle, DiscreteMuscle, FesMuscle, Input, Limit, MotorUnits, MuscleParams, TimeStep,
    UnitSizes,
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

/// The limits of the longest path are where passive fascicles have 0.8 and 2 L_ce0.
#[test]
fn passive_fascicles_are_0_8_to_2_on_the_longest_path() {
    for (path, is_longer) in [(0.05, false), (0.5, true)] {
        let error = changed(|p| p.max_path_length = path).validate().expect_err("a path");
        let Limit::Within { least, most } = error.limit else { panic!("{error}") };
        assert_eq!((error.field, error.value), ("max_path_length", path));
        let nearest = if is_longer { most - 1e-12 } else { least + 1e-12 };
        let params = changed(|p| p.max_path_length = nearest);
        let length = params.maximum_fascicle_length();
        assert!((length - if is_longer { 2.0 } else { 0.8 }).abs() < 1e-9, "{length}");
        assert_eq!(changed(|p| p.max_path_length = nearest).validate(), Ok(()));
    }
}

/// Where FV has a pole at 0.8 L_ce0, the path from there on is at least 0.1 L_ce0 long.
#[test]
fn a_path_domain_is_at_least_a_tenth_of_the_fascicles() {
    let of = |path: f64| {
        changed(|p| {
            for fiber in &mut p.fibers {
                let c1 = 10.0;
                fiber.fiber_type.force_velocity.shortening = [-1.0 - 0.8 * c1, c1];
            }
            p.max_path_length = path;
        })
    };
    let error = of(0.05).validate().expect_err("a path");
    let Limit::Within { least, .. } = error.limit else { panic!("{error}") };
    let params = of(least);
    let (shortest, _) = params.path_domain();
    assert!(params.fascicle_domain().0 > 0.8);
    let room = (least - shortest) / params.fascicle_length;
    assert!((room - 0.1).abs() < 1e-9, "{room}");
}

/// A stiff parallel element ends the path domain: it pulls with 9 F0, the filaments with F0, and
/// the tendon carries both.
#[test]
fn the_path_domain_ends_at_a_passive_force_of_9_f0() {
    let params = changed(|p| {
        let parallel = &mut p.elements.parallel;
        (parallel.stiffness, parallel.toe, parallel.slack_length) = (60.0, 0.02, 0.9);
        p.max_path_length += (1.2 - p.maximum_fascicle_length()) * p.fascicle_length;
    });
    let at = |force: f64, stiffness: f64, toe: f64, slack: f64| {
        slack + toe * (force / (stiffness * toe)).exp_m1().ln()
    };
    let tendon = params.elements.tendon;
    let fascicles = params.maximum_fascicle_length() * at(9.0, 60.0, 0.02, 0.9);
    assert!(fascicles < params.fascicle_domain().1);
    let tendon = at(10.0, tendon.stiffness, tendon.toe, tendon.slack_length);
    let expected = fascicles * params.fascicle_length + tendon * params.tendon_length;
    let (_, longest) = params.path_domain();
    assert!((longest / expected - 1.0).abs() < 1e-9, "{longest} for {expected}");
}

#[test]
fn the_middle_path_is_halfway_from_the_shortest_to_the_longest_passive_one() {
    let params = changed(|_| ());
    let (shortest, _) = params.path_domain();
    let (below, above) =
        (params.middle_path() - shortest, params.max_path_length - params.middle_path());
    assert!((below - above).abs() < 1e-12 && below > 0.0, "{below} {above}");
}

/// Steady force (F0) above the passive one of the second type alone, stimulated for 3 s.
fn stimulated(params: &Params, pps: f64) -> f64 {
    let muscle = FesMuscle::<f64, 2>::build(params, TimeStep::MILLISECOND).expect("valid");
    let force = |activation| {
        let mut state = muscle.rest(0.15).expect("in range");
        let input = Input { activation, path_length: 0.15, stimulation_frequency: pps };
        (0..3000).fold(0.0, |_, _| muscle.step(&mut state, input).relative_force)
    };
    force(1.0) - force(0.0)
}

/// Up to 0.1 f0.5, here 1 pps, a fast type is at rest and S is 1.76; above it sags to 0.96.
#[test]
fn a_stimulated_type_sags_above_0_1_of_its_half_force_frequency() {
    let params = changed(|p| {
        p.fibers[0].fiber_type.half_force_frequency = 200.0;
        p.fibers[1].fiber_type.half_force_frequency = 10.0;
    });
    let (at_rest, sagging) = (stimulated(&params, 1.0), stimulated(&params, 1.000_001));
    assert!(at_rest > 2.0 * sagging && sagging > 0.0, "{at_rest} {sagging}");
}

/// In FES, Tf4 slows the fall to any activation but 0.
#[test]
fn excitation_falls_faster_to_no_stimulation_than_to_little() {
    let muscle =
        FesMuscle::<f64, 2>::build(&changed(|_| ()), TimeStep::MILLISECOND).expect("valid");
    let left = |activation_after: f64| {
        let mut state = muscle.rest(0.15).expect("in range");
        let mut step = |activation| {
            let input = Input { activation, path_length: 0.15, stimulation_frequency: 30.0 };
            muscle.step(&mut state, input).relative_force
        };
        let before = (0..500).fold(0.0, |_, _| step(1.0));
        (0..60).fold(0.0, |_, _| step(activation_after)) / before
    };
    let (to_none, to_little) = (left(0.0), left(1e-9));
    assert!(to_none < 0.9 * to_little, "{to_none} {to_little}");
}
