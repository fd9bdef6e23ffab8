//! The FES controller and its parts against closed forms and computations of their own in `f64`.

use std::f64::consts::FRAC_PI_2;
use vm_nostd::control::{
    ANKLE, ControlStatus, FesController, FesControllerParams, GainEstimate, GainParams, Intervals,
    KNEE, Lead, LeadParams, Learnt, LimbParams, Measured, Modulation, Pi, PiParams, Saturated,
    Sensors, SteadyNatural, Target,
};
use vm_nostd::{
    ContinuousMuscle, Fatigue, FatigueParams, FesMuscle, Fixed, Input, MuscleParams,
    RecruitmentCurve, RecruitmentCurveParams, RestoreError, Scalar, Status, TimeStep,
};

const STEP: TimeStep = TimeStep::MILLISECOND;

/// A lead before the two lags that it cancels leaves two lags of its filter time.
fn cancels<S: Scalar>(rounding: f64) {
    let (lag, filter) = (0.06, 0.02);
    let params = LeadParams { rise_time: lag, fall_time: lag, filter_time: filter };
    let lead = Lead::<S>::build(&params, STEP).expect("a lead");
    let mut state = lead.rested();
    let (mut first, mut second) = (0.0, 0.0);
    // Two lags with a constant input for a tick: x = exp(-dt/T), exactly.
    let decay = (-1e-3_f64 / lag).exp();
    for tick in 1..=400 {
        let input = lead.step(&mut state, S::HALF).to_f64();
        let (a, b) = (first - input, second - input);
        second = input + (b + a * 1e-3 / lag) * decay;
        first = input + a * decay;
        let exact = |time: f64| 0.5 * (1.0 - (1.0 + time / filter) * (-time / filter).exp());
        let time = f64::from(tick) * 1e-3;
        // What the lead changes within a tick, its output does at the middle of ticks.
        let (least, most) = (exact(time - 1e-3) - rounding, exact(time + 1e-3) + rounding);
        assert!((least..=most).contains(&second), "{tick}: {second} {least} {most}");
    }
}

#[test]
fn leads_cancel_excitation() {
    // What a staircase leaves is of second order in the tick.
    cancels::<f64>(1e-6);
    cancels::<f32>(1e-5);
    cancels::<Fixed>(1e-5);
}

#[test]
fn leads_are_those_of_the_muscle_and_refused_by_name() {
    let muscle = ANKLE.muscles[0].params();
    let lead = LeadParams::of_muscle(&muscle, 30.0, 0.02);
    let rise: f64 = muscle
        .fibers
        .iter()
        .map(|f| {
            let t = &f.fiber_type;
            f.fraction
                * (t.excitation.rise
                    + t.excitation.rise_per_frequency * 30.0 / t.half_force_frequency)
        })
        .sum();
    assert!((lead.rise_time - rise).abs() < 1e-12);
    let slow = LeadParams { filter_time: 0.09 * lead.rise_time.max(lead.fall_time), ..lead };
    assert_eq!(Lead::<f32>::build(&slow, STEP).expect_err("too fast").field, "lead.filter_time");
}

const NONE: PiParams = PiParams {
    proportional: 0.0,
    integral: 0.0,
    derivative: 0.0,
    derivative_filter: 0.02,
    most: 40.0,
};

/// A ramp of the error: k_d slope (1 - exp(-t/T_d)), from the ticks' starts.
fn derivative<S: Scalar>(rounding: f64) {
    let params = PiParams { derivative: 3.0, ..NONE };
    let pi = Pi::<S>::build(&params, 1024.0, 1.0, STEP).expect("gains");
    let mut state = pi.rested();
    for tick in 0..300 {
        let time = f64::from(tick) * 1e-3;
        let error = S::from_f64(2.0 * time);
        let found = pi.step(&mut state, error, Saturated::default()).to_f64() * 1024.0;
        let exact = |time: f64| 3.0 * 2.0 * (1.0 - (-time / 0.02).exp());
        let (least, most) = (exact(time) - rounding, exact(time + 1e-3) * 1.05 + rounding);
        assert!((least..=most).contains(&found), "{tick}: {found} {least} {most}");
    }
}

/// Each tick's error is taken as constant: 5 % more, a tick over T_d, at most.
#[test]
fn the_derivative_is_filtered() {
    derivative::<f64>(1e-9);
    derivative::<f32>(0.02);
    derivative::<Fixed>(0.02);
}

