//! The FES controller against closed forms and computations of their own in `f64`.

use model_tests::knee::*;
use std::f64::consts::FRAC_PI_2;
use vm_nostd::control::*;
use vm_nostd::*;

const STEP: TimeStep = TimeStep::MILLISECOND;

/// Without feedback the torque is that of the motion.
fn forward<S: Scalar>(rounding: f64) {
    let controller = FesController::<S, 2>::build(&params(), STEP).expect("a controller");
    for (q, v, a) in [(0.0, 0.0, 0.0), (0.4, 1.0, 0.0), (1.2, -2.0, 30.0), (1.7, 0.0, -40.0)] {
        let mut state = controller.start(S::from_f64(q));
        let target = Target { velocity: S::from_f64(v), acceleration: S::from_f64(a), ..still(q) };
        let command = controller.step(&mut state, target, sensed(q));
        let exact: f64 = 0.35 * a + 0.5 * v + 12.0 * (q - FRAC_PI_2).sin();
        let found = S::quantity_value(command.torque);
        assert!((found - exact).abs() < rounding, "{q} {v} {a}: {found} {exact} N m");
    }
}

/// The sine's series leaves 1e-7 of G in this range; the unit of torque has 6e-5 N m.
#[test]
fn the_torque_of_a_motion_is_fed_forward() {
    forward::<f64>(2e-6);
    forward::<f32>(3e-4);
    forward::<Fixed>(2e-3);
}

/// The muscles of the model in `f64`, held at an angle and tiring as the model says, make the
/// torque that the controller asked for.
fn makes_the_torque<S: Scalar>(gain: f64, seconds: i32) {
    let params = FesControllerParams { gain: None, ..params() };
    let controller = FesController::<S, 2>::build(&params, STEP).expect("a controller");
    let angle = 0.7;
    let mut state = controller.start(S::from_f64(angle));
    let muscles = params.muscles.map(|muscle| FesMuscle::<f64, 2>::build(&muscle, STEP).unwrap());
    let paths = params.paths.map(|path| path.length_at([angle]));
    let mut states = [0, 1].map(|i| muscles[i].rest(paths[i]).unwrap());
    let fatigue = Fatigue::<f64>::build(&FatigueParams::QUADRICEPS, STEP).unwrap();
    let mut tired = [fatigue.rested(); 2];
    let mut torque = 0.0;
    let mut asked = 0.0;
    for _ in 0..seconds * 1000 {
        let command = controller.step(&mut state, still(0.2), sensed(angle));
        assert!(!command.status.contains(ControlStatus::UNREACHABLE), "{command:?}");
        asked = S::quantity_value(command.torque);
        torque = 0.0;
        for i in 0..2 {
            let activation = command.activations[i].to_f64();
            let fitness = fatigue.advance(&mut tired[i], activation, 30.0);
            let input = Input { activation, path_length: paths[i], stimulation_frequency: 30.0 };
            let output = muscles[i].step(&mut states[i], input).fatigued(fitness);
            let arm = [0.0293, -42.286e-3 + 6.0991e-3 * angle][i];
            torque += gain * output.force * arm;
        }
    }
    let exact = 12.0 * (0.2_f64 - FRAC_PI_2).sin();
    assert!((asked - exact).abs() < 0.01, "{asked} {exact}");
    // 0.1 % of F0 of the stronger muscle, which is what the inverse promises.
    assert!((torque - gain * exact).abs() < 1e-3 * 5699.0 * 0.042, "{torque} {exact} N m");
}

#[test]
fn the_inverse_makes_the_torque_and_makes_up_for_fatigue() {
    for seconds in [2, 40] {
        makes_the_torque::<f32>(1.0, seconds);
        makes_the_torque::<Fixed>(1.0, seconds);
    }
}

