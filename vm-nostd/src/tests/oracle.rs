//! Tests every element against the paper's formula in `f64`, and every slope against a difference
//! quotient.

use crate::ContinuousMuscle;
use crate::equations::activation_frequency::{self, ActivationFrequency};
use crate::equations::excitation::{self, Excitation, ExcitationInput};
use crate::equations::force_length::tests::{force_length, papers_force_length};
use crate::equations::force_velocity::ForceVelocity;
use crate::equations::passive::{Compression, Parallel};
use crate::equations::sag::share_above;
use crate::equations::tendon::Tendon;
use crate::io::Input;
use crate::params::FiberType;
use crate::params::presets::{PAPER_MUSCLE, feline_vm4, human_vm4, paper_table_1};
use crate::scalar::fixed::Fixed;
use crate::scalar::{Factors, Kernels, Scalar};
use crate::tick::lag::Lag;
use crate::tick::time_step::TimeStep;

const TYPES: [FiberType; 5] = [
    paper_table_1::SLOW,
    paper_table_1::FAST,
    human_vm4::SUPER_SLOW,
    feline_vm4::SLOW,
    feline_vm4::FAST,
];

/// Equidistant numbers from `least` to `most`.
fn spaced(least: f64, most: f64, count: u32) -> Vec<f64> {
    (0..=count).map(|i| least + (most - least) * f64::from(i) / f64::from(count)).collect()
}

/// Nearest number that `f32` and fixed point both represent exactly, below 16.
fn shared(value: f64) -> f64 {
    (value * 1_048_576.0).round() / 1_048_576.0
}

/// A number in fixed point.
fn q(value: f64) -> Fixed {
    Fixed::from_f64(value)
}

/// Largest error of each relation, of force in F0 at full activation, in `f32`, fixed point and
/// `f64`.
const BOUNDS: [(&str, [f64; 3]); 6] = [
    ("F_se", [2e-7, 6.6e-8, 6.7e-16]),
    ("F_pe1", [8e-7, 5.3e-7, 3.9e-15]),
    ("F_pe2", [5e-7, 4e-7, 3.3e-15]),
    ("FL", [3.9e-6, 1.8e-6, 1.8e-6]),
    ("FV", [9.7e-7, 2.8e-6, 3.1e-15]),
    ("Af", [3.7e-6, 1.2e-6, 2.3e-15]),
];

/// Time step, s; slopes by length are per tick.
const TICK: f64 = 1e-3;

/// Largest error of a quantity over a sweep, in each arithmetic.
#[derive(Default)]
struct Worst {
    f32: f64,
    fixed: f64,
    f64: f64,
}

impl Worst {
    fn see(&mut self, f32: f32, fixed: Fixed, f64: f64, expected: f64) {
        let scale = expected.abs().max(1.0);
        // `f64::max` ignores NaN, which must fail here.
        assert!(f32.is_finite() && f64.is_finite(), "{f32} {f64} for {expected}");
        self.f32 = self.f32.max((f64::from(f32) - expected).abs() / scale);
        self.fixed = self.fixed.max((Scalar::to_f64(fixed) - expected).abs() / scale);
        self.f64 = self.f64.max((f64 - expected).abs() / scale);
    }

    /// Compares the largest errors with the entry of [`BOUNDS`].
    fn assert_bound(&self, relation: &str) {
        let (_, [f32, fixed, f64]) =
            BOUNDS.into_iter().find(|(name, _)| *name == relation).expect("a relation");
        self.assert(f32, fixed, f64, relation);
    }

    fn assert(&self, f32: f64, fixed: f64, f64: f64, what: &str) {
        assert!(self.f32 <= f32, "{what} in f32: {:e} > {f32:e}", self.f32);
        assert!(self.fixed <= fixed, "{what} in fixed: {:e} > {fixed:e}", self.fixed);
        assert!(self.f64 <= f64, "{what} in f64: {:e} > {f64:e}", self.f64);
    }
}

/// The slope of `f` at `x` by a central difference.
fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let h = 1e-6;
    (f(x + h) - f(x - h)) / (2.0 * h)
}