fn feedback<S: Scalar>(rounding: f64) {
    let params = PiParams { proportional: 20.0, integral: 50.0, most: 30.0, ..NONE };
    let pi = Pi::<S>::build(&params, 1024.0, 1.0, STEP).expect("gains");
    let mut integral = pi.rested();
    let free = Saturated::default();
    let newton_metres = |output: S| output.to_f64() * 1024.0;
    for tick in 1..=1000 {
        let found = newton_metres(pi.step(&mut integral, S::from_f64(0.1), free));
        let exact = 2.0 + 50.0 * 0.1 * f64::from(tick) * 1e-3;
        assert!((found - exact).abs() < rounding, "{tick}: {found} {exact}");
    }
    // Saturated above, a positive error is not integrated; a negative one is, at once.
    let above = Saturated { above: true, below: false };
    let held = integral;
    for _ in 0..1000 {
        pi.step(&mut integral, S::from_f64(0.1), above);
    }
    assert_eq!(integral, held);
    pi.step(&mut integral, S::from_f64(-0.1), above);
    assert!(integral.integral() < held.integral());
    // Never beyond its limit.
    for _ in 0..20_000 {
        pi.step(&mut integral, S::from_f64(1.0), free);
    }
    let found = newton_metres(pi.step(&mut integral, S::ZERO, free));
    assert!((found - 30.0).abs() < rounding, "{found}");
}

/// 1,024 N m × 2^-24 of rounding, on each of a thousand sums in `f32`.
#[test]
fn feedback_is_proportional_and_integral_without_windup() {
    feedback::<f64>(1e-9);
    feedback::<f32>(2e-3);
    feedback::<Fixed>(2e-3);
}

fn learns<S: Scalar>(rounding: f64) {
    let params = GainParams { time: 2.0, least: 0.3, most: 2.0, excitation: 1.0 };
    let estimate = GainEstimate::<S>::build(&params, 1024.0, STEP).expect("an estimate");
    let number = |torque: f64| S::from_f64(torque / 1024.0);
    let (mut gain, mut exact) = (S::ONE.lag_state(), 1.0_f64);
    let (wanted, real) = (20.0, 0.6);
    for _ in 0..20_000 {
        // A feedback that makes the torque right: real (wanted/gain + p) = wanted.
        let p = wanted / real - wanted / S::of(gain).to_f64();
        let asked = number(wanted / real);
        assert_eq!(estimate.step(&mut gain, asked, number(p), false), Learnt::Moved);
        exact -= 1e-3 / 2.0 * (1.0 - real / exact);
        assert!(
            (S::of(gain).to_f64() - exact).abs() < rounding,
            "{} {exact}",
            S::of(gain).to_f64()
        );
    }
    assert!((exact - real).abs() < 1e-3);
    let held = gain;
    assert_eq!(estimate.step(&mut gain, number(0.9), number(0.5), false), Learnt::Frozen);
    assert_eq!(estimate.step(&mut gain, number(20.0), number(5.0), true), Learnt::Frozen);
    assert_eq!(gain, held);
    // A muscle that makes nothing: down to the limit, and refused there.
    let mut refused = false;
    for _ in 0..4_000 {
        refused |= estimate.step(&mut gain, number(20.0), number(20.0), false) == Learnt::Refused;
        assert!(S::of(gain).to_f64() >= 0.3 - 1e-6);
    }
    assert!(refused);
}

#[test]
fn the_gain_is_learnt_within_bounds_and_only_when_excited() {
    learns::<f64>(1e-12);
    learns::<f32>(1e-3);
    learns::<Fixed>(1e-3);
}

fn electrode() -> RecruitmentCurveParams {
    RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 2e-4, slope: 2.0 }
}

fn params() -> FesControllerParams<2> {
    FesControllerParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.35, damping: 0.5, gravity: 12.0, hanging_angle: FRAC_PI_2 },
        electrodes: [electrode(); 2],
        modulation: [Modulation::Width { amplitude: 0.04 }, Modulation::Amplitude { width: 3e-4 }],
        stimulation_frequency: 30.0,
        cocontraction: 1.0,
        measured: Measured::Angle,
        feedback: PiParams { proportional: 0.0, integral: 0.0, most: 40.0, ..NONE },
        expected_lag: 0.06,
        lead_filter_time: 0.03,
        fatigue: [Some(FatigueParams::QUADRICEPS); 2],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 1.0 }),
        torque: (-80.0, 60.0),
    }
}

fn still<S: Scalar>(angle: f64) -> Target<S> {
    Target {
        angle: S::from_f64(angle),
        velocity: S::ZERO,
        acceleration: S::ZERO,
        torque: S::quantity(0.0),
    }
}

fn sensed<S: Scalar>(angle: f64) -> Sensors<S> {
    Sensors { angle: S::from_f64(angle), torque: S::quantity(0.0) }
}

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

