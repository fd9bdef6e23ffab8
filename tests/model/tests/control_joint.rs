//! Joints: paths, moment arms, torque and stiffness against closed forms in `f64`, and refusals.

use vm_nostd::control::{
    ANKLE, Action, AngleRange, ELBOW, Joint, JointMuscle, JointPreset, JointStatus, KNEE,
    PathParams,
};
use vm_nostd::{ContinuousMuscle, FesMuscle, Fixed, Input, Scalar, TimeStep};

const PRESETS: [JointPreset; 3] = [ANKLE, KNEE, ELBOW];

/// A path by its definition, term by term.
fn length<const J: usize>(path: &PathParams<J>, angles: [f64; J]) -> f64 {
    let mut sum = path.length;
    for ((terms, angle), reference) in path.terms.iter().zip(angles).zip(path.reference) {
        for (power, term) in (1..).zip(terms) {
            sum += term * (angle - reference).powi(power);
        }
    }
    if J == 2 {
        sum += path.product * (angles[0] - path.reference[0]) * (angles[1] - path.reference[1]);
    }
    sum
}

/// Its derivative by an angle, negated.
fn arm<const J: usize>(path: &PathParams<J>, angles: [f64; J], j: usize) -> f64 {
    let beside = |by: f64| {
        let mut angles = angles;
        angles[j] += by;
        length(path, angles)
    };
    // Of sixth order: no error but rounding matters.
    let [a, b, c] = [1e-2, 2e-2, 3e-2].map(|h| (beside(h) - beside(-h)) / (2.0 * h));
    -(15.0 * a - 6.0 * b + c) / 10.0
}

/// Two joints, all terms, and a product.
fn coupled() -> (JointMuscle<2>, [AngleRange; 2]) {
    let path = PathParams {
        length: 0.3329,
        reference: [1.57, 0.2],
        terms: [
            [-0.03, 0.001, -0.0005, 0.0, 0.0, 0.0],
            [-0.016, -0.0057, 0.0004, 0.0002, -0.0001, 0.00002],
        ],
        product: 0.002,
        action: [Action::Flexes; 2],
    };
    let muscle = JointMuscle {
        path,
        path_domain: (0.2, 0.5),
        max_isometric_force: 414.0,
        fascicle_length: 0.137,
    };
    (muscle, [AngleRange::degrees(-40.0, 135.0), AngleRange::degrees(0.0, 155.0)])
}

fn over<const J: usize>(ranges: &[AngleRange; J], check: impl Fn([f64; J])) {
    let steps: usize = 20;
    for step in 0..(steps + 1).pow(J as u32) {
        let mut rest = step;
        check(ranges.map(|range| {
            let share = (rest % (steps + 1)) as f64 / steps as f64;
            rest /= steps + 1;
            range.least + share * (range.most - range.least)
        }));
    }
}

/// Bounds in m, m and m/rad²: rounding of the arithmetic.
fn postures<S: Scalar, const J: usize>(
    muscle: JointMuscle<J>,
    ranges: [AngleRange; J],
    bounds: [f64; 3],
) {
    let joint = Joint::<S, J, 1>::build(&ranges, &[muscle]).expect("a joint");
    let path = &muscle.path;
    over(&ranges, |angles| {
        let posture = joint.posture(angles.map(S::from_f64));
        let placed = &posture.muscles[0];
        let off = (S::path_metres(placed.path_length) - length(path, angles)).abs();
        assert!(off < bounds[0], "{angles:?}: path off by {off:e} m");
        for j in 0..J {
            let off = (placed.moment_arms[j].to_f64() - arm(path, angles, j)).abs();
            assert!(off < bounds[1], "{angles:?}: arm off by {off:e} m");
            let mut beside = [angles; 2];
            beside[0][j] -= 1e-4;
            beside[1][j] += 1e-4;
            let [less, more] = beside.map(|angles| path.moment_arms_at(angles)[j]);
            let off = (placed.arm_slopes[j].to_f64() - (more - less) / 2e-4).abs();
            assert!(off < bounds[2], "{angles:?}: slope off by {off:e} m/rad");
        }
    });
}

