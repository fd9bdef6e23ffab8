//! The public curves of a built muscle against the paper's equations in `f64`.

use vm_nostd::{ContinuousMuscle, FiberType, Fixed, Scalar, TimeStep};
use vm_nostd_cores::MUSCLE;

/// Error bounds in `f32`, fixed point and `f64`, from the README's table of kernel errors. The
/// tendon's length is path minus fascicle length: one ULP of a length of 0.9 L_ce0, 6e-8, is
/// 9e-6 F0 in this muscle's tendon, whose stiffness is 152 F0/L_ce0. Two lengths are rounded in
/// `f32`, one in fixed point.
const BOUNDS: [(&str, [f64; 3]); 6] = [
    ("F_se", [1.8e-5, 9e-6, 4e-14]),
    ("F_pe1", [8e-7, 5.3e-7, 3.9e-15]),
    ("F_pe2", [5e-7, 4e-7, 3.3e-15]),
    ("FL", [3.9e-6, 1.8e-6, 1.8e-6]),
    ("FV", [9.7e-7, 2.8e-6, 3.1e-15]),
    ("Af", [3.7e-6, 1.2e-6, 2.3e-15]),
];

/// Rounds to a number that all arithmetics represent exactly.
fn shared(value: f64) -> f64 {
    (value * 1_048_576.0).round() / 1_048_576.0
}

fn softplus(x: f64) -> f64 {
    (x.exp() + 1.0).ln()
}

fn papers_fl(t: &FiberType, l: f64) -> f64 {
    let p = &t.force_length;
    (-((l.powf(p.skewness) - 1.0) / p.width).abs().powf(p.roundness)).exp()
}

fn papers_fv(t: &FiberType, l: f64, v: f64) -> f64 {
    let p = &t.force_velocity;
    let [c0, c1] = p.shortening;
    let [a0, a1, a2] = p.lengthening;
    if v <= 0.0 {
        ((p.maximum_velocity - v) / (p.maximum_velocity + (c0 + c1 * l) * v)).max(0.0)
    } else {
        let b = p.lengthening_velocity;
        (b - (a0 + a1 * l + a2 * l * l) * v) / (b + v)
    }
}

fn papers_af(t: &FiberType, l: f64, f: f64) -> f64 {
    let p = &t.activation;
    let n = p.exponent + p.length_dependence * (1.0 / l - 1.0);
    1.0 - (-(f / (p.scale * n)).powf(n)).exp()
}

/// Largest errors of the six curves, relative where a curve exceeds 1.
fn worst<S: Scalar>() -> [f64; 6] {
    let muscle = ContinuousMuscle::<S, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("a muscle");
    let curves = muscle.curves();
    let mut worst = [0.0; 6];
    let mut see = |curve: usize, found: S, exact: f64| {
        let off = (found.to_f64() - exact).abs() / exact.abs().max(1.0);
        assert!(off.is_finite(), "{}: {found:?} {exact}", BOUNDS[curve].0);
        worst[curve] = f64::max(worst[curve], off);
    };
    let (e, longest) = (&MUSCLE.elements, MUSCLE.maximum_fascicle_length());
    let (shortest, most) = MUSCLE.fascicle_domain();
    let number = S::from_f64;
    for step in 1..200 {
        let l = shared(shortest + (most - shortest) * f64::from(step) / 200.0);
        let (p, c) = (&e.parallel, &e.compression);
        let f_pe1 = p.stiffness * p.toe * softplus((l / longest - p.slack_length) / p.toe);
        see(1, curves.passive(number(l)), f_pe1);
        let f_pe2 = (c.strength * ((c.steepness * (l - c.onset_length)).exp() - 1.0)).min(0.0);
        see(2, curves.compression(number(l)), f_pe2);
        for (index, fiber) in MUSCLE.fibers.iter().enumerate() {
            let (t, fiber_curves) = (&fiber.fiber_type, curves.fiber(index).expect("a type"));
            see(3, fiber_curves.force_length(number(l)), papers_fl(t, l));
            for part in 0..=100 {
                let v = shared(-8.0 + 0.16 * f64::from(part));
                // Near its pole at the end of the range FV magnifies the rounding of L.
                if l > shortest + 0.05 {
                    see(4, fiber_curves.force_velocity(number(l), number(v)), papers_fv(t, l, v));
                }
                let f = shared(0.04 * f64::from(part));
                see(5, fiber_curves.activation_frequency(number(l), number(f)), papers_af(t, l, f));
            }
        }
    }
    // From a slack tendon to one at F0.
    let t = &e.tendon;
    for step in 0..=100 {
        let (l, stretch) = (shared(0.9), 0.9 + 0.15 * f64::from(step) / 100.0);
        let path = S::path_length(l * MUSCLE.fascicle_length + stretch * MUSCLE.tendon_length);
        let stretch = (S::path_metres(path) - l * MUSCLE.fascicle_length) / MUSCLE.tendon_length;
        let f_se = t.stiffness * t.toe * softplus((stretch - t.slack_length) / t.toe);
        see(0, curves.tendon(path, number(l)), f_se);
    }
    assert!(curves.fiber(2).is_none());
    worst
}

#[test]
fn curves_agree_with_the_papers_equations() {
    let worst = [worst::<f32>(), worst::<Fixed>(), worst::<f64>()];
    for (curve, (name, bounds)) in BOUNDS.into_iter().enumerate() {
        for (worst, bound) in worst.iter().zip(bounds) {
            assert!(worst[curve] <= bound, "{name}: {:e} > {bound:e}", worst[curve]);
        }
    }
}

#[test]
fn curves_are_clamped_beyond_their_ranges() {
    let muscle = ContinuousMuscle::<f32, 2>::build(&MUSCLE, TimeStep::MILLISECOND).expect("valid");
    let fiber_curves = muscle.curves().fiber(1).expect("a type");
    let (shortest, longest) = MUSCLE.fascicle_domain();
    for (beyond, edge) in [(0.0, shortest as f32), (9.0, longest as f32)] {
        assert_eq!(fiber_curves.force_length(beyond), fiber_curves.force_length(edge));
        assert_eq!(
            fiber_curves.force_velocity(beyond, -1.0),
            fiber_curves.force_velocity(edge, -1.0)
        );
        let activation = |length| fiber_curves.activation_frequency(length, 1.0);
        assert_eq!(activation(beyond), activation(edge));
    }
    assert_eq!(fiber_curves.force_velocity(1.0, -1e9), 0.0);
    assert_eq!(fiber_curves.force_velocity(1.0, 1e9), fiber_curves.force_velocity(1.0, 60.0));
    assert_eq!(fiber_curves.activation_frequency(1.0, -1.0), 0.0);
}
