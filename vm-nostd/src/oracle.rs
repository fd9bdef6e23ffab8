//! Tests of every element against the paper's own formula, in `f64`, and of every slope against
//! a difference quotient.

use crate::activation::ActivationFrequency;
use crate::excitation::Excitation;
use crate::force_length::ForceLength;
use crate::force_velocity::ForceVelocity;
use crate::lag::Lag;
use crate::params::FiberType;
use crate::passive::{Compression, Parallel};
use crate::presets::{feline_vm4, human_vm4, paper_table_1};
use crate::sag::share_above;
use crate::scalar::Scalar;
use crate::softplus::softplus;
use crate::tendon::Tendon;
use crate::time_step::TimeStep;

const TYPES: [FiberType; 5] = [
    paper_table_1::SLOW,
    paper_table_1::FAST,
    human_vm4::SUPER_SLOW,
    feline_vm4::SLOW,
    feline_vm4::FAST,
];

/// Numbers evenly from `least` to `most`.
fn spaced(least: f64, most: f64, count: u32) -> Vec<f64> {
    (0..=count).map(|i| least + (most - least) * f64::from(i) / f64::from(count)).collect()
}

/// Largest error of a quantity over a sweep, in f32 and in f64.
#[derive(Default)]
struct Worst {
    f32: f64,
    f64: f64,
}

impl Worst {
    fn see(&mut self, f32: f32, f64: f64, expected: f64) {
        let scale = expected.abs().max(1.0);
        // `f64::max` passes over a not-a-number: it must not pass here.
        assert!(f32.is_finite() && f64.is_finite(), "{f32} {f64} for {expected}");
        self.f32 = self.f32.max((f64::from(f32) - expected).abs() / scale);
        self.f64 = self.f64.max((f64 - expected).abs() / scale);
    }

    fn assert(&self, f32: f64, f64: f64, what: &str) {
        assert!(self.f32 <= f32, "{what} in f32: {:e} > {f32:e}", self.f32);
        assert!(self.f64 <= f64, "{what} in f64: {:e} > {f64:e}", self.f64);
    }
}

/// The slope of `f` at `x` by a central difference.
fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let h = 1e-6;
    (f(x + h) - f(x - h)) / (2.0 * h)
}

#[test]
fn softplus_is_the_logarithm_of_one_plus_exp() {
    let (mut value, mut steepness) = (Worst::default(), Worst::default());
    for x in spaced(-60.0, 60.0, 4001) {
        let x = f64::from(x as f32);
        let exact = x.max(0.0) + (-x.abs()).exp().ln_1p();
        let ((v32, s32), (v64, s64)) = (softplus(x as f32), softplus(x));
        value.see(v32, v64, exact);
        steepness.see(s32, s64, 1.0 / (1.0 + (-x).exp()));
    }
    value.assert(1.2e-7, 3e-16, "softplus");
    steepness.assert(1.2e-7, 3e-16, "its slope");
}

#[test]
fn the_tendon_pulls_as_the_paper_says() {
    let p = &paper_table_1::ELEMENTS.tendon;
    let (fascicle, tendon) = (0.11, 0.02);
    let (t32, t64) =
        (Tendon::<f32>::new(p, fascicle, tendon), Tendon::<f64>::new(p, fascicle, tendon));
    let paper =
        |length: f64| p.stiffness * p.toe * (((length - p.slack_length) / p.toe).exp() + 1.0).ln();
    let mut force = Worst::default();
    for length in spaced(0.9, 1.05, 501) {
        let extension = f64::from(((length - p.slack_length) / p.toe) as f32);
        let at = extension * p.toe + p.slack_length;
        force.see(t32.pull(extension as f32).0, t64.pull(extension).0, paper(at));
    }
    force.assert(3e-7, 1e-14, "F_se");
    // From path and fascicle length to extension and back, and the slope by fascicle length.
    for length in spaced(0.7, 1.4, 101) {
        let path = length * fascicle + 0.99 * tendon;
        let extension = t64.extension(path, length);
        assert!((extension - (0.99 - p.slack_length) / p.toe).abs() < 1e-9);
        assert!((t64.fascicle_length(path, extension) - length).abs() < 1e-12);
        let pull = |l: f64| t64.pull(t64.extension(path, l)).0;
        assert!((t64.pull(extension).1 + slope(pull, length)).abs() < 1e-4);
    }
    assert!((paper(p.length_at(0.3)) - 0.3).abs() < 1e-12);
}