/// In fixed point an angle has 24 bits of fraction, a path steps of 2 nm, an arm 6e-8 m; terms are
/// rounded to 6 nm and arms' slopes divide by the half range twice. `f32` has 24 bits.
#[test]
fn paths_and_moment_arms_are_those_of_the_polynomial() {
    for preset in PRESETS {
        for muscle in preset.muscles.map(|muscle| muscle.on_joint()) {
            postures::<f64, 1>(muscle, [preset.range], [1e-12, 1e-11, 1e-8]);
            postures::<f32, 1>(muscle, [preset.range], [1e-7, 2e-7, 1e-6]);
            postures::<Fixed, 1>(muscle, [preset.range], [1e-7, 4e-7, 2e-6]);
        }
    }
    let (muscle, ranges) = coupled();
    postures::<f64, 2>(muscle, ranges, [1e-12, 1e-11, 1e-8]);
    postures::<f32, 2>(muscle, ranges, [1e-7, 2e-7, 1e-6]);
    postures::<Fixed, 2>(muscle, ranges, [1e-7, 4e-7, 2e-6]);
}

#[test]
fn presets_have_the_published_moment_arms() {
    let arm = |muscle: usize, preset: &JointPreset, degrees: f64| {
        preset.muscles[muscle].path().moment_arms_at([degrees.to_radians()])[0] * 1e3
    };
    for (found, published, within) in [
        (arm(0, &ANKLE, 15.0), 45.0, 1e-9),
        (arm(0, &ANKLE, -30.0), 29.0, 1e-9),
        (arm(1, &ANKLE, 20.0), -34.6, 1e-9),
        (arm(1, &ANKLE, -10.0), -36.9, 1e-9),
        (arm(1, &KNEE, 0.0), -42.55, 0.3),
        (arm(1, &KNEE, 20.0), -39.91, 0.3),
        (arm(1, &KNEE, 40.0), -37.73, 0.3),
        (arm(1, &KNEE, 60.0), -36.18, 0.3),
        (arm(0, &KNEE, 50.0), (896.0 * 20.0 + 1288.0 * 30.0 + 410.0 * 47.5) / 2594.0, 0.05),
        // The polynomials at 0 and 90 degrees.
        (arm(0, &ELBOW, 0.0), 14.66, 1e-9),
        (arm(0, &ELBOW, 90.0), 14.66 + 0.45322 * 90.0 + 14.61807 - 21.784707, 1e-9),
        (arm(1, &ELBOW, 0.0), -23.287, 1e-9),
    ] {
        assert!((found - published).abs() <= within, "{found} mm, not {published} mm");
    }
}

/// The lumped muscles are those of the table of human muscles.
#[test]
fn presets_lump_the_published_muscles() {
    let table = include_str!("../../../host-sim/data/human_muscles.csv");
    let row = |name: &str| -> [f64; 4] {
        let line = table.lines().find(|line| line.split(',').next() == Some(name)).expect(name);
        let cells: Vec<&str> = line.split(',').collect();
        [1, 2, 3, 7].map(|column| cells[column].parse().expect("a number"))
    };
    let lumps: [(_, &[&str]); 6] = [
        (ANKLE.muscles[0], &["tibialis_anterior"]),
        (ANKLE.muscles[1], &["soleus"]),
        (KNEE.muscles[0], &["biceps_femoris_long", "semimembranosus", "semitendinosus"]),
        (
            KNEE.muscles[1],
            &["rectus_femoris", "vastus_lateralis", "vastus_medialis", "vastus_intermedius"],
        ),
        (ELBOW.muscles[0], &["biceps_brachii_long", "biceps_brachii_short"]),
        (ELBOW.muscles[1], &["triceps_long", "triceps_lateral", "triceps_medial"]),
    ];
    for (muscle, names) in lumps {
        let rows: Vec<_> = names.iter().map(|name| row(name)).collect();
        let force: f64 = rows.iter().map(|row| row[0]).sum();
        let mean = |column: usize| rows.iter().map(|r| r[0] * r[column]).sum::<f64>() / force;
        let found = [
            muscle.max_isometric_force,
            muscle.fascicle_length * 1e2,
            muscle.tendon_slack_length * 1e2,
            muscle.slow_fraction,
        ];
        for (found, expected) in found.into_iter().zip([force, mean(1), mean(2), mean(3)]) {
            assert!((found / expected - 1.0).abs() < 1e-3, "{}: {found} {expected}", muscle.name);
        }
        let f0 = muscle.params().max_isometric_force();
        assert!((f0 / force - 1.0).abs() < 1e-9, "{}: {f0} N", muscle.name);
        assert!((muscle.params().maximum_fascicle_length() - 1.4).abs() < 1e-9);
    }
}

