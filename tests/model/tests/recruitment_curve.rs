//! The recruitment curve in `f32` and fixed point, against its equations in `f64`.

use model_tests::muscles::config;
use proptest::prelude::*;
use vm_nostd::{Fixed, Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams, Scalar};

/// U of a pulse (mA, µs), from the equations.
fn exact(p: &RecruitmentCurveParams, amplitude: f64, width: f64) -> f64 {
    let strength = amplitude * 1e-3 * width / (width + p.chronaxie * 1e6);
    let x = ((strength - p.threshold) / (p.saturation - p.threshold)).clamp(0.0, 1.0);
    let half = |t: f64| 0.5 * t / (t + p.slope * (1.0 - t));
    if x <= 0.5 { half(2.0 * x) } else { 1.0 - half(2.0 * (1.0 - x)) }
}

fn pulse<S: Scalar>(amplitude: f64, width: f64) -> Pulse<S> {
    Pulse { amplitude: S::quantity(amplitude), width: S::quantity(width) }
}

/// Curves from nerve cuffs to surface electrodes.
fn curves() -> impl Strategy<Value = RecruitmentCurveParams> {
    (-5.0..-1.3_f64, 0.1..3.0_f64, 5e-5..1e-3, 1.0..10.0).prop_map(
        |(threshold, above, chronaxie, slope)| {
            let threshold = 10_f64.powf(threshold);
            let saturation = (threshold * (1.0 + above)).clamp(1.05 * threshold, 0.2);
            RecruitmentCurveParams { threshold, saturation, chronaxie, slope }
        },
    )
}

/// Error of U: rounding error of the input times the slope of the curve.
fn bound(p: &RecruitmentCurveParams, amplitude: f64, unit: f64, amplitude_unit: f64) -> f64 {
    let per_strength = p.slope * p.saturation / (p.saturation - p.threshold);
    let relative = amplitude / (p.saturation * 1e3);
    let of_amplitude = amplitude_unit / (p.saturation * 1e3);
    per_strength * (unit * (1.0 + relative) + of_amplitude) + 1.5 * unit
}