/// Fatigue is made up for in the feed-forward alone: feedback asks the same of tired muscles, so
/// that a patient who tires less than the model says does not oscillate.
#[test]
fn fatigue_leaves_the_gain_of_the_loop() {
    let after_40_s = |fatigue| {
        let params = FesControllerParams {
            limb: LimbParams { gravity: 0.0, ..params().limb },
            cocontraction: 0.0,
            feedback: PiParams { proportional: 60.0, ..params().feedback },
            muscles: params().muscles.map(|m| MuscleParams { mass: 0.1 * m.mass, ..m }),
            gain: None,
            fatigue,
            ..params()
        };
        let controller = FesController::<f32, 2>::build(&params, STEP).expect("a controller");
        let mut state = controller.start(0.7);
        let step = |_| controller.step(&mut state, still(0.5), sensed(0.7)).activations;
        (0..40_000).map(step).last().expect("a command")
    };
    let [untired, tired] = [None, Some(FatigueParams::QUADRICEPS)].map(|f| after_40_s([f; 2]));
    assert_eq!(untired, tired);
    assert!(tired[1] > 0.1, "{tired:?}");
}

#[test]
fn pulses_recruit_the_activation() {
    let controller = FesController::<f64, 2>::build(&params(), STEP).expect("a controller");
    let mut state = controller.start(0.7);
    let curve = RecruitmentCurve::<f64>::build(&electrode()).expect("a curve");
    for tick in 0..3000 {
        let target = still(0.6 + 0.5 * (f64::from(tick) * 2e-3).sin());
        let command = controller.step(&mut state, target, sensed(0.7));
        assert_eq!(command.pulses[0].amplitude, 40.0);
        assert!((command.pulses[1].width - 300.0).abs() < 1e-9);
        for (pulse, activation) in command.pulses.into_iter().zip(command.activations) {
            let (recruited, _) = curve.activation(pulse);
            assert!((recruited - activation).abs() < 1e-9, "{pulse:?} {activation}");
        }
    }
}

/// Torque feedback finds the gain of a muscle that is weaker than the model, and the torque.
#[test]
fn torque_is_controlled_with_an_unknown_gain() {
    for real in [0.6, 1.4] {
        let params = FesControllerParams {
            measured: Measured::Torque,
            feedback: PiParams { proportional: 0.3, integral: 2.0, most: 40.0, ..NONE },
            fatigue: [None; 2],
            gain: Some(GainParams { time: 2.0, least: 0.3, most: 2.0, excitation: 1.0 }),
            ..params()
        };
        let controller = FesController::<f32, 2>::build(&params, STEP).expect("a controller");
        let muscles = params.muscles.map(|m| FesMuscle::<f64, 2>::build(&m, STEP).unwrap());
        let paths = params.paths.map(|path| path.length_at([0.7]));
        let mut states = [0, 1].map(|i| muscles[i].rest(paths[i]).unwrap());
        let mut state = controller.start(0.7);
        let (mut measured, mut gain) = (0.0, 0.0);
        for _ in 0..20_000 {
            let target = Target { torque: -20.0, ..still(0.7) };
            let sensors = Sensors { angle: 0.7, torque: measured as f32 };
            let command = controller.step(&mut state, target, sensors);
            gain = command.gain;
            measured = (0..2)
                .map(|i| {
                    let activation = command.activations[i].into();
                    let input =
                        Input { activation, path_length: paths[i], stimulation_frequency: 30.0 };
                    let force = muscles[i].step(&mut states[i], input).force;
                    real * force * [0.0293, -42.286e-3 + 6.0991e-3 * 0.7][i]
                })
                .sum();
        }
        assert!((measured + 20.0).abs() < 0.1, "{real}: {measured} N m");
        assert!((f64::from(gain) - real).abs() < 0.01 * real, "{real}: {gain}");
    }
}