#[test]
fn tendon_force_agrees_with_the_paper() {
    let p = &paper_table_1::ELEMENTS.tendon;
    let (fascicle, tendon) = (0.11, 0.02);
    let step = TimeStep::MILLISECOND;
    let t32 = Tendon::<f32>::new(p, fascicle, tendon, step);
    let fixed = Tendon::<Fixed>::new(p, fascicle, tendon, step);
    let t64 = Tendon::<f64>::new(p, fascicle, tendon, step);
    let paper =
        |length: f64| p.stiffness * p.toe * (((length - p.slack_length) / p.toe).exp() + 1.0).ln();
    let mut force = Worst::default();
    for length in spaced(0.9, 1.05, 501) {
        let extension = shared((length - p.slack_length) * tendon / fascicle);
        let at = extension * fascicle / tendon + p.slack_length;
        force.see(
            t32.pull(extension as f32).force,
            fixed.pull(q(extension)).force,
            t64.pull(extension).force,
            paper(at),
        );
    }
    force.assert_bound("F_se");
    // From path and fascicle length to extension and back, and the slope by fascicle length.
    for length in spaced(0.7, 1.4, 101) {
        let path = length * fascicle + 0.99 * tendon;
        let extension = t64.extension(path, length);
        assert!((extension - (0.99 - p.slack_length) * tendon / fascicle).abs() < 1e-12);
        assert!((t64.fascicle_length(path, extension) - length).abs() < 1e-12);
        let pull = |l: f64| t64.pull(t64.extension(path, l)).force;
        let stiffness = t64.pull(extension).stiffness / TICK;
        assert!((stiffness + slope(pull, length)).abs() < 1e-4);
    }
    assert!((paper(p.length_at(0.3)) - 0.3).abs() < 1e-12);
}

#[test]
fn passive_elements_agree_with_the_paper() {
    let e = &paper_table_1::ELEMENTS;
    let longest = 1.49875;
    let step = TimeStep::MILLISECOND;
    let p32 = Parallel::<f32>::new(&e.parallel, longest, step);
    let p_fixed = Parallel::<Fixed>::new(&e.parallel, longest, step);
    let p64 = Parallel::<f64>::new(&e.parallel, longest, step);
    let c32 = Compression::<f32>::new(&e.compression, step);
    let c_fixed = Compression::<Fixed>::new(&e.compression, step);
    let c64 = Compression::<f64>::new(&e.compression, step);
    let (mut pe1, mut pe2) = (Worst::default(), Worst::default());
    for l in spaced(0.45, 1.8, 2001) {
        let l = shared(l);
        let (p, c) = (&e.parallel, &e.compression);
        let f1 = p.stiffness * p.toe * (((l / longest - p.slack_length) / p.toe).exp() + 1.0).ln();
        let f2 = (c.strength * ((c.steepness * (l - c.onset_length)).exp() - 1.0)).min(0.0);
        pe1.see(p32.at(l as f32).0, p_fixed.at(q(l)).0, p64.at(l).0, f1);
        pe2.see(c32.at(l as f32).0, c_fixed.at(q(l)).0, c64.at(l).0, f2);
        assert!((p64.at(l).1 / TICK - slope(|l| p64.at(l).0, l)).abs() < 1e-6);
        let kink = (l - c.onset_length).abs() < 2e-6;
        assert!(kink || (c64.at(l).1 / TICK - slope(|l| c64.at(l).0, l)).abs() < 1e-5);
    }
    pe1.assert_bound("F_pe1");
    pe2.assert_bound("F_pe2");
}

#[test]
fn force_length_agrees_with_the_paper() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.force_length;
        let (f32, f64) = (force_length::<f32>(p), force_length::<f64>(p));
        let fixed = force_length::<Fixed>(p);
        for l in spaced(0.4, 1.8, 2801) {
            let l = shared(l);
            value.see(f32(l as f32), fixed(q(l)), f64(l), papers_force_length(p, l));
        }
    }
    value.assert_bound("FL");
}

