//! The neuromuscular prosthesis: envelopes, torque and stiffness against computations of their own
//! in `f64`, limits, bad inputs, saved states.

use std::f64::consts::PI;
use vm_nostd::control::{
    CommandLimits, Envelope, EnvelopeParams, KNEE, Prosthesis, ProsthesisInput, ProsthesisParams,
    ProsthesisState, ProsthesisStatus,
};
use vm_nostd::{ContinuousMuscle, Fixed, Input, RestoreError, Scalar, TimeStep};

const STEP: TimeStep = TimeStep::MILLISECOND;
const ENVELOPE: EnvelopeParams =
    EnvelopeParams { rest: 0.01, maximal: 0.51, cutoff_frequency: 4.0, delay: 0.0, shape: 0.0 };

/// The time constant of each lag: together they halve the power at the cutoff.
fn time_constant(cutoff: f64) -> f64 {
    (2.0_f64.sqrt() - 1.0).sqrt() / (2.0 * PI * cutoff)
}

fn envelope_of<S: Scalar>(params: &EnvelopeParams, samples: impl Iterator<Item = f64>) -> Vec<f64> {
    let envelope = Envelope::<S, 100>::build(params, STEP).expect("an envelope");
    let mut state = envelope.rested();
    samples.map(|mv| envelope.step(&mut state, S::quantity(mv)).0.to_f64()).collect()
}

fn follows<S: Scalar>(rounding: f64) {
    // A step of EMG of either sign: 1 - (1 + t/T) exp(-t/T) of the range; the second lag sees the
    // first at a tick's end, which makes it less than a tick early.
    let found =
        envelope_of::<S>(&ENVELOPE, (0..600).map(|k| if k % 2 == 0 { 0.26 } else { -0.26 }));
    let t = time_constant(4.0);
    let exact = |time: f64| 0.5 * (1.0 - (1.0 + time / t) * (-time / t).exp());
    for (tick, found) in found.iter().enumerate() {
        let time = (tick + 1) as f64 * 1e-3;
        assert!(*found >= exact(time) - rounding, "{rounding} {tick}: {found} {}", exact(time));
        assert!(*found <= exact(time + 1e-3) + rounding, "{tick}: {found} {}", exact(time + 1e-3));
    }
    // Modulated at the cutoff, the modulation passes with 1/√2.
    let found = envelope_of::<S>(
        &ENVELOPE,
        (0..2000).map(|k| 0.26 + 0.2 * (2.0 * PI * 4e-3 * f64::from(k)).sin()),
    );
    let (least, most) = found[1000..]
        .iter()
        .fold((f64::MAX, f64::MIN), |(least, most), &value| (least.min(value), most.max(value)));
    assert!(((most - least) / 0.8 - 0.5_f64.sqrt()).abs() < 0.01, "{least} {most}");
    // A rectified sine has a mean of 2/π.
    let found = envelope_of::<S>(&ENVELOPE, (0..2000).map(|k| 0.4 * (0.7 * f64::from(k)).sin()));
    let mean = (0.4 * 2.0 / PI - 0.01) / 0.5;
    assert!((found[1999] - mean).abs() < 0.01, "{} {mean}", found[1999]);
}

/// A lag stalls half an ULP over its share of a tick from its target: 8e-7 in `f32`, of which there
/// are two, and what is near them is rounded as much.
#[test]
fn envelopes_follow_the_rectified_emg() {
    follows::<f64>(1e-12);
    follows::<f32>(4e-6);
    // Samples have steps of 2^-16 mV.
    follows::<Fixed>(1.6e-5);
}

#[test]
fn envelopes_are_delayed_shaped_and_clipped() {
    let samples = || (0..500).map(|k| 0.3 * (0.37 * f64::from(k)).sin());
    let plain = envelope_of::<f32>(&ENVELOPE, samples());
    for delay in [1, 37, 100] {
        let params = EnvelopeParams { delay: f64::from(delay) * 1e-3, ..ENVELOPE };
        let delayed = envelope_of::<f32>(&params, samples());
        let delay = delay as usize;
        assert!(delayed[..delay].iter().all(|&value| value == 0.0));
        assert_eq!(delayed[delay..], plain[..500 - delay]);
    }
    let shape = -1.7_f64;
    let shaped = envelope_of::<f32>(&EnvelopeParams { shape, ..ENVELOPE }, samples());
    for (plain, shaped) in plain.iter().zip(shaped) {
        let exact = ((shape * plain).exp() - 1.0) / (shape.exp() - 1.0);
        assert!((shaped - exact).abs() < 1e-6, "{plain}: {shaped} {exact}");
    }
    // Beyond the greatest contraction, and an artefact.
    let full = envelope_of::<f32>(&ENVELOPE, (0..2000).map(|_| 0.6));
    assert_eq!(full[1999], 1.0);
    let envelope = Envelope::<f32, 0>::build(&ENVELOPE, STEP).expect("an envelope");
    let mut state = envelope.rested();
    for (sample, invalid) in [(3.9, false), (4.1, true), (f32::NAN, true), (f32::INFINITY, true)] {
        let (activation, flagged) = envelope.step(&mut state, sample);
        assert_eq!(flagged, invalid, "{sample}");
        assert!((0.0..=1.0).contains(&activation));
    }
}

