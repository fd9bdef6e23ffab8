//! Envelopes at the ends of their parameters: noise at rest, little range, little shape.

use vm_nostd::control::{Envelope, EnvelopeParams};
use vm_nostd::{Fixed, Scalar, TimeStep};

const PLAIN: EnvelopeParams =
    EnvelopeParams { rest: 0.01, maximal: 0.51, cutoff_frequency: 20.0, delay: 0.0, shape: 0.0 };

/// The activation that a constant EMG (mV) is held at.
fn held<S: Scalar>(params: &EnvelopeParams, emg: f64) -> f64 {
    let envelope = Envelope::<S, 0>::build(params, TimeStep::MILLISECOND).expect("an envelope");
    let mut state = envelope.rested();
    let activation = |_| envelope.step(&mut state, S::quantity(emg)).0;
    (0..1000).map(activation).last().expect("a sample").to_f64()
}

/// Of noise at rest, too, there is a half and a whole: samples have steps of 1.5e-5 mV in fixed
/// point, of 1e-3 mV of range.
fn reaches<S: Scalar>(within: f64) {
    for (rest, maximal) in [(0.0, 10.0), (0.0, 1e-3), (0.02, 0.021), (1.0, 1.05), (9.0, 9.45)] {
        let params = EnvelopeParams { rest, maximal, ..PLAIN };
        for (share, emg) in [(0.0, rest), (0.5, 0.5 * (rest + maximal)), (1.0, maximal)] {
            let found = held::<S>(&params, emg);
            assert!((found - share).abs() < within, "{rest} {maximal} {emg} mV: {found}");
        }
    }
}

#[test]
fn noise_at_rest_leaves_the_whole_range() {
    reaches::<f64>(1e-9);
    reaches::<f32>(1e-3);
    reaches::<Fixed>(0.02);
}

#[test]
fn an_emg_that_drowns_in_noise_is_refused() {
    let refused = |rest, maximal| {
        let params = EnvelopeParams { rest, maximal, ..PLAIN };
        let error = Envelope::<f32, 0>::build(&params, TimeStep::MILLISECOND).expect_err("refused");
        (error.field, error.value)
    };
    assert_eq!(refused(9.1, 10.0), ("envelope.rest", 9.1));
    assert_eq!(refused(1.0, 1.04), ("envelope.maximal", 1.04));
}

/// Little shape is little different from none.
fn shaped<S: Scalar>(within: f64) {
    for shape in [-1e-7, -2e-6, -1e-4, -1e-3, -0.01, -0.0299, -0.03, -0.1, -3.0_f64] {
        let params = EnvelopeParams { shape, ..PLAIN };
        for share in [0.1, 0.25, 0.5, 0.9] {
            let found = held::<S>(&params, PLAIN.rest + 0.5 * share);
            let exact = (shape * share).exp_m1() / shape.exp_m1();
            assert!((found - exact).abs() < within, "{shape} {share}: {found} {exact}");
        }
    }
}

#[test]
fn the_shape_is_continuous_at_none() {
    shaped::<f64>(1e-5);
    shaped::<f32>(1e-5);
    // Samples have steps of 3e-5 of this range.
    shaped::<Fixed>(1e-4);
}
