//! Kernels in `f64`, from `libm`. The oracle is the standard library's: its own error, below an
//! ULP, is part of the bounds.

use super::arguments::{Arguments, Random};
use super::single::{logistic, response, softplus, weibull};
use super::{Row, Unit};
use crate::scalar::Kernels;
use crate::scalar::float::{one_minus_exp, square_root, tangent};

const fn row(
    kernel: &'static str,
    range: &'static str,
    bound: f64,
    error: fn(Unit, i64) -> f64,
) -> Row {
    let (arguments, unit) = (Arguments::Random(1_000_000), Unit::Relative);
    Row { arithmetic: "f64", kernel, range, arguments, bound, unit, error }
}

/// A number between two.
fn between(seed: i64, least: f64, most: f64) -> f64 {
    Random::new(seed).between(least, most)
}

pub(super) const ROWS: [Row; 8] = [
    row("exp", "-40..40", 4e-16, |unit, seed| {
        let x = between(seed, -40.0, 40.0);
        unit.of(Kernels::exp(x), x.exp())
    }),
    row("ln", "1e-30..1e30", 4e-16, |unit, seed| {
        let x = Random::new(seed).magnitude(1e-30, 1e30);
        unit.of(Kernels::ln(x), x.ln())
    }),
    row("softplus", "-40..40", 5e-16, |unit, seed| {
        let x = between(seed, -40.0, 40.0);
        unit.of(x.softplus().0, softplus(x))
    }),
    row("slope of softplus", "-40..40", 5e-16, |unit, seed| {
        let x = between(seed, -40.0, 40.0);
        unit.of(x.softplus().1, logistic(x))
    }),
    row("1 - exp(-exp x)", "-40..5", 5e-16, |unit, seed| {
        let x = between(seed, -40.0, 5.0);
        unit.of(x.weibull(), weibull(x))
    }),
    row("1 - exp(-x)", "1e-12..40", 4e-16, |unit, seed| {
        let x = Random::new(seed).magnitude(1e-12, 40.0);
        unit.of(one_minus_exp(x), response(x))
    }),
    row("square root", "1e-30..1e30", 0.0, |unit, seed| {
        let x = Random::new(seed).magnitude(1e-30, 1e30);
        unit.of(square_root(x), x.sqrt())
    }),
    row("tan", "1e-6..1.5", 4e-16, |unit, seed| {
        let x = Random::new(seed).magnitude(1e-6, 1.5);
        unit.of(tangent(x), x.tan())
    }),
];