#[test]
fn bad_inputs_are_flagged_and_commands_stay_in_range() {
    let params = FesControllerParams {
        feedback: PiParams { proportional: 100.0, integral: 100.0, most: 40.0, ..NONE },
        ..params()
    };
    let controller = FesController::<f32, 2>::build(&params, STEP).expect("a controller");
    let mut state = controller.start(0.5);
    let bad = [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30, -1.0, 0.5, f32::MIN_POSITIVE];
    for tick in 0..5000_usize {
        let pick = |k: usize| bad[(tick * 7 + k * 3 + tick / 13) % bad.len()];
        let target =
            Target { angle: pick(0), velocity: pick(1), acceleration: pick(2), torque: pick(3) };
        let sensors = Sensors { angle: pick(4), torque: pick(5) };
        let command = controller.step(&mut state, target, sensors);
        let lost = command.status.contains(ControlStatus::MEASURED_NOT_FINITE);
        assert_eq!(lost, !sensors.angle.is_finite());
        for activation in command.activations {
            assert!((0.0..=1.0).contains(&activation), "{target:?} {sensors:?}");
        }
        assert!((-80.0..=60.0).contains(&command.torque) && command.gain.is_finite());
    }
    let out = controller.step(&mut state, still(9.0), sensed(9.0));
    assert!(out.status.contains(ControlStatus::TARGET_INVALID | ControlStatus::MEASURED_CLIPPED));
}

#[test]
fn controllers_are_refused_by_name() {
    let refused = |change: fn(&mut FesControllerParams<2>)| {
        let mut bad = params();
        change(&mut bad);
        let error = FesController::<f32, 2>::build(&bad, STEP).expect_err("refused");
        (error.muscle, error.error.field)
    };
    assert_eq!(refused(|p| p.stimulation_frequency = 0.5), (None, "stimulation_frequency"));
    assert_eq!(refused(|p| p.cocontraction = f64::NAN), (None, "cocontraction"));
    assert_eq!(refused(|p| p.expected_lag = 0.0), (None, "expected_lag"));
    assert_eq!(refused(|p| p.least_fitness = 0.0), (None, "least_fitness"));
    assert_eq!(refused(|p| p.torque.1 = -1.0), (None, "torque.1"));
    assert_eq!(refused(|p| p.limb.inertia = -1.0), (None, "limb.inertia"));
    assert_eq!(refused(|p| p.feedback.integral = 2e4), (None, "pi.integral"));
    assert_eq!(refused(|p| p.lead_filter_time = 1e-3), (Some(0), "lead.filter_time"));
    assert_eq!(refused(|p| p.electrodes[1].slope = 0.0), (Some(1), "slope"));
    assert_eq!(
        refused(|p| p.modulation[1] = Modulation::Width { amplitude: 1.0 }),
        (Some(1), "modulation.amplitude")
    );
    assert_eq!(refused(|p| p.muscles[1].mass = 0.0), (Some(1), "mass"));
}

/// A muscle that is not wanted has no activation, and so no pulses at its threshold, in any
/// arithmetic: what is left in the lead is no reason to stimulate.
fn leaves_the_antagonist<S: Scalar>() {
    let params = FesControllerParams { cocontraction: 0.0, ..params() };
    let controller = FesController::<S, 2>::build(&params, STEP).expect("a controller");
    let mut state = controller.start(S::from_f64(0.7));
    let of = |torque| Target { torque: S::quantity(torque), ..still(0.7) };
    // Against gravity (-9.2 N m) and with it: each muscle in turn.
    for (torque, unwanted) in [(40.0, 1), (-40.0, 0), (40.0, 1)] {
        for tick in 0..2000 {
            let command = controller.step(&mut state, of(torque), sensed(0.7));
            if tick >= 500 {
                assert_eq!(command.activations[unwanted], S::ZERO, "{torque} N m, tick {tick}");
                assert!(command.activations[1 - unwanted] > S::ZERO);
            }
        }
    }
}

#[test]
fn a_muscle_that_is_not_wanted_is_not_stimulated() {
    leaves_the_antagonist::<Fixed>();
    leaves_the_antagonist::<f64>();
    leaves_the_antagonist::<f32>();
}