#[test]
fn force_velocity_agrees_with_the_paper_on_both_branches() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.force_velocity;
        let (f32, f64) = (ForceVelocity::<f32>::new(p), ForceVelocity::<f64>::new(p));
        let fixed = ForceVelocity::<Fixed>::new(p);
        let shortest = p.shortest_length(0.4) + 0.05;
        for l in spaced(shortest, 1.6, 30) {
            let l = shared(l);
            for v in spaced(p.maximum_velocity, 10.0, 600) {
                let v = shared(v).max(p.maximum_velocity);
                let [c0, c1] = p.shortening;
                let [a0, a1, a2] = p.lengthening;
                let exact = if v <= 0.0 {
                    (p.maximum_velocity - v) / (p.maximum_velocity + (c0 + c1 * l) * v)
                } else {
                    let b = p.lengthening_velocity;
                    (b - (a0 + a1 * l + a2 * l * l) * v) / (b + v)
                };
                let at64 = |v: f64| f64.on(&f64.at(l, 0.0), 0.0, v);
                let value_at = |v: f64| at64(v).value(v);
                let slope_at = |v: f64| at64(v).secant * at64(v).reciprocal;
                let curve = fixed.at(q(l), Fixed::ZERO);
                let at_fixed = fixed.on(&curve, Fixed::part(0.0), q(v)).value(q(v));
                let at32 = f32.on(&f32.at(l as f32, 0.0), 0.0, v as f32).value(v as f32);
                value.see(at32, at_fixed, value_at(v), exact);
                // Half a tick later, after half of the change in length.
                let later = f64.on(&f64.at(l, 2e-3), 0.5, v).value(v);
                let there = f64.on(&f64.at(l + 1e-3, 0.0), 0.0, v).value(v);
                assert!((later - there).abs() < 2e-5, "L {l}, V {v}: {later} {there}");
                if v.abs() > 1e-5 && v > p.maximum_velocity + 1e-5 {
                    let steepness = slope_at(v);
                    let by_difference = slope(value_at, v);
                    assert!((steepness - by_difference).abs() < 1e-4 * (1.0 + steepness));
                    let bend = -2.0 * slope_at(v) * at64(v).bend;
                    let by_difference = slope(slope_at, v);
                    assert!((bend - by_difference).abs() < 1e-3 * (1.0 + bend.abs()));
                }
            }
        }
    }
    value.assert_bound("FV");
}

#[test]
fn activation_frequency_agrees_with_the_paper() {
    let mut value = Worst::default();
    for t in TYPES {
        let p = &t.activation;
        let (a32, a64) = (ActivationFrequency::<f32>::new(p), ActivationFrequency::<f64>::new(p));
        let fixed = ActivationFrequency::<Fixed>::new(p);
        let longest = p.longest_length(1.8);
        for l in spaced(0.5, longest, 40) {
            let l = shared(l).min(longest);
            let exact = |f: f64, l: f64| {
                let n = p.exponent + p.length_dependence * (1.0 / l - 1.0);
                1.0 - (-(f / (p.scale * n)).powf(n)).exp()
            };
            for f in spaced(0.0, 4.0, 200) {
                let f = shared(f);
                let [of_fixed] = activation_frequency::curves([&fixed], q(l).reciprocal());
                let [of_f32] = activation_frequency::curves([&a32], 1.0 / l as f32);
                let [of_f64] = activation_frequency::curves([&a64], 1.0 / l);
                let (at_fixed, at32) = (of_fixed.at(q(f)), of_f32.at(f as f32));
                let at64 = of_f64.at(f);
                value.see(at32, at_fixed, at64, exact(f, l));
            }
        }
    }
    value.assert_bound("Af");
}

