//! Fatigue in `f32` and fixed point against its equation, for slow changes and arbitrary inputs.

use model_tests::muscles::config;
use proptest::prelude::*;
use vm_nostd::{Fatigue, FatigueParams, FatigueState, Fixed, RestoreError, Scalar, TimeStep};

/// fit after `time` (s) from rest at a constant activation and frequency (pps).
fn exact(p: &FatigueParams, time: f64, activation: f64, frequency: f64) -> f64 {
    let strain = 1.0 - p.frequency_dependence * (1.0 - (frequency.min(100.0) / 100.0).powi(2));
    let tiring = activation * strain / p.fatigue_time;
    let recovering = (1.0 - activation * strain) / p.recovery_time;
    let end = (p.least_fitness * tiring + recovering) / (tiring + recovering);
    end + (1.0 - end) * (-(tiring + recovering) * time).exp()
}

/// The largest error of fitness over `ticks`.
fn error<S: Scalar>(p: &FatigueParams, step: TimeStep, ticks: usize, a: f64, f: f64) -> f64 {
    let fatigue = Fatigue::<S>::build(p, step).expect("valid fatigue parameters");
    let mut state = fatigue.rested();
    let mut largest = 0.0_f64;
    for tick in 1..=ticks {
        let found = fatigue.advance(&mut state, S::from_f64(a), S::quantity(f)).to_f64();
        let expected = exact(p, tick as f64 * step.seconds(), a, f);
        largest = largest.max((found - expected).abs());
    }
    largest
}

#[test]
fn fitness_agrees_with_the_equation_for_ten_minutes() {
    let slowest = FatigueParams {
        fatigue_time: 1000.0,
        recovery_time: 1000.0,
        least_fitness: 0.3,
        frequency_dependence: 0.0,
    };
    let fastest = FatigueParams { fatigue_time: 1.0, recovery_time: 1.0, ..slowest };
    let cases = [
        (FatigueParams::QUADRICEPS, 1.0, 20.0),
        (FatigueParams::QUADRICEPS, 0.37, 150.0),
        (slowest, 1.0, 30.0),
        // The change per tick is below half an ULP of `f32` at 1.
        (slowest, 0.004, 30.0),
        (fastest, 0.6, 50.0),
        // The smallest changes per tick, close to the final value.
        (FatigueParams { least_fitness: 0.999, ..slowest }, 1.0, 30.0),
    ];
    for (p, activation, frequency) in cases {
        for seconds in [1e-4, 1e-3, 2e-3] {
            let step = TimeStep::from_seconds(seconds).expect("a step");
            let ticks = (600.0 / seconds) as usize;
            let single = error::<f32>(&p, step, ticks, activation, frequency);
            let fixed = error::<Fixed>(&p, step, ticks, activation, frequency);
            assert!(single < 1.1e-5, "{p:?} {seconds} s: {single:e}");
            // The ratio of tick to time constant is in Q0.32: that of 1e-4 s to 1,000 s is rounded
            // to about 0.1 %.
            assert!(fixed < 5e-4, "{p:?} {seconds} s: {fixed:e}");
        }
    }
}

proptest! {
    #![proptest_config(config(300))]

    /// For any input, including NaN.
    #[test]
    fn fitness_stays_between_its_minimum_and_one(
        fatigue_time in 1.0..1000.0_f64,
        recovery_time in 1.0..1000.0_f64,
        least_fitness in 0.0..=1.0_f64,
        frequency_dependence in 0.0..=1.0_f64,
        inputs in prop::collection::vec((any::<f32>(), any::<f32>()), 1..200),
    ) {
        let p = FatigueParams { fatigue_time, recovery_time, least_fitness, frequency_dependence };
        let single = Fatigue::<f32>::build(&p, TimeStep::MILLISECOND).expect("valid");
        let fixed = Fatigue::<Fixed>::build(&p, TimeStep::MILLISECOND).expect("valid");
        let (mut a, mut b) = (single.rested(), fixed.rested());
        for (activation, frequency) in inputs {
            for _ in 0..50 {
                let fitness = single.advance(&mut a, activation, frequency).to_f64();
                prop_assert!((least_fitness - 1e-6..=1.0).contains(&fitness), "f32 {fitness}");
                let fitness = fixed
                    .advance(&mut b, Fixed::from_f64(activation.into()), Fixed::quantity(frequency.into()))
                    .to_f64();
                prop_assert!((least_fitness - 1e-6..=1.0).contains(&fitness), "fixed {fitness}");
            }
        }
    }
}

/// A restored state continues with the same bits; invalid states are refused.
fn saved<S: Scalar>() {
    let fatigue = Fatigue::<S>::build(&FatigueParams::QUADRICEPS, TimeStep::MILLISECOND)
        .expect("valid fatigue parameters");
    let (mut state, f) = (fatigue.rested(), S::quantity(25.0));
    for _ in 0..5_000 {
        fatigue.advance(&mut state, S::ONE, f);
    }
    let words: Vec<S::Bits> = fatigue.save(&state).collect();
    assert_eq!(words.len(), FatigueState::<S>::SAVED_WORDS);
    let mut restored = fatigue.restore(words.iter().copied()).expect("a saved state");
    for _ in 0..1_000 {
        assert_eq!(
            fatigue.advance(&mut state, S::from_f64(0.5), f),
            fatigue.advance(&mut restored, S::from_f64(0.5), f)
        );
    }
    assert_eq!(state, restored);
    assert!(fatigue.restore(words[1..].iter().copied()).is_err());
    let mut beyond = words.clone();
    beyond[1] = S::from_f64(1.5).to_bits();
    assert_eq!(fatigue.restore(beyond), Err(RestoreError::Value { word: 1 }));

    // Other fatigue parameters or another time step refuse it.
    let other = FatigueParams { recovery_time: 31.0, ..FatigueParams::QUADRICEPS };
    let half = TimeStep::from_seconds(0.5e-3).expect("a step");
    for (params, step) in [(other, TimeStep::MILLISECOND), (FatigueParams::QUADRICEPS, half)] {
        let fatigue = Fatigue::<S>::build(&params, step).expect("valid fatigue parameters");
        let refused = fatigue.restore(words.iter().copied()).expect_err("another one's");
        assert!(matches!(refused, RestoreError::OtherMuscle { .. }), "{refused}");
    }
}

#[test]
fn a_restored_state_continues_with_the_same_bits() {
    saved::<f32>();
    saved::<Fixed>();
    saved::<f64>();
}

#[test]
fn invalid_parameters_are_named() {
    let refused = |p: FatigueParams| {
        Fatigue::<f32>::build(&p, TimeStep::MILLISECOND).expect_err("refused").to_string()
    };
    let p = FatigueParams::QUADRICEPS;
    assert_eq!(
        refused(FatigueParams { recovery_time: f64::NAN, ..p }),
        "recovery_time = NaN: must be between 1 and 1000"
    );
    assert_eq!(
        refused(FatigueParams { frequency_dependence: 1.5, ..p }),
        "frequency_dependence = 1.5: must be between 0 and 1"
    );
}