fn saved<S: Scalar>() {
    let mut with_feedback = params();
    with_feedback.feedback = PiParams { proportional: 30.0, integral: 60.0, most: 40.0, ..NONE };
    with_feedback.fatigue[0] = None;
    let controller = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    let mut state = controller.start(S::from_f64(0.5));
    let run = |state: &mut _, tick: i32| {
        let time = f64::from(tick) * 1e-3;
        controller.step(state, still(0.6 + 0.4 * time.sin()), sensed(0.6 + 0.3 * time.sin()))
    };
    for tick in 0..3000 {
        run(&mut state, tick);
    }
    let words: Vec<S::Bits> = controller.save(&state).collect();
    assert_eq!(words.len(), controller.saved_words());
    let mut restored = controller.restore(words.iter().copied()).expect("a saved state");
    for tick in 3000..3500 {
        assert_eq!(run(&mut state, tick), run(&mut restored, tick));
    }
    assert_eq!(state, restored);
    let short = controller.restore(words[1..].iter().copied());
    assert!(matches!(short, Err(RestoreError::OtherMuscle { .. })), "{short:?}");
    let short = controller.restore(words[..words.len() - 1].iter().copied());
    assert_eq!(short, Err(RestoreError::Length { expected: words.len() }));
    with_feedback.feedback.integral = 61.0;
    let other = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    assert!(other.restore(words.iter().copied()).is_err());
    // What only the inverse knows of a muscle.
    with_feedback.feedback.integral = 60.0;
    with_feedback.muscles[1].fibers[0].fiber_type.force_length.width *= 1.01;
    let other = FesController::<S, 2>::build(&with_feedback, STEP).expect("a controller");
    assert_ne!(other.checksum(), controller.checksum());
    let refused = other.restore(words.iter().copied());
    assert!(matches!(refused, Err(RestoreError::OtherMuscle { .. })), "{refused:?}");
    let mut beyond = words;
    beyond[2] = S::from_f64(2.0).to_bits();
    assert_eq!(controller.restore(beyond), Err(RestoreError::Value { word: 2 }));
}

#[test]
fn saved_states_continue_with_the_same_bits() {
    saved::<f32>();
    saved::<Fixed>();
}

/// A small change of any parameter changes the checksum of the coefficients, also of what only the
/// muscles' inverse has; and every tick that of the state.
#[test]
fn checksums_cover_controller_and_state() {
    let sum = |params: &FesControllerParams<2>| {
        FesController::<f32, 2>::build(params, STEP).expect("a controller").checksum()
    };
    let of_types: [fn(&mut vm_nostd::FiberType); 4] = [
        |t| t.activation.scale *= 1.01,
        |t| t.force_length.width *= 1.01,
        |t| t.half_force_frequency *= 1.01,
        |t| t.excitation.rise *= 1.01,
    ];
    for change in of_types {
        let mut changed = params();
        change(&mut changed.muscles[1].fibers[0].fiber_type);
        assert_ne!(sum(&params()), sum(&changed));
    }
    let of_controllers: [fn(&mut FesControllerParams<2>); 7] = [
        |p| p.muscles[0].elements.tendon.stiffness *= 1.01,
        |p| p.muscles[0].elements.parallel.stiffness *= 1.01,
        |p| p.electrodes[1].slope *= 1.01,
        |p| p.limb.gravity += 0.1,
        |p| p.cocontraction += 0.1,
        |p| p.stimulation_frequency += 0.1,
        |p| p.feedback.proportional += 0.1,
    ];
    for change in of_controllers {
        let mut changed = params();
        change(&mut changed);
        assert_ne!(sum(&params()), sum(&changed));
    }
    let controller = FesController::<f32, 2>::build(&params(), STEP).expect("a controller");
    let mut state = controller.start(0.5);
    let before = (state.checksum(), state.words().count());
    controller.step(&mut state, still(0.6), sensed(0.5));
    assert_ne!(state.checksum(), before.0);
    assert_eq!(state.words().count(), before.1);
}

/// The muscle of the model, held at the activation that the inverse names, has the wanted force.
fn natural<S: Scalar>(within: f64) {
    for muscle in [vm_nostd_cores::MUSCLE, KNEE.muscles[1].params(), ANKLE.muscles[0].params()] {
        let inverse = SteadyNatural::<S, 2>::build(&muscle).expect("an inverse");
        let model = ContinuousMuscle::<f64, 2>::build(&muscle, STEP).expect("a muscle");
        let optimum = muscle.fascicle_length + muscle.tendon_length;
        for (force, path) in
            [(0.02, optimum), (0.3, optimum), (0.6, 0.97 * optimum), (0.8, optimum)]
        {
            let (activation, status) =
                inverse.nearest_activation(S::from_f64(force), S::path_length(path));
            assert!(status.is_empty(), "{force} {status:?}");
            let mut state = model.rest(path).expect("rest");
            let activation = activation.to_f64();
            let input = Input { activation, path_length: path, stimulation_frequency: 0.0 };
            let held = (0..6000).map(|_| model.step(&mut state, input)).last().expect("a tick");
            let off = (held.relative_force - force).abs();
            assert!(off < within, "{force} F0 at {path} m: {activation}, off by {off}");
        }
        let (most, status) = inverse.nearest_activation(S::from_f64(1.5), S::path_length(optimum));
        assert_eq!((most.to_f64(), status), (1.0, Status::FORCE_UNREACHABLE));
        let (least, status) = inverse.nearest_activation(S::ZERO, S::path_length(optimum));
        assert_eq!((least, status), (S::ZERO, Status::empty()));
    }
}