fn torque_is_the_sum_of_force_times_arm<S: Scalar>(within: f64) {
    let muscles = KNEE.muscles.map(|muscle| muscle.on_joint());
    let knee = Joint::<S, 1, 2>::build(&[KNEE.range], &muscles).expect("a knee");
    over(&[KNEE.range], |angles| {
        let posture = knee.posture(angles.map(S::from_f64));
        for forces in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.3], [0.4, 0.07]] {
            let [torque] = knee.torques(&posture, &forces.map(S::from_f64));
            let expected = forces[0] * 2594.0 * 0.0293
                + forces[1] * 5699.0 * (-42.286e-3 + 6.0991e-3 * angles[0]);
            let off = (S::quantity_value(torque) - expected).abs();
            assert!(off < within, "{angles:?} {forces:?}: off by {off} N m");
        }
    });
}

/// 6e-8 of force times arm times F0, and of the sum's unit of 1,024 N m.
#[test]
fn torques_are_the_sum_of_force_times_arm() {
    torque_is_the_sum_of_force_times_arm::<f64>(1e-9);
    torque_is_the_sum_of_force_times_arm::<f32>(1e-4);
    torque_is_the_sum_of_force_times_arm::<Fixed>(3e-3);
}

fn bad_angles<S: Scalar>(angle: S, status: JointStatus, like: f64) {
    let muscles = KNEE.muscles.map(|muscle| muscle.on_joint());
    let knee = Joint::<S, 1, 2>::build(&[KNEE.range], &muscles).expect("a knee");
    let found = knee.posture([angle]);
    assert_eq!(found.status, status);
    assert_eq!(found.muscles, knee.posture([S::from_f64(like)]).muscles);
}

#[test]
fn angles_are_clipped_and_flagged() {
    let (clipped, not_finite) = (JointStatus::ANGLE_CLIPPED, JointStatus::ANGLE_NOT_FINITE);
    let AngleRange { least, most } = KNEE.range;
    bad_angles::<f32>(-0.1, clipped, least);
    bad_angles::<f32>(9.0, clipped, most);
    bad_angles::<Fixed>(Fixed::from_f64(-0.1), clipped, least);
    bad_angles::<Fixed>(Fixed::from_bits(i32::MAX), clipped, most);
    bad_angles::<f32>(f32::NAN, not_finite, 0.5 * (least + most));
    bad_angles::<f32>(f32::INFINITY, clipped | not_finite, most);
}

#[test]
fn what_is_no_joint_is_refused_by_name() {
    let good = KNEE.muscles[0].on_joint();
    let refused = |change: fn(&mut JointMuscle<1>)| {
        let mut bad = good;
        change(&mut bad);
        let error = Joint::<f32, 1, 2>::build(&[KNEE.range], &[good, bad]).expect_err("refused");
        assert_eq!(error.muscle, Some(1));
        error.error
    };
    let error = refused(|muscle| muscle.path.action = [Action::Extends]);
    assert_eq!(error.field, "path.terms: moment arm of an extensor, m");
    assert!((error.value - 0.0293).abs() < 1e-9, "{error}");
    // A moment arm that passes 0 inside the range, between two samples too.
    let error = refused(|muscle| muscle.path.terms[0][1] = 0.0293 / 2.0);
    assert_eq!(error.field, "path.terms: moment arm of a flexor, m");
    let error = refused(|muscle| muscle.path.length += 0.08);
    assert_eq!(error.field, "path.length: longest path in the joints' range, m");
    let error = refused(|muscle| muscle.path.length -= 0.08);
    assert_eq!(error.field, "path.length: shortest path in the joints' range, m");
    let error = refused(|muscle| muscle.path.terms[0][3] = f64::NAN);
    assert_eq!(error.field, "path.terms");
    assert_eq!(refused(|muscle| muscle.path.product = 0.01).field, "path.product");
    assert_eq!(refused(|muscle| muscle.max_isometric_force = 0.0).field, "max_isometric_force");
    assert_eq!(refused(|muscle| muscle.fascicle_length = 2.0).field, "fascicle_length");
    let upside_down = AngleRange { least: 1.0, most: 0.5 };
    let error = Joint::<f32, 1, 1>::build(&[upside_down], &[good]).expect_err("no range");
    assert_eq!((error.muscle, error.error.field), (None, "angle_range.most"));
    assert_eq!(error.to_string(), "angle_range.most = 0.5: must be between 1.01 and 6.3");
}