#[test]
fn the_passive_elements_are_the_papers() {
    let e = &paper_table_1::ELEMENTS;
    let longest = 1.49875;
    let (p32, p64) =
        (Parallel::<f32>::new(&e.parallel, longest), Parallel::<f64>::new(&e.parallel, longest));
    let (c32, c64) =
        (Compression::<f32>::new(&e.compression), Compression::<f64>::new(&e.compression));
    let (mut pe1, mut pe2) = (Worst::default(), Worst::default());
    for l in spaced(0.45, 1.8, 2001) {
        let l = f64::from(l as f32);
        let (p, c) = (&e.parallel, &e.compression);
        let f1 = p.stiffness * p.toe * (((l / longest - p.slack_length) / p.toe).exp() + 1.0).ln();
        let f2 = (c.strength * ((c.steepness * (l - c.onset_length)).exp() - 1.0)).min(0.0);
        pe1.see(p32.at(l as f32).0, p64.at(l).0, f1);
        pe2.see(c32.at(l as f32).0, c64.at(l).0, f2);
        assert!((p64.at(l).1 - slope(|l| p64.at(l).0, l)).abs() < 1e-6);
        let kink = (l - c.onset_length).abs() < 2e-6;
        assert!(kink || (c64.at(l).1 - slope(|l| c64.at(l).0, l)).abs() < 1e-5);
    }
    pe1.assert(4e-6, 1e-14, "F_pe1");
    pe2.assert(2e-6, 1e-14, "F_pe2");
}

#[test]
fn force_length_is_the_papers() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.force_length;
        let (f32, f64) = (ForceLength::<f32>::new(p), ForceLength::<f64>::new(p));
        for l in spaced(0.45, 1.7, 2501) {
            let l = f64::from(l as f32);
            let exact = (-((l.powf(p.skewness) - 1.0) / p.width).abs().powf(p.roundness)).exp();
            let at64 = |l: f64| f64.at(Scalar::ln(l), 1.0 / l);
            let l32 = l as f32;
            value.see(f32.at(Scalar::ln(l32), 1.0 / l32).0, at64(l).0, exact);
            // The slope has a cusp at optimal length.
            if (l - 1.0).abs() > 1e-3 {
                assert!((at64(l).1 - slope(|l| at64(l).0, l)).abs() < 1e-4, "L {l}");
            }
        }
        let (at_optimum, _) = f32.at(0.0, 1.0);
        assert!((at_optimum - 1.0).abs() < 1e-7);
    }
    value.assert(5e-7, 1e-14, "FL");
}

#[test]
fn force_velocity_is_the_papers_on_both_branches() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.force_velocity;
        let (f32, f64) = (ForceVelocity::<f32>::new(p), ForceVelocity::<f64>::new(p));
        let shortest = p.shortest_length(0.4) + 0.05;
        for l in spaced(shortest, 1.6, 30) {
            let l = f64::from(l as f32);
            for v in spaced(p.maximum_velocity, 10.0, 600) {
                let v = f64::from(v as f32).max(p.maximum_velocity);
                let [c0, c1] = p.shortening;
                let [a0, a1, a2] = p.lengthening;
                let exact = if v <= 0.0 {
                    (p.maximum_velocity - v) / (p.maximum_velocity + (c0 + c1 * l) * v)
                } else {
                    let b = p.lengthening_velocity;
                    (b - (a0 + a1 * l + a2 * l * l) * v) / (b + v)
                };
                let at64 = |v: f64| f64.at(l).at(v > 0.0, v);
                value.see(f32.at(l as f32).at(v > 0.0, v as f32).0, at64(v).0, exact);
                if v.abs() > 1e-5 && v > p.maximum_velocity + 1e-5 {
                    let steepness = at64(v).1;
                    let by_difference = slope(|v| at64(v).0, v);
                    assert!((steepness - by_difference).abs() < 1e-4 * (1.0 + steepness));
                    let bend = 2.0 * at64(v).2;
                    let by_difference = slope(|v| at64(v).1, v);
                    assert!((bend - by_difference).abs() < 1e-3 * (1.0 + bend.abs()));
                }
            }
        }
        let (beyond, steepness, _) = f64.at(1.0).at(false, p.maximum_velocity - 3.0);
        assert!(beyond.abs() < 1e-15 && steepness == 0.0, "{beyond:e}");
    }
    value.assert(2e-6, 1e-13, "FV");
}

