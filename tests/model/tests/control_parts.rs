//! Lead, feedback and estimate of the gain: the parts of the FES controller against closed forms.

use model_tests::knee::NONE;
use vm_nostd::control::*;
use vm_nostd::{Fixed, Scalar, TimeStep};

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
        let input = lead.step(&mut state, S::from_f64(0.5)).to_f64();
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
    let (mut gain, mut exact) = (S::ONE.wide(), 1.0_f64);
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