/// 0.1 % of F0, as the model promises.
#[test]
fn the_natural_inverse_holds_the_force() {
    natural::<f64>(1e-3);
    natural::<f32>(1e-3);
    natural::<Fixed>(1e-3);
}

fn frequencies<S: Scalar>(pulses: &[u32], ticks: u32) -> Vec<f64> {
    let intervals = Intervals::<S>::build(Intervals::<S>::PAUSE, STEP).expect("a pause");
    let mut state = intervals.silent();
    (0..ticks)
        .map(|tick| S::quantity_value(intervals.step(&mut state, pulses.contains(&tick))))
        .collect()
}

/// The rule, pulse by pulse, in whole ms.
fn rule(pulses: &[u32], ticks: u32) -> Vec<f64> {
    (0..ticks)
        .map(|tick| {
            let past: Vec<u32> = pulses.iter().copied().filter(|&pulse| pulse <= tick).collect();
            let [.., before, last] = past[..] else { return 0.0 };
            let (interval, since) = (last - before, tick - last);
            if interval >= 500 || since >= 500 {
                return 0.0;
            }
            (1000.0 / f64::from(interval.max(since))).min(500.0)
        })
        .collect()
}

#[test]
fn intervals_become_frequencies_by_the_rule() {
    let train: Vec<u32> = (0..20).map(|k| 100 + 50 * k).collect();
    let doublet: Vec<u32> = [100, 105].into_iter().chain((1..20).map(|k| 105 + 80 * k)).collect();
    let odd = [10, 11, 12, 300, 900, 1399, 1400, 1420, 1500, 2100];
    for pulses in [&train[..], &doublet, &odd] {
        let exact = rule(pulses, 3000);
        for (name, found) in [
            ("f32", frequencies::<f32>(pulses, 3000)),
            ("fixed", frequencies::<Fixed>(pulses, 3000)),
        ] {
            for (tick, (found, exact)) in found.iter().zip(&exact).enumerate() {
                let off = (found - exact).abs();
                // Sums of 500 rounded ticks.
                assert!(off <= 2e-4 * exact, "{name} {tick}: {found} {exact} pps");
            }
        }
    }
}

/// A doublet at the start of a train makes force rise faster, as published; a train of equal
/// intervals is that of its frequency once it has two pulses.
#[test]
fn a_doublet_makes_the_force_rise_faster() {
    let muscle = FesMuscle::<f64, 2>::build(&vm_nostd_cores::MUSCLE, STEP).expect("a muscle");
    let force = |frequencies: &[f64]| -> Vec<f64> {
        let mut state = muscle.rest(0.16).expect("rest");
        frequencies
            .iter()
            .map(|&stimulation_frequency| {
                let activation = f64::from(u8::from(stimulation_frequency > 0.0));
                let input = Input { activation, path_length: 0.16, stimulation_frequency };
                muscle.step(&mut state, input).force
            })
            .collect()
    };
    let constant: Vec<u32> = (0..13).map(|k| 80 * k).collect();
    let doublet: Vec<u32> = [0, 5].into_iter().chain((1..13).map(|k| 5 + 80 * k)).collect();
    let [constant, doublet] = [constant, doublet].map(|p| force(&frequencies::<f64>(&p, 1000)));
    let sum = |force: &[f64], most: usize| force[..most].iter().sum::<f64>();
    assert!(sum(&doublet, 200) > 1.5 * sum(&constant, 200));
    // Not claimed, and not so: that it stays higher.
    assert!((doublet[999] / constant[999] - 1.0).abs() < 0.02);
    let periodic = force(&[&[0.0; 80][..], &[12.5; 920][..]].concat());
    // To the rounding of the reciprocal of a sum of ticks.
    for (tick, (periodic, constant)) in periodic.iter().zip(&constant).enumerate() {
        assert!((periodic - constant).abs() < 1e-9, "{tick}: {periodic} {constant} N");
    }
}