#[test]
fn activation_by_frequency_is_the_papers() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.activation;
        let (a32, a64) = (ActivationFrequency::<f32>::new(p), ActivationFrequency::<f64>::new(p));
        let longest = p.longest_length(1.8);
        for l in spaced(0.5, longest, 40) {
            let l = f64::from(l as f32).min(longest);
            let exact = |f: f64, l: f64| {
                let n = p.exponent + p.length_dependence * (1.0 / l - 1.0);
                1.0 - (-(f / (p.scale * n)).powf(n)).exp()
            };
            for f in spaced(0.0, 4.0, 200) {
                let f = f64::from(f as f32);
                let at32 = a32.at(1.0 / l as f32).at(f as f32, 0.0, 0.0);
                let at64 = a64.at(1.0 / l).at(f, 0.0, 0.0);
                value.see(at32.0, at64.0, exact(f, l));
                if f > 0.18 && l < longest - 1e-3 {
                    // Along a direction in frequency and length together.
                    let change = a64.at(1.0 / l).at(f, 0.7, 0.2).1;
                    let by_difference = slope(|s| exact(f + 0.7 * s, l + 0.2 * s), 0.0);
                    assert!((change - by_difference).abs() < 1e-4, "{change} {by_difference}");
                }
            }
        }
    }
    // In f64 what is left is the floor of the logarithm, at f = 0 and the smallest n_f.
    value.assert(3e-6, 1e-7, "Af");
}

/// Euler's method at steps so short that it can serve as an oracle.
fn excitation_by_small_steps(
    t: &FiberType,
    start: (f64, f64),
    drive: f64,
    l: f64,
    af: f64,
) -> (f64, f64) {
    let (mut f_int, mut f_eff) = start;
    let steps = 200_000;
    let h = 1e-3 / f64::from(steps);
    let e = &t.excitation;
    for _ in 0..steps {
        let time_constant = if f_int >= f_eff {
            e.rise * l * l + e.rise_per_frequency * drive
        } else {
            (e.fall + e.fall_per_activation * af) / l
        };
        let change = ((drive - f_int) / time_constant, (f_int - f_eff) / time_constant);
        (f_int, f_eff) = (f_int + h * change.0, f_eff + h * change.1);
    }
    (f_int, f_eff)
}

#[test]
fn excitation_is_exact_also_where_its_two_lags_cross_within_a_tick() {
    // Rising, falling, at the kink f_int = f_eff, and crossing either way.
    let cases = [
        ((0.2, 0.1), 1.5),
        ((0.5, 0.9), 0.0),
        ((0.0, 0.0), 0.8),
        ((0.7, 0.7), 0.2),
        ((0.510, 0.500), 0.0),
        ((0.500, 0.505), 1.9),
        ((0.3, 0.3), 0.3),
    ];
    for t in TYPES {
        let excitation = Excitation::<f64>::new(&t.excitation, TimeStep::MILLISECOND);
        for (start, drive) in cases {
            let (l, af) = (1.13, 0.4);
            let (f_int, f_eff) = excitation_by_small_steps(&t, start, drive, l, af);
            let excited = excitation.advance(start, drive, drive, af, l);
            let (a, b) = (excited.intermediate - f_int, excited.effective - f_eff);
            assert!(a.abs() < 1e-6 && b.abs() < 1e-6, "{start:?} to {drive}: {a:e} {b:e}");
            assert!(excited.effective >= 0.0 && excited.effective_at_middle >= 0.0);
        }
    }
}

#[test]
fn a_lag_reaches_its_target_and_its_middle_lies_on_the_way() {
    let lag = Lag::<f64>::new(0.03, TimeStep::MILLISECOND);
    let exact = |ticks: f64| 1.0 - (-ticks * 1e-3 / 0.03_f64).exp();
    assert!((lag.at_end(0.0, 1.0) - exact(1.0)).abs() < 1e-15);
    assert!((lag.at_middle(0.0, 1.0) - exact(0.5)).abs() < 1e-15);
    let slow = Lag::<f32>::new(0.2, TimeStep::MILLISECOND);
    let settled = (0..10_000).fold(0.0_f32, |y, _| slow.at_end(y, 1.0));
    // In f32 a lag stalls where its step falls below half a last bit.
    assert!((settled - 1.0).abs() < 2e-5, "{settled}");
}

#[test]
fn the_share_of_a_tick_above_a_level_is_found_by_where_it_is_crossed() {
    assert_eq!(share_above(0.0, 0.05, 0.1), 0.0);
    assert_eq!(share_above(0.1, 0.2, 0.1), 1.0);
    assert!((share_above(0.0, 0.4, 0.1) - 0.75_f64).abs() < 1e-15);
    assert!((share_above(0.4, 0.0, 0.1) - 0.75_f64).abs() < 1e-15);
}