#[test]
fn envelopes_are_refused_by_name() {
    let refused = |change: fn(&mut EnvelopeParams)| {
        let mut params = ENVELOPE;
        change(&mut params);
        Envelope::<f32, 100>::build(&params, STEP).expect_err("refused").field
    };
    assert_eq!(refused(|p| p.rest = -0.1), "envelope.rest");
    assert_eq!(refused(|p| p.maximal = 0.01), "envelope.maximal");
    assert_eq!(refused(|p| p.cutoff_frequency = f64::NAN), "envelope.cutoff_frequency");
    assert_eq!(refused(|p| p.delay = 0.101), "envelope.delay");
    assert_eq!(refused(|p| p.shape = -3.1), "envelope.shape");
}

fn params() -> ProsthesisParams<2> {
    ProsthesisParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        envelopes: [ENVELOPE, EnvelopeParams { shape: -1.0, delay: 0.03, ..ENVELOPE }],
        torque: CommandLimits { least: -400.0, most: 400.0, rate: 1e5 },
        stiffness: CommandLimits { least: 0.0, most: 2000.0, rate: 1e6 },
    }
}

/// EMG of both muscles (mV) and angle (rad) in a tick.
fn input<S: Scalar>(tick: i32) -> ProsthesisInput<S> {
    let time = f64::from(tick) * 1e-3;
    let noise = (f64::from(tick) * 2.399).sin();
    ProsthesisInput {
        emg: [0.4 * noise * (3.0 * time).sin().max(0.0), 0.7 * noise * (2.0 * time).cos().max(0.0)]
            .map(S::quantity),
        angle: S::from_f64(0.8 + 0.5 * (4.0 * time).sin()),
    }
}

/// Torque by the definitions: envelopes as recursions of `f64`, muscles in `f64`, arms as
/// published.
fn expected() -> Vec<f64> {
    let muscles =
        KNEE.muscles.map(|m| ContinuousMuscle::<f64, 2>::build(&m.params(), STEP).unwrap());
    let paths = KNEE.muscles.map(|m| m.path());
    let angle = |tick: i32| input::<f64>(tick).angle;
    let mut states = [0, 1].map(|i| muscles[i].rest(paths[i].length_at([angle(0)])).unwrap());
    let share = 1.0 - (-1e-3 / time_constant(4.0)).exp();
    let (mut lags, mut history) = ([[0.01; 2]; 2], [vec![], vec![]]);
    (0..3000)
        .map(|tick| {
            let input = input::<f64>(tick);
            let mut torque = 0.0;
            for i in 0..2 {
                lags[i][0] += share * (input.emg[i].abs() - lags[i][0]);
                lags[i][1] += share * (lags[i][0] - lags[i][1]);
                history[i].push(((lags[i][1] - 0.01) / 0.5_f64).clamp(0.0, 1.0));
                let activation = if i == 0 {
                    history[0][tick as usize]
                } else {
                    let late = if tick < 30 { 0.0 } else { history[1][tick as usize - 30] };
                    ((-late).exp() - 1.0) / ((-1.0_f64).exp() - 1.0)
                };
                let path_length = paths[i].length_at([input.angle]);
                let output = muscles[i].step(
                    &mut states[i],
                    Input { activation, path_length, stimulation_frequency: 0.0 },
                );
                let arm = [0.0293, -42.286e-3 + 6.0991e-3 * input.angle][i];
                torque += output.force * arm;
            }
            torque
        })
        .collect()
}

fn commands<S: Scalar>(params: &ProsthesisParams<2>) -> Vec<(f64, f64, ProsthesisStatus)> {
    let prosthesis = Prosthesis::<S, 2, 100>::build(params, STEP).expect("a prosthesis");
    let mut state = prosthesis.rest(input::<S>(0).angle).expect("rest");
    (0..3000)
        .map(|tick| {
            let command = prosthesis.step(&mut state, input(tick));
            (
                S::quantity_value(command.torque),
                S::quantity_value(command.stiffness),
                command.status,
            )
        })
        .collect()
}

/// Within 0.1 % of the muscles' greatest torque, 5,699 N at 4 cm: what `vm verify` promises of a
/// force.
#[test]
fn torque_is_that_of_the_antagonists() {
    let expected = expected();
    assert!(expected.iter().any(|t| *t < -50.0) && expected.iter().any(|t| *t > 2.0));
    for (name, found) in
        [("f32", commands::<f32>(&params())), ("fixed", commands::<Fixed>(&params()))]
    {
        for (tick, ((torque, _, status), expected)) in found.iter().zip(&expected).enumerate() {
            let off = (torque - expected).abs();
            assert!(off < 1e-3 * 5699.0 * 0.04, "{name} {tick}: {torque} {expected} N m");
            assert!(!status.contains(ProsthesisStatus::TORQUE_RATE_LIMITED), "{name} {tick}");
        }
    }
}

