//! The root of the force balance, a kernel of five arguments. Where its terms cancel, an error of
//! the terms is amplified; the condition is that amplification.

use super::arguments::{Arguments, Random};
use super::single::larger;
use super::{Row, Unit};
use crate::scalar::Scalar;
use crate::scalar::fixed::Fixed;

const fn row(
    arithmetic: &'static str,
    kernel: &'static str,
    bound: f64,
    error: fn(Unit, i64) -> f64,
) -> Row {
    let (arguments, unit) = (Arguments::Random(1_000_000), Unit::Condition);
    let range = "of valid muscles";
    Row { arithmetic, kernel, range, arguments, bound, unit, error }
}

pub(super) const ROWS: [Row; 4] = [
    row("f32", "root of the force balance", 4.5e-5, |_, seed| {
        let (arguments, [root, _, _]) = solved::<f32>(seed, 20.0);
        let exact = Exact::of(arguments);
        (root - exact.root).abs() / exact.root.abs().max(1e-30) / exact.condition_of_root
    }),
    row("f32", "damping of the force balance", 4.5e-5, |_, seed| {
        let (arguments, [_, reciprocal, damped]) = solved::<f32>(seed, 20.0);
        let exact = Exact::of(arguments);
        let reciprocal = (reciprocal / exact.reciprocal - 1.0).abs();
        larger(reciprocal, (damped / exact.damped - 1.0).abs()) / exact.condition_of_damping
    }),
    row("fixed", "root of the force balance", 1.2e-7, |_, seed| {
        let (arguments, [root, _, _]) = solved::<Fixed>(seed, 3.0);
        let exact = Exact::of(arguments);
        let expected = exact.root.clamp(-128.0, 128.0);
        (root - expected).abs() / (1.0 + expected.abs()) / exact.condition_in_fixed
    }),
    row("fixed", "damping of the force balance", 1e-7, |_, seed| {
        let (arguments, [_, reciprocal, _]) = solved::<Fixed>(seed, 3.0);
        let exact = Exact::of(arguments);
        let expected = exact.reciprocal.min(128.0);
        (reciprocal - expected).abs() / (1.0 + expected) / exact.condition_in_fixed
    }),
];

/// Residual, line, steepness, half the curvature, inertia and viscosity.
type Balance = [f64; 6];

/// A random balance, as the arithmetic represents it, with its root, reciprocal and damping.
fn solved<S: Scalar>(seed: i64, most_bent: f64) -> (Balance, [f64; 3]) {
    let mut random = Random::new(seed);
    let line = random.magnitude(2e-3, 50.0);
    let steepness = random.magnitude(1e-5, 30.0);
    let bend = random.one_of([-3.0, -0.2, 0.0, 0.3, most_bent]);
    let residual = random.between(-5.0, 5.0);
    let rounded = [residual, line, steepness, -bend * steepness, 0.3, 0.01].map(S::from_f64);
    let [residual, line, steepness, half_curvature, inertia, viscosity] = rounded;
    let found = residual.hyperbola_root(line, steepness, half_curvature, inertia, viscosity);
    let damped = S::ONE.by(found.damped);
    (rounded.map(S::to_f64), [found.root, found.reciprocal, damped].map(S::to_f64))
}

/// The solution by the textbook's formula.
struct Exact {
    root: f64,
    reciprocal: f64,
    damped: f64,
    condition_of_root: f64,
    condition_of_damping: f64,
    condition_in_fixed: f64,
}

impl Exact {
    fn of([residual, line, steepness, half_curvature, inertia, viscosity]: Balance) -> Self {
        let (line_product, square, bent) =
            (steepness * line, steepness * steepness, residual * half_curvature);
        let linear = line_product + square - bent;
        let difference = line_product + bent - square;
        let discriminant = difference.hypot((4.0 * line_product * square).sqrt());
        let denominator = linear + discriminant;
        let secant_denominator = denominator + 2.0 * bent;
        let damping = viscosity + steepness * denominator / secant_denominator;
        let most = line_product + square + bent.abs();
        let total = (inertia + viscosity) * secant_denominator + steepness * denominator;
        let largest = most.max((residual * steepness).abs());
        Self {
            root: -2.0 * residual * steepness / denominator,
            reciprocal: 1.0 / (inertia + damping),
            damped: damping / (inertia + damping),
            condition_of_root: most / line_product,
            condition_of_damping: most / line_product + most / square,
            condition_in_fixed: 1.0
                + (largest + discriminant) / denominator.min(secant_denominator)
                + 64.0 * largest.max(2_f64.powi(-17)) / total,
        }
    }
}