/// The muscle held isometric at an angle, then at another nearby: the force changes as the
/// stiffness says.
fn stiffness_of<S: Scalar>(within: f64) {
    for (activation, path) in [(0.0, 0.184), (0.3, 0.15), (0.8, 0.15), (0.8, 0.165)] {
        let muscle =
            ContinuousMuscle::<S, 2>::build(&vm_nostd_cores::MUSCLE, TimeStep::MILLISECOND);
        let muscle = muscle.expect("a muscle");
        let held = |path: f64| {
            let input = Input {
                activation: S::from_f64(activation),
                path_length: S::path_length(path),
                stimulation_frequency: S::quantity(0.0),
            };
            let mut state = muscle.rest(input.path_length).expect("rest");
            for _ in 0..4000 {
                muscle.step(&mut state, input);
            }
            (muscle.observe(&state).relative_force.to_f64(), muscle.stiffness(&state).to_f64())
        };
        let step = 2e-4;
        let expected = (held(path + step).0 - held(path - step).0) / (2.0 * step) * 0.11;
        let found = held(path).1;
        let off = (found - expected).abs();
        assert!(off < within, "{activation} {path}: {found} F0/L_ce0, not {expected}");
    }
}

/// The difference over 1/64 L_ce0 stands for the slope: within 0.02 F0/L_ce0 where FL bends.
#[test]
fn stiffness_is_the_slope_of_the_steady_force() {
    stiffness_of::<f64>(0.02);
    stiffness_of::<f32>(0.03);
    stiffness_of::<Fixed>(0.04);
}

/// Turning the joint by a little changes the torque by its stiffness, in FES too.
#[test]
fn stiffness_of_a_joint_is_minus_the_slope_of_its_torque() {
    let muscles = ANKLE.muscles.map(|muscle| muscle.on_joint());
    let ankle = Joint::<f64, 1, 2>::build(&[ANKLE.range], &muscles).expect("an ankle");
    let built = ANKLE.muscles.map(|muscle| {
        FesMuscle::<f64, 2>::build(&muscle.params(), TimeStep::MILLISECOND).expect("a muscle")
    });
    let held = |angle: f64| {
        let posture = ankle.posture([angle]);
        let mut forces = [0.0; 2];
        let mut stiffnesses = [0.0; 2];
        for index in 0..2 {
            let input = Input {
                activation: [0.4, 0.1][index],
                path_length: posture.muscles[index].path_length,
                stimulation_frequency: 30.0,
            };
            let mut state = built[index].rest(input.path_length).expect("rest");
            for _ in 0..4000 {
                built[index].step(&mut state, input);
            }
            forces[index] = built[index].observe(&state).relative_force;
            stiffnesses[index] = built[index].stiffness(&state);
        }
        let [torque] = ankle.torques(&posture, &forces);
        let [stiffness] = ankle.stiffnesses(&posture, &forces, &stiffnesses);
        (torque, stiffness)
    };
    for angle in [-0.4, -0.1, 0.15] {
        let step = 2e-3;
        let expected = (held(angle - step).0 - held(angle + step).0) / (2.0 * step);
        let found = held(angle).1;
        assert!((found - expected).abs() < 0.02 * expected.abs() + 0.1, "{found} {expected}");
    }
}