#[test]
fn commands_keep_their_limits_and_rates() {
    let mut params = params();
    params.torque = CommandLimits { least: -40.0, most: 5.0, rate: 100.0 };
    params.stiffness = CommandLimits { least: 10.0, most: 60.0, rate: 500.0 };
    let found = commands::<Fixed>(&params);
    let mut all = ProsthesisStatus::empty();
    for pair in found.windows(2) {
        assert!((pair[1].0 - pair[0].0).abs() <= 0.1 + 2e-4, "{pair:?}");
        assert!((pair[1].1 - pair[0].1).abs() <= 0.5 + 2e-4, "{pair:?}");
        assert!((-40.001..=5.001).contains(&pair[1].0) && (9.999..=60.001).contains(&pair[1].1));
        all |= pair[1].2;
    }
    let limits = ProsthesisStatus::TORQUE_LIMITED
        | ProsthesisStatus::TORQUE_RATE_LIMITED
        | ProsthesisStatus::STIFFNESS_LIMITED
        | ProsthesisStatus::STIFFNESS_RATE_LIMITED;
    assert!(all.contains(limits), "{all:?}");
}

#[test]
fn a_prosthesis_gets_stiffer_when_both_contract() {
    let prosthesis = Prosthesis::<f32, 2, 0>::build(
        &ProsthesisParams { envelopes: [ENVELOPE; 2], ..params() },
        STEP,
    )
    .expect("a prosthesis");
    let mut last = 0.0;
    for level in [0.05, 0.15, 0.3] {
        let mut state = prosthesis.rest(0.6).expect("rest");
        let emg = [level; 2];
        let held =
            (0..1500).map(|_| prosthesis.step(&mut state, ProsthesisInput { emg, angle: 0.6 }));
        let stiffness = held.last().expect("a tick").stiffness;
        assert!(stiffness > 1.3 * last, "{level} mV: {stiffness} N m/rad, after {last}");
        last = stiffness;
    }
}

#[test]
fn bad_samples_are_flagged_and_the_command_stays_finite() {
    let prosthesis = Prosthesis::<f32, 2, 100>::build(&params(), STEP).expect("a prosthesis");
    let mut state = prosthesis.rest(0.5).expect("rest");
    let bad = [f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30, f32::MIN_POSITIVE, 0.0];
    for tick in 0..4000_usize {
        let pick = |k: usize| bad[(tick * 7 + k * 5 + tick / 11) % bad.len()];
        let input = ProsthesisInput { emg: [pick(0), pick(1)], angle: pick(2) };
        let command = prosthesis.step(&mut state, input);
        assert!(command.torque.abs() <= 400.0 && (0.0..=2000.0).contains(&command.stiffness));
        let invalid = input.emg.iter().any(|emg| emg.is_nan() || emg.abs() >= 4.0);
        assert_eq!(command.status.contains(ProsthesisStatus::EMG_INVALID), invalid, "{input:?}");
        let lost = !input.angle.is_finite();
        assert_eq!(command.status.contains(ProsthesisStatus::ANGLE_NOT_FINITE), lost, "{input:?}");
    }
}

fn saved<S: Scalar>() {
    let prosthesis = Prosthesis::<S, 2, 40>::build(&params(), STEP).expect("a prosthesis");
    let mut state = prosthesis.rest(input::<S>(0).angle).expect("rest");
    for tick in 0..700 {
        prosthesis.step(&mut state, input(tick));
    }
    let words: Vec<S::Bits> = prosthesis.save(&state).collect();
    assert_eq!(words.len(), ProsthesisState::<S, 2, 40>::SAVED_WORDS);
    let mut restored = prosthesis.restore(words.iter().copied()).expect("a saved state");
    for tick in 700..900 {
        let [a, b] = [&mut state, &mut restored].map(|state| prosthesis.step(state, input(tick)));
        assert_eq!(a, b);
    }
    assert_eq!(state, restored);
    let short = prosthesis.restore(words[..words.len() - 1].iter().copied());
    assert_eq!(short.expect_err("short"), RestoreError::Length { expected: words.len() });
    let mut other = params();
    other.torque.rate = 2e5;
    let other = Prosthesis::<S, 2, 40>::build(&other, STEP).expect("a prosthesis");
    let refused = other.restore(words.iter().copied()).expect_err("another one's");
    assert!(matches!(refused, RestoreError::OtherMuscle { .. }), "{refused}");
    // The place in the delay line, counted from the state's start.
    let place = 2 * (size_of::<S::Wide>() / size_of::<S::Bits>()) + 40 + 1;
    let mut beyond = words;
    beyond[place] = S::Bits::from(41);
    assert_eq!(prosthesis.restore(beyond), Err(RestoreError::Value { word: place }));
}

#[test]
fn saved_states_continue_with_the_same_bits() {
    saved::<f32>();
    saved::<Fixed>();
}
