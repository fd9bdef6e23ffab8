//! Joints of little and of much range.

use vm_nostd::control::{
    Action, AngleRange, FesController, FesControllerParams, Joint, JointMuscle, KNEE, LimbParams,
    Measured, Modulation, PathParams, PiParams, Sensors, Target,
};
use vm_nostd::{Fixed, Limit, RecruitmentCurveParams, Scalar, TimeStep};

/// At the ends of a range the share of it is 1, which fixed point must not reach.
fn ends<S: Scalar>(within: f64) {
    for width in [0.01, 0.02, 0.05, 0.1, 0.3, 1.0] {
        for tenth in -60..=52 {
            // Ends that no arithmetic has exactly.
            let least = 0.1 * f64::from(tenth) + 1.0 / 97.0;
            let range = AngleRange { least, most: least + width };
            let path = PathParams {
                length: 0.5,
                reference: [least],
                terms: [[-0.04, 0.0, 0.0, 0.0, 0.0, 0.0]],
                product: 0.0,
                action: [Action::Flexes],
            };
            let muscle = JointMuscle {
                path,
                path_domain: (0.4, 0.6),
                max_isometric_force: 1000.0,
                fascicle_length: 0.1,
            };
            let joint = Joint::<S, 1, 1>::build(&[range], &[muscle]).expect("a joint");
            for angle in [range.least - 1.0, range.most + 1.0] {
                let found = &joint.posture([S::from_f64(angle)]).muscles[0].path_length;
                let exact = path.length_at([angle.clamp(range.least, range.most)]);
                let off = (S::path_metres(*found) - exact).abs();
                assert!(off < within, "{range:?} at {angle}: off by {off:e} m");
            }
        }
    }
}

#[test]
fn narrow_ranges_have_two_ends() {
    ends::<f64>(1e-12);
    ends::<f32>(1e-7);
    ends::<Fixed>(1e-7);
}

const ELECTRODE: RecruitmentCurveParams =
    RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 2e-4, slope: 2.0 };

/// A controller whose muscles have arms of a constant length over any range.
fn wide(width: f64, gravity: f64) -> FesControllerParams<2> {
    let muscles = KNEE.muscles.map(|muscle| muscle.params());
    let path = |index: usize, arm: f64, action| {
        let muscle = &muscles[index];
        let length = muscle.fascicle_length + muscle.tendon_length;
        let terms = [[-arm, 0.0, 0.0, 0.0, 0.0, 0.0]];
        PathParams { length, reference: [0.0], terms, product: 0.0, action: [action] }
    };
    FesControllerParams {
        range: AngleRange { least: -0.5 * width, most: 0.5 * width },
        muscles,
        paths: [path(0, 5e-3, Action::Flexes), path(1, -5e-3, Action::Extends)],
        limb: LimbParams { inertia: 0.0, damping: 0.0, gravity, hanging_angle: 0.3 },
        electrodes: [ELECTRODE; 2],
        modulation: [Modulation::Width { amplitude: 0.04 }; 2],
        stimulation_frequency: 30.0,
        cocontraction: 0.0,
        measured: Measured::Angle,
        feedback: PiParams {
            proportional: 0.0,
            integral: 0.0,
            derivative: 0.0,
            derivative_filter: 0.02,
            most: 0.0,
        },
        expected_lag: 0.06,
        lead_filter_time: 0.03,
        fatigue: [None; 2],
        least_fitness: 0.3,
        gain: None,
        torque: (-300.0, 300.0),
    }
}

/// What the limb's weight is fed forward with is G sin(q - q_hang), or the range is refused.
#[test]
fn gravity_is_a_sine_over_the_whole_range() {
    let step = TimeStep::MILLISECOND;
    for width in [0.5, 2.5, 4.0] {
        let params = wide(width, 20.0);
        let controller = FesController::<f64, 2>::build(&params, step).expect("a controller");
        for angle in [-0.5 * width, 0.1, 0.5 * width] {
            let mut state = controller.start(angle);
            let target = Target { angle, velocity: 0.0, acceleration: 0.0, torque: 0.0 };
            let command = controller.step(&mut state, target, Sensors { angle, torque: 0.0 });
            let exact = 20.0 * (angle - 0.3).sin();
            assert!((command.torque - exact).abs() < 20.0 * 3e-4, "{width} {angle}: {command:?}");
        }
    }
    let params = wide(4.1, 20.0);
    let AngleRange { least, .. } = params.range;
    let error = FesController::<f64, 2>::build(&params, step).expect_err("refused");
    assert_eq!((error.muscle, error.error.field), (None, "angle_range.most"));
    assert_eq!(error.error.limit, Limit::Within { least, most: least + 4.0 });
    assert!(FesController::<f64, 2>::build(&wide(12.6, 0.0), step).is_ok());
}
