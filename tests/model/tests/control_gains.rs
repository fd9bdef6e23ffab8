//! Gains of the feedback and of the estimate at the ends of their ranges and beyond, and what the
//! parts do with numbers that no controller gives them.

use vm_nostd::control::{
    FesController, FesControllerParams, GainEstimate, GainParams, KNEE, Learnt, LimbParams,
    Measured, Modulation, Pi, PiParams, Saturated,
};
use vm_nostd::{Fixed, Limit, ParameterError, RecruitmentCurveParams, Scalar, TimeStep};

const STEP: TimeStep = TimeStep::MILLISECOND;
const GAINS: PiParams = PiParams {
    proportional: 10.0,
    integral: 5.0,
    derivative: 2.0,
    derivative_filter: 0.02,
    most: 40.0,
};
const ESTIMATE: GainParams = GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 1.0 };

/// Whatever the error was, afterwards feedback is what the error is.
fn recovers<S: Scalar>() {
    let pi = Pi::<S>::build(&GAINS, 1024.0, 1.0, STEP).expect("gains");
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 3e38, -3e38] {
        let mut state = pi.rested();
        let bounded = |output: S| output.to_f64().abs() < 128.0;
        assert!(bounded(pi.step(&mut state, S::from_f64(bad), Saturated::default())), "{bad}");
        for _ in 0..1000 {
            pi.step(&mut state, S::ZERO, Saturated::default());
        }
        let rest = pi.step(&mut state, S::ZERO, Saturated::default());
        assert_eq!(rest, state.integral(), "{bad}");
        assert!(rest.to_f64().abs() <= 40.0 / 1024.0, "{bad}: {rest:?}");
    }
}

#[test]
fn feedback_forgets_a_bad_error() {
    recovers::<f64>();
    recovers::<f32>();
    recovers::<Fixed>();
}

/// Feedback of a torque counts in the unit of its output: coefficients are the gains themselves,
/// which saturate in fixed point.
#[test]
fn fixed_point_refuses_gains_that_it_cannot_hold() {
    let refused = |gains: PiParams| {
        Pi::<f32>::build(&gains, 1024.0, 1024.0, STEP).expect("floating point holds it");
        Pi::<Fixed>::build(&gains, 1024.0, 1024.0, STEP).expect_err("refused")
    };
    let within = |field, value, most| {
        let limit = Limit::Within { least: 0.0, most };
        ParameterError { field, fiber: None, value, limit }
    };
    let gains = PiParams { proportional: 60.1, ..GAINS };
    assert_eq!(refused(gains), within("pi.proportional", 60.1, 60.0));
    let gains = PiParams { integral: 300.0, ..GAINS };
    assert_eq!(refused(gains), within("pi.integral", 300.0, 60.0 / 0.256));
    let gains = PiParams { derivative: 1.3, ..GAINS };
    assert_eq!(refused(gains), within("pi.derivative", 1.3, 60.0 * 0.02));
    // Of angles all gains fit.
    let most = PiParams {
        proportional: 1e3,
        integral: 1e4,
        derivative: 100.0,
        derivative_filter: 5e-3,
        most: 1e3,
    };
    for seconds in [TimeStep::SHORTEST, TimeStep::LONGEST] {
        let step = TimeStep::from_seconds(seconds).expect("in range");
        Pi::<Fixed>::build(&most, 1024.0, 1.0, step).expect("gains of angles");
    }
}

#[test]
fn units_are_refused_by_name() {
    for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Pi::<f32>::build(&GAINS, unit, 1.0, STEP).expect_err("refused");
        assert_eq!(error.field, "pi: unit of the output, N m");
        let error = Pi::<f32>::build(&GAINS, 1.0, unit, STEP).expect_err("refused");
        assert_eq!(error.field, "pi: unit of the error");
        let error = GainEstimate::<f32>::build(&ESTIMATE, unit, STEP).expect_err("refused");
        assert_eq!(error.field, "gain: unit of torques, N m");
    }
}

#[test]
fn nothing_is_learnt_from_what_is_no_number() {
    let estimate = GainEstimate::<f32>::build(&ESTIMATE, 1024.0, STEP).expect("an estimate");
    let mut gain = 1.0;
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(estimate.step(&mut gain, 0.1, bad, false), Learnt::Refused);
        assert_eq!(estimate.step(&mut gain, bad, 0.1, false), Learnt::Refused);
    }
    assert_eq!(gain, 1.0);
}

/// An estimate that is built moves: one so slow that `f32` loses a tick's change is refused.
fn moves<S: Scalar>(time: f64, seconds: f64) -> Result<bool, &'static str> {
    let step = TimeStep::from_seconds(seconds).expect("in range");
    let params = GainParams { time, ..ESTIMATE };
    let estimate = GainEstimate::<S>::build(&params, 1024.0, step).map_err(|error| error.field)?;
    let mut gain = S::from_f64(1.9).wide();
    for _ in 0..1000 {
        estimate.step(&mut gain, S::from_f64(0.1), S::from_f64(-0.0051), false);
    }
    Ok(S::of(gain).to_f64() > 1.9 + 0.02 * 1000.0 * seconds / time)
}

#[test]
fn an_estimate_moves_or_is_refused() {
    assert_eq!(moves::<f32>(400.0, 1e-3), Ok(true));
    assert_eq!(moves::<f32>(40.0, 1e-4), Ok(true));
    assert_eq!(moves::<f32>(1000.0, 1e-3), Err("gain.time"));
    assert_eq!(moves::<f32>(42.5, 1e-4), Err("gain.time"));
    for seconds in [1e-4, 1e-3, 2e-3] {
        assert_eq!(moves::<f64>(1000.0, seconds), Ok(true));
        assert_eq!(moves::<Fixed>(1000.0, seconds), Ok(true));
    }
}

/// The recruitment curve clips amplitudes to 100 times saturation: a greater one would come with a
/// width that was computed for what it was clipped to.
#[test]
fn the_constant_amplitude_is_one_of_the_electrode() {
    let electrode =
        RecruitmentCurveParams { threshold: 1e-5, saturation: 1e-3, chronaxie: 2e-4, slope: 2.0 };
    let build = |amplitude| {
        let params = FesControllerParams::<2> {
            range: KNEE.range,
            muscles: KNEE.muscles.map(|muscle| muscle.params()),
            paths: KNEE.muscles.map(|muscle| muscle.path()),
            limb: LimbParams { inertia: 0.35, damping: 0.5, gravity: 12.0, hanging_angle: 1.57 },
            electrodes: [electrode; 2],
            modulation: [Modulation::Amplitude { width: 3e-4 }, Modulation::Width { amplitude }],
            stimulation_frequency: 30.0,
            cocontraction: 1.0,
            measured: Measured::Angle,
            feedback: GAINS,
            expected_lag: 0.06,
            lead_filter_time: 0.03,
            fatigue: [None; 2],
            least_fitness: 0.3,
            gain: None,
            torque: (-80.0, 60.0),
        };
        FesController::<f32, 2>::build(&params, STEP)
    };
    assert!(build(0.1).is_ok());
    let error = build(0.101).expect_err("refused");
    assert_eq!((error.muscle, error.error.field), (Some(1), "modulation.amplitude"));
    assert_eq!(error.error.limit, Limit::Within { least: 1e-4, most: 0.1 });
}