/// Euler's method with very short steps, as an oracle.
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
fn excitation_is_exact_even_if_its_lags_cross_within_a_tick() {
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
            let input = ExcitationInput {
                excitation: &excitation,
                intermediate: start.0,
                effective: start.1,
                drive,
                frequency: drive,
                slowing: af,
            };
            let [excited] = excitation::advance([input], l, 1.0 / l);
            let (a, b) = (excited.intermediate - f_int, excited.effective - f_eff);
            assert!(a.abs() < 1e-6 && b.abs() < 1e-6, "{start:?} to {drive}: {a:e} {b:e}");
            assert!(excited.effective >= 0.0 && excited.effective_at_middle >= 0.0);
        }
    }
}

#[test]
fn a_lag_is_exact_at_mid_tick_and_at_the_end() {
    let lag = Lag::<f64>::new(0.03, TimeStep::MILLISECOND);
    let exact = |ticks: f64| 1.0 - (-ticks * 1e-3 / 0.03_f64).exp();
    assert!((lag.at_end(0.0, 1.0) - exact(1.0)).abs() < 1e-15);
    assert!((lag.at_middle(0.0, 1.0) - exact(0.5)).abs() < 1e-15);
    let slow = Lag::<f32>::new(0.2, TimeStep::MILLISECOND);
    let settled = (0..10_000).fold(0.0_f32, |y, _| slow.at_end(y, 1.0));
    // In f32 a lag stalls when its step is below half an ULP.
    assert!((settled - 1.0).abs() < 2e-5, "{settled}");
}

#[test]
fn the_share_of_a_tick_above_a_level_is_interpolated() {
    assert_eq!(share_above(0.0, 0.05, 0.1), 0.0);
    assert_eq!(share_above(0.1, 0.2, 0.1), 1.0);
    assert!((share_above(0.0, 0.4, 0.1) - 0.75_f64).abs() < 1e-15);
    assert!((share_above(0.4, 0.0, 0.1) - 0.75_f64).abs() < 1e-15);
}

#[test]
fn the_readme_has_the_bounds_of_the_relations_and_their_sum() {
    let readme = include_str!("../../README.md");
    let mut rows = String::new();
    let mut sums = [0.0; 2];
    for (relation, [f32, fixed, _]) in BOUNDS {
        rows += &format!("| {relation} | {f32:e} | {fixed:e} |\n");
        sums = [sums[0] + f32, sums[1] + fixed];
    }
    rows += &format!("| sum | {:.1e} | {:.1e} |\n", sums[0], sums[1]);
    assert!(readme.contains(&rows), "vm-nostd/README.md should have\n{rows}");
}

#[test]
fn errors_of_held_forces_are_within_the_sum_of_the_bounds_or_in_fixed_point_within_1e_5() {
    fn steady_force<S: Scalar>(activation: f64, path: f64) -> f64 {
        let muscle = ContinuousMuscle::<S, 2>::build(&PAPER_MUSCLE, TimeStep::MILLISECOND).unwrap();
        let path = S::path_length(path);
        let mut state = muscle.rest(path).unwrap();
        let input = Input {
            activation: S::from_f64(activation),
            path_length: path,
            stimulation_frequency: S::quantity(0.0),
        };
        let force = (0..3000).map(|_| muscle.step(&mut state, input).force).last();
        S::newtons(force.unwrap()) / S::newtons(muscle.max_isometric_force())
    }
    let sum = |column: usize| BOUNDS.iter().map(|(_, bounds)| bounds[column]).sum::<f64>();
    let (mut f32, mut fixed) = (0.0_f64, 0.0_f64);
    for activation in spaced(0.0, 1.0, 10).into_iter().map(shared) {
        for path in [0.14, 0.16, 0.18].map(|path| f64::from(path as f32)) {
            let exact = steady_force::<f64>(activation, path);
            f32 = f32.max((steady_force::<f32>(activation, path) - exact).abs());
            fixed = fixed.max((steady_force::<Fixed>(activation, path) - exact).abs());
        }
    }
    assert!(f32 <= sum(0), "f32: {f32:e} > {:e}", sum(0));
    // Their balance is rounded as well, by more than the sum leaves in fixed point.
    assert!(fixed <= 1e-5, "fixed: {fixed:e}");
    let readme = include_str!("../../README.md");
    assert!(readme.contains("at most the sum, in fixed point by 1e-5"));
}