fn check<S: Scalar>(
    p: &RecruitmentCurveParams,
    (amplitude, width): (f64, f64),
    unit: f64,
    amplitude_unit: f64,
) -> Result<(), TestCaseError> {
    let curve = RecruitmentCurve::<S>::build(p).expect("a curve");
    let (found, status) = curve.activation(pulse(amplitude, width));
    prop_assert!(status.is_empty());
    let most = bound(p, amplitude, unit, amplitude_unit);
    let error = (found.to_f64() - exact(p, amplitude, width)).abs();
    prop_assert!(error <= most, "{p:?} {amplitude} mA {width} us: {error:e} > {most:e}");

    // The inverse returns the input.
    for activation in [0.0, 0.1, 0.5, 0.93, 1.0] {
        let wanted = S::from_f64(activation);
        let (back, status) = curve.amplitude_for(wanted, S::quantity(width));
        let back = S::quantity_value(back);
        if status.is_empty() {
            let error = (exact(p, back, width) - activation).abs();
            let most = 2.0 * bound(p, back, unit, amplitude_unit);
            prop_assert!(error <= most, "{p:?} U {activation}, {back} mA: {error:e} > {most:e}");
        } else {
            prop_assert_eq!(status, PulseStatus::UNREACHABLE);
            prop_assert!(activation > 0.0, "zero activation is always reachable");
            let greatest = 500.0_f64.min(p.saturation * 1e5);
            prop_assert!((back - greatest).abs() <= 1e-4 + 1e-6 * greatest, "{back} mA");
            prop_assert!(exact(p, greatest, width) <= activation + most);
        }
        let (back, status) = curve.width_for(wanted, S::quantity(amplitude));
        let back = S::quantity_value(back);
        if status.is_empty() {
            // Near the longest pulses the curve flattens, and width is poorly determined.
            let error = (exact(p, amplitude, back) - activation).abs();
            let most = 2.0 * bound(p, amplitude, unit, amplitude_unit)
                + p.slope * amplitude_unit / (p.chronaxie * 1e6) * amplitude
                    / ((p.saturation - p.threshold) * 1e3);
            prop_assert!(error <= most, "{p:?} U {activation}, {back} us: {error:e} > {most:e}");
        } else {
            prop_assert_eq!(status, PulseStatus::UNREACHABLE);
            prop_assert!(activation > 0.0, "zero activation is always reachable");
            prop_assert!(exact(p, amplitude, 5000.0) <= activation + most);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn curves_and_inverses_agree_with_the_equations(
        p in curves(),
        share in 0.0..2.0_f64,
        width in 5.0..5000.0_f64,
    ) {
        // Around the rise of the curve, within the limits of pulses.
        let amplitude = share * p.saturation * 1e3 * (1.0 + p.chronaxie * 1e6 / width);
        let amplitude = amplitude.min(500.0).min(p.saturation * 99e3);
        check::<f32>(&p, (amplitude, width), 2_f64.powi(-24), amplitude * 2_f64.powi(-23))?;
        check::<Fixed>(&p, (amplitude, width), 2_f64.powi(-24), 2_f64.powi(-16))?;
    }
}

/// Combinations of typical and extreme values of each parameter.
fn corners() -> Vec<RecruitmentCurveParams> {
    let mut all = Vec::new();
    for (threshold, saturation) in [(4e-3, 12e-3), (1e-5, 2e-5), (0.19, 0.2), (1e-3, 0.1)] {
        for chronaxie in [5e-5, 2e-4, 1e-3] {
            for slope in [1.0, 1.37, 3.0, 10.0] {
                all.push(RecruitmentCurveParams { threshold, saturation, chronaxie, slope });
            }
        }
    }
    all
}

/// Monotonic in amplitude and in width, from zero to saturation.
#[test]
fn activation_is_monotonic_in_amplitude_and_width() {
    for p in corners() {
        let fixed = RecruitmentCurve::<Fixed>::build(&p).expect("a curve");
        let single = RecruitmentCurve::<f32>::build(&p).expect("a curve");
        let (mut before, mut before_single) = (Fixed::from_bits(0), 0.0);
        for bits in (0..=500 << 16).step_by(97) {
            let amplitude = fixed::types::I16F16::from_bits(bits);
            let width = fixed::types::I16F16::from_num(200);
            let (now, _) = fixed.activation(Pulse { amplitude, width });
            assert!(now >= before, "{p:?} fixed {amplitude} mA");
            before = now;
            let amplitude = amplitude.to_num::<f32>();
            let (now, _) = single.activation(Pulse { amplitude, width: 200.0 });
            assert!(now >= before_single, "{p:?} f32 {amplitude} mA");
            before_single = now;
        }
        let (mut before, mut before_single) = (Fixed::from_bits(0), 0.0);
        let amplitude = p.saturation * 1.2e3;
        for bits in (0..=5000 << 16).step_by(997) {
            let width = fixed::types::I16F16::from_bits(bits);
            let pulse = Pulse { amplitude: fixed::types::I16F16::from_num(amplitude), width };
            let (now, _) = fixed.activation(pulse);
            assert!(now >= before, "{p:?} fixed {width} us");
            before = now;
            let pulse = Pulse { amplitude: amplitude as f32, width: width.to_num::<f32>() };
            let (now, _) = single.activation(pulse);
            assert!(now >= before_single, "{p:?} f32 {width} us");
            before_single = now;
        }
    }
}

#[test]
fn activation_is_zero_below_threshold_and_one_above_saturation() {
    for p in corners() {
        let curve = RecruitmentCurve::<f32>::build(&p).expect("a curve");
        let at = |share: f64| {
            let needed = 1.0 + p.chronaxie * 1e6 / 5000.0;
            curve.activation(pulse(share * needed * 1e3, 5000.0)).0
        };
        assert_eq!(at(0.0), 0.0);
        assert_eq!(at(p.threshold * 0.9999), 0.0, "{p:?}");
        assert!(at(p.threshold * 1.001) > 0.0, "{p:?}");
        assert_eq!(at(p.saturation * 1.0001), 1.0, "{p:?}");
        assert!(at(p.saturation * 0.999) < 1.0, "{p:?}");
    }
}

#[test]
fn invalid_pulses_are_clipped_and_flagged() {
    let p =
        RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 2e-4, slope: 2.0 };
    let curve = RecruitmentCurve::<f32>::build(&p).expect("a curve");
    for (amplitude, width, expected, flags) in [
        (-1.0, 200.0, 0.0, PulseStatus::AMPLITUDE_CLIPPED),
        (f32::NAN, 200.0, 0.0, PulseStatus::AMPLITUDE_NOT_FINITE),
        (f32::INFINITY, 200.0, 1.0, PulseStatus::AMPLITUDE_NOT_FINITE),
        (501.0, 200.0, 1.0, PulseStatus::AMPLITUDE_CLIPPED),
        (16.0, -1.0, 0.0, PulseStatus::WIDTH_CLIPPED),
        (16.0, f32::NAN, 0.0, PulseStatus::WIDTH_NOT_FINITE),
        (11.0, f32::INFINITY, exact(&p, 11.0, 5000.0) as f32, PulseStatus::WIDTH_NOT_FINITE),
    ] {
        let (activation, status) = curve.activation(Pulse { amplitude, width });
        assert!((activation - expected).abs() < 1e-6, "{amplitude} {width}: {activation}");
        assert_eq!(status, flags, "{amplitude} {width}");
    }
    let both = PulseStatus::ACTIVATION_CLIPPED | PulseStatus::WIDTH_CLIPPED;
    let (amplitude, status) = curve.amplitude_for(1.1, 6000.0);
    assert!((amplitude - 12.48).abs() < 1e-4, "{amplitude}");
    assert_eq!(status, both);
    assert_eq!(curve.amplitude_for(f32::NAN, 200.0).1, PulseStatus::ACTIVATION_NOT_FINITE);
    assert_eq!(curve.width_for(0.5, 7.0), (5000.0, PulseStatus::UNREACHABLE));
    // A pulse so short that even the greatest amplitude is too little, and one of no length.
    let unreachable = PulseStatus::UNREACHABLE;
    assert_eq!(curve.amplitude_for(0.5, 1.0), (500.0, unreachable));
    assert_eq!(curve.amplitude_for(0.5, 0.0), (500.0, unreachable));
    // Everything that is wrong is said, also of what is unreachable.
    let clipped = PulseStatus::AMPLITUDE_CLIPPED | PulseStatus::WIDTH_CLIPPED;
    assert_eq!(curve.activation(Pulse { amplitude: 501.0, width: 6000.0 }).1, clipped);
    let of_both = PulseStatus::ACTIVATION_CLIPPED | PulseStatus::WIDTH_CLIPPED | unreachable;
    assert_eq!(curve.amplitude_for(1.1, -1.0), (500.0, of_both));
    let of_both = PulseStatus::ACTIVATION_CLIPPED | PulseStatus::AMPLITUDE_CLIPPED;
    let (width, status) = curve.width_for(1.1, 501.0);
    assert!((width - 200.0 / (500.0 / 12.0 - 1.0)).abs() < 1e-3, "{width}");
    assert_eq!(status, of_both);
    assert_eq!(curve.width_for(1.1, -1.0), (5000.0, of_both | unreachable));
    // None of these recruits anything, and none is flagged.
    assert_eq!(curve.width_for(0.0, 2.0), (5000.0, PulseStatus::empty()));
    assert_eq!(curve.amplitude_for(0.0, 1.0), (500.0, PulseStatus::empty()));
    assert_eq!(curve.amplitude_for(0.0, 0.0), (500.0, PulseStatus::empty()));

    let refused = |p: RecruitmentCurveParams| {
        RecruitmentCurve::<Fixed>::build(&p).expect_err("refused").to_string()
    };
    assert_eq!(
        refused(RecruitmentCurveParams { slope: 0.5, ..p }),
        "slope = 0.5: must be between 1 and 10"
    );
    assert_eq!(
        refused(RecruitmentCurveParams { saturation: 4e-3, ..p }),
        "saturation = 0.004: must be between 0.0042 and 0.2"
    );
    let not_a_number = RecruitmentCurveParams { threshold: f64::NAN, ..p };
    assert!(refused(not_a_number).starts_with("threshold = NaN"));
}

/// A limit that is computed refuses nothing that it allows in decimals.
#[test]
fn a_saturation_of_1_05_thresholds_is_enough() {
    for microamperes in (100..10_000).step_by(20) {
        let [threshold, saturation] =
            [100 * microamperes, 105 * microamperes].map(|parts| f64::from(parts) / 1e8);
        let params = RecruitmentCurveParams { threshold, saturation, chronaxie: 2e-4, slope: 2.0 };
        assert_eq!(params.validate(), Ok(()));
    }
}

/// Every coefficient is in the checksum, and nothing else.
#[test]
fn a_curve_has_a_checksum_of_its_coefficients() {
    let p =
        RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 2e-4, slope: 2.0 };
    let of = |p: &RecruitmentCurveParams| {
        RecruitmentCurve::<Fixed>::build(p).expect("a curve").checksum()
    };
    assert_eq!(of(&p), of(&p.clone()));
    for other in [
        RecruitmentCurveParams { threshold: 4.1e-3, ..p },
        RecruitmentCurveParams { saturation: 12.1e-3, ..p },
        RecruitmentCurveParams { chronaxie: 2.1e-4, ..p },
        RecruitmentCurveParams { slope: 2.1, ..p },
    ] {
        assert_ne!(of(&other), of(&p), "{other:?}");
    }
}
