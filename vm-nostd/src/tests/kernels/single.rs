//! Kernels in `f32`.

use super::arguments::{Arguments, Random, f32_at};
use super::{Row, Unit};
use crate::scalar::float::single_square_root;
use crate::scalar::{Kernels, WideState};

/// The least argument of relative bounds: below it, halves and products of the argument are
/// subnormal.
const TINY: f32 = 1e-30;

/// A kernel of one argument in a range.
const fn row(
    kernel: &'static str,
    range: &'static str,
    (least, most): (f32, f32),
    bound: f64,
    unit: Unit,
    error: fn(Unit, i64) -> f64,
) -> Row {
    let arguments = Arguments::Floats(least, most);
    Row { arithmetic: "f32", kernel, range, arguments, bound, unit, error }
}

/// A kernel of several arguments.
const fn sampled(
    kernel: &'static str,
    range: &'static str,
    bound: f64,
    error: fn(Unit, i64) -> f64,
) -> Row {
    let (arguments, unit) = (Arguments::Random(2_000_000), Unit::Relative);
    Row { arithmetic: "f32", kernel, range, arguments, bound, unit, error }
}

pub(super) const ROWS: [Row; 18] = [
    row("exp", "-87..88", (-87.0, 88.0), 2.2e-7, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(Kernels::exp(x).into(), f64::from(x).exp())
    }),
    row(
        "ln",
        "1.2e-38..3.4e38",
        (f32::MIN_POSITIVE, f32::MAX),
        1.5e-7,
        Unit::Mixed,
        |unit, place| {
            let x = f32_at(place);
            unit.of(Kernels::ln(x).into(), f64::from(x).ln())
        },
    ),
    row("softplus", "-87..3.4e38", (-87.0, f32::MAX), 4e-7, Unit::Mixed, |unit, place| {
        let x = f32_at(place);
        unit.of(Kernels::softplus(x).0.into(), softplus(x.into()))
    }),
    row("softplus", "-87..88", (-87.0, 88.0), 2.5e-6, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(Kernels::softplus(x).0.into(), softplus(x.into()))
    }),
    row(
        "slope of softplus",
        "-3.4e38..3.4e38",
        (-f32::MAX, f32::MAX),
        2e-5,
        Unit::Absolute,
        |unit, place| {
            let x = f32_at(place);
            unit.of(Kernels::softplus(x).1.into(), logistic(x.into()))
        },
    ),
    row("1 - exp(-exp x)", "-14.8..3", (-14.8, 3.0), 4e-6, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(Kernels::weibull(x).into(), weibull(x.into()))
    }),
    row("1 - exp(-exp x)", "-4e37..4e37", (-4e37, 4e37), 4e-6, Unit::Absolute, |unit, place| {
        let x = f32_at(place);
        unit.of(Kernels::weibull(x).into(), weibull(x.into()))
    }),
    row("1 - exp(-x)", "1e-30..8", (TINY, 8.0), 4e-7, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(x.lag_response().into(), response(x.into()))
    }),
    row("1 - exp(-x)", "0..3e38", (0.0, 3e38), 4e-4, Unit::Absolute, |unit, place| {
        let x = f32_at(place);
        unit.of(x.lag_response().into(), response(x.into()))
    }),
    row("1 - exp(-x/2), short", "1e-30..2.5", (TINY, 2.5), 5e-7, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(x.lags()[0].response.into(), response(0.5 * f64::from(x)))
    }),
    row("two lags in series", "1e-30..2.5", (TINY, 2.5), 3.2e-6, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        let exact = [0.5 * f64::from(x), f64::from(x)];
        x.lags().into_iter().zip(exact).fold(0.0, |largest, (lags, x)| {
            let response = unit.of(lags.response.into(), response(x));
            let delayed = unit.of(lags.delayed.into(), x * (-x).exp());
            larger(larger(largest, response), delayed)
        })
    }),
    row("square root", "1e-37..3.4e38", (1e-37, f32::MAX), 5e-5, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        let (found, exact) = (f64::from(single_square_root(x)), f64::from(x).sqrt());
        // Never too small.
        if found >= exact { unit.of(found, exact) } else { f64::NAN }
    }),
    row("reciprocal", "1e-37..1e37", (1e-37, 1e37), 6e-8, Unit::Relative, |unit, place| {
        let x = f32_at(place);
        unit.of(x.reciprocal().into(), 1.0 / f64::from(x))
    }),
    sampled("division", "magnitudes 1e-12..1e12", 6e-8, |unit, seed| {
        let [a, b] = magnitudes(seed);
        unit.of(a.ratio(b).into(), f64::from(a) / f64::from(b))
    }),
    sampled("divisions by one reciprocal", "magnitudes 1e-12..1e12", 3e-7, |unit, seed| {
        let [a, b, c, d] = magnitudes(seed);
        let found = f32::ratios([a, b], [c, d]);
        let exact = [f64::from(a) / f64::from(c), f64::from(b) / f64::from(d)];
        larger(unit.of(found[0].into(), exact[0]), unit.of(found[1].into(), exact[1]))
    }),
    sampled("reciprocals by one", "magnitudes 1e-12..1e12", 2.4e-7, |unit, seed| {
        let [a, b] = magnitudes(seed);
        let found = f32::reciprocals([a, b]);
        let exact = [1.0 / f64::from(a), 1.0 / f64::from(b)];
        larger(unit.of(found[0].into(), exact[0]), unit.of(found[1].into(), exact[1]))
    }),
    sampled("1/(1 + d v)", "1 + d v in 0.5..100", 3e-7, |unit, seed| {
        let mut random = Random::new(seed);
        let v = random.between(-60.0, 60.0) as f32;
        let [d, e] = [(); 2].map(|()| (random.between(-0.5, 99.0) / f64::from(v)) as f32);
        let found = v.reciprocals_of_one_plus([d, e]);
        let exact = [d, e].map(|d| 1.0 / (1.0 + f64::from(d) * f64::from(v)));
        larger(unit.of(found[0].into(), exact[0]), unit.of(found[1].into(), exact[1]))
    }),
    sampled("polynomial of 8 terms, to their sum", "-1..1", 4e-7, |_, seed| {
        let mut random = Random::new(seed);
        let terms: [f32; 8] = std::array::from_fn(|_| random.between(-12.0, 12.0) as f32);
        let x = random.between(-1.0, 1.0) as f32;
        let [found] = x.polynomials([&terms]);
        let sum = |x: f64, term: fn(f64) -> f64| {
            terms.iter().rev().fold(0.0, |sum, t| term(f64::from(*t)) + sum * x)
        };
        let x = f64::from(x);
        // Relative to the sum of magnitudes.
        (f64::from(found) - sum(x, |t| t)).abs() / sum(x.abs(), f64::abs)
    }),
];

/// The larger; NaN if the second is NaN or the first.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

fn magnitudes<const N: usize>(seed: i64) -> [f32; N] {
    let mut random = Random::new(seed);
    std::array::from_fn(|_| random.magnitude(1e-12, 1e12) as f32)
}

/// ln(e^x + 1).
pub(super) fn softplus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// 1/(1 + e^-x).
pub(super) fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// 1 - e^-e^x.
pub(super) fn weibull(x: f64) -> f64 {
    -(-x.exp()).exp_m1()
}

/// 1 - e^-x.
pub(super) fn response(x: f64) -> f64 {
    -(-x).exp_m1()
}
