//! Kernels in fixed point. Arguments are Q8.24, from -128 to 128.

use super::arguments::{Arguments, Random};
use super::single::{larger, logistic, response, softplus, weibull};
use super::{Row, Unit};
use crate::scalar::fixed::{Fixed, SPAN_BITS, fixed_square_root};
use crate::scalar::{Arithmetic, Factors, Kernels, Scalar, WideState};

const ALL: Arguments = Arguments::Bits(i32::MIN as i64, i32::MAX as i64);
const POSITIVE: Arguments = Arguments::Bits(1, i32::MAX as i64);
const RANDOM: Arguments = Arguments::Random(1_000_000);

const fn row(
    kernel: &'static str,
    range: &'static str,
    arguments: Arguments,
    bound: f64,
    unit: Unit,
    error: fn(Unit, i64) -> f64,
) -> Row {
    Row { arithmetic: "fixed", kernel, range, arguments, bound, unit, error }
}

/// The number of some bits, and its value.
fn number(bits: i64) -> (Fixed, f64) {
    let x = Fixed::from_bits(bits as i32);
    (x, x.to_f64())
}

/// An exact value, saturated.
fn saturated(exact: f64) -> f64 {
    exact.clamp(Fixed::from_bits(i32::MIN).to_f64(), Fixed::from_bits(i32::MAX).to_f64())
}

/// Numbers of any magnitude.
fn numbers<const N: usize>(seed: i64) -> [(Fixed, f64); N] {
    let mut random = Random::new(seed);
    std::array::from_fn(|_| number(random.number().into()))
}

pub(super) const ROWS: [Row; 22] = [
    row("exp", "all", ALL, 1.0, Unit::MixedUlp, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.exp().to_f64(), saturated(exact.exp()))
    }),
    row(
        "1 - exp(-x)",
        "0..128",
        Arguments::Bits(0, i32::MAX as i64),
        8.0,
        Unit::ShareUlp,
        |unit, bits| {
            // As a share.
            let (x, exact) = number(bits);
            unit.of(share(x.lag_response()), response(exact))
        },
    ),
    row(
        "two lags in series",
        "0..2.5",
        Arguments::Bits(0, 80 << 24),
        20.0,
        Unit::ShareUlp,
        |unit, bits| {
            let (x, exact) = number(bits);
            let exact = exact / f64::from(1 << SPAN_BITS);
            x.lags().into_iter().zip([0.5 * exact, exact]).fold(0.0, |largest, (lags, x)| {
                let response = unit.of(share(lags.response), response(x));
                let delayed = unit.of(share(lags.delayed), x * (-x).exp());
                larger(larger(largest, response), delayed)
            })
        },
    ),
    row("ln", "positive", POSITIVE, 1.0, Unit::Ulp, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.ln().to_f64(), exact.ln())
    }),
    row("ln of a product", "positive", RANDOM, 1.0, Unit::Ulp, |unit, seed| {
        let [(a, exact_a), (b, exact_b)] = numbers(seed);
        let product = exact_a * exact_b;
        let positive = exact_a > 0.0 && exact_b > 0.0;
        if positive { unit.of(a.ln_of_product(b).to_f64(), product.ln()) } else { 0.0 }
    }),
    row("softplus", "all", ALL, 2.0, Unit::Ulp, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.softplus().0.to_f64(), saturated(softplus(exact)))
    }),
    row("slope of softplus", "all", ALL, 2.1e-6, Unit::Absolute, |unit, bits| {
        let (x, exact) = number(bits);
        let slope = f64::from(x.softplus().1.to_bits()) * 2_f64.powi(-31);
        unit.of(slope, logistic(exact))
    }),
    row("1 - exp(-exp x)", "all", ALL, 16.0, Unit::Ulp, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.weibull().to_f64(), weibull(exact))
    }),
    row("reciprocal", "positive", POSITIVE, 1.0, Unit::MixedUlp, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.reciprocal().to_f64(), saturated(1.0 / exact))
    }),
    row("reciprocal as a factor", "positive", POSITIVE, 2.5e-9, Unit::Relative, |unit, bits| {
        let (x, exact) = number(bits);
        unit.of(x.reciprocal_factor().value(), 1.0 / exact)
    }),
    row("division", "divisor positive", RANDOM, 1.0, Unit::MixedUlp, |unit, seed| {
        let [(a, dividend), (b, divisor)] = numbers(seed);
        let positive = divisor > 0.0;
        if positive { unit.of(a.ratio(b).to_f64(), saturated(dividend / divisor)) } else { 0.0 }
    }),
    row("1/(1 + d v)", "1 + d v in 2^-7..", RANDOM, 1.0, Unit::MixedUlp, |unit, seed| {
        let [(d, exact_d), (e, exact_e), (v, exact_v)] = numbers(seed);
        let sums = [1.0 + exact_d * exact_v, 1.0 + exact_e * exact_v];
        let found = v.reciprocals_of_one_plus([d, e]);
        found.into_iter().zip(sums).fold(0.0, |largest, (found, sum)| {
            // Below 2^-7 the sum is clamped.
            if sum < 1.0 / 128.0 {
                return largest;
            }
            larger(largest, unit.of(found.to_f64(), saturated(1.0 / sum)))
        })
    }),
    row(
        "1/(1 + d v), clamped",
        "1 + d v below 2^-7",
        RANDOM,
        0.25,
        Unit::Absolute,
        |unit, seed| {
            let [(d, exact_d), (v, exact_v)] = numbers(seed);
            let [found, _] = v.reciprocals_of_one_plus([d, v]);
            let below = 1.0 + exact_d * exact_v < 1.0 / 128.0;
            if below { unit.of(found.to_f64(), 128.0) } else { 0.0 }
        },
    ),
    row("polynomial of 8 terms", "-1..1", RANDOM, 16.0, Unit::Ulp, |unit, seed| {
        let mut random = Random::new(seed);
        let terms: [Fixed; 8] = std::array::from_fn(|_| Fixed::from_bits(random.number() >> 4));
        let (x, exact) = number((random.number() >> 7).into());
        let [found] = x.polynomials([&terms]);
        let sum = terms.iter().rev().fold(0.0, |sum, term| term.to_f64() + sum * exact);
        unit.of(found.to_f64(), sum)
    }),
    row("square root, beyond 1 unit", "1..2^60", RANDOM, 2.5e-8, Unit::Relative, |_, seed| {
        let x = Random::new(seed).wide();
        let (found, exact) = (f64::from(fixed_square_root(x)), (x as f64).sqrt());
        // Beyond one unit of rounding.
        ((found - exact).abs() - 1.0).max(0.0) / exact
    }),
    row("product", "not saturated", RANDOM, 1.0, Unit::Ulp, |unit, seed| {
        let [(a, x), (b, y)] = numbers(seed);
        let exact = x * y;
        // On overflow it is within 255 ULP of the limit.
        if saturated(exact) == exact { unit.of((a * b).to_f64(), exact) } else { 0.0 }
    }),
    row("product to nearest", "not saturated", RANDOM, 0.6, Unit::Ulp, |unit, seed| {
        let [(a, x), (b, y)] = numbers(seed);
        let exact = x * y;
        // On overflow it is within 255 ULP of the limit.
        if saturated(exact) == exact { unit.of(a.times(b).to_f64(), exact) } else { 0.0 }
    }),
    row(
        "product with a factor",
        "factors 2^-20..2^20",
        RANDOM,
        0.6,
        Unit::MixedUlp,
        |unit, seed| {
            let mut random = Random::new(seed);
            let (x, exact) = number(random.number().into());
            let factor = random.magnitude(2_f64.powi(-20), 2_f64.powi(20));
            unit.of(x.scaled(&Fixed::factor(factor)).to_f64(), saturated(exact * factor))
        },
    ),
    row("product with a part", "parts -1/2..1/2", RANDOM, 1.5, Unit::Ulp, |unit, seed| {
        let mut random = Random::new(seed);
        let (x, exact) = number(random.number().into());
        let part = random.between(-0.5, 0.5);
        unit.of(x.portion(Fixed::part(part)).to_f64(), exact * part)
    }),
    row("rounded product with a part", "parts -1/2..1/2", RANDOM, 1.0, Unit::Ulp, |unit, seed| {
        let mut random = Random::new(seed);
        let (x, exact) = number(random.number().into());
        let part = random.between(-0.5, 0.5);
        unit.of(x.rounded_portion(Fixed::part(part)).to_f64(), exact * part)
    }),
    row("product with a unit", "units 0..1", RANDOM, 2.0, Unit::MixedUlp, |unit, seed| {
        let mut random = Random::new(seed);
        let (x, exact) = number(random.number().into());
        let (share, value) = number((random.number() & 0xff_ffff).into());
        unit.of(x.by(share.unit()).to_f64(), exact * value)
    }),
    row("step of a lag", "shares 0..1", RANDOM, 1.0, Unit::Ulp, |unit, seed| {
        let mut random = Random::new(seed);
        let [(state, from), (difference, change)] =
            [(); 2].map(|()| number((random.number() >> 1).into()));
        let share = random.between(0.0, 1.0);
        let moved = Fixed::advanced(state.wide(), difference, Fixed::share(share));
        unit.of(Fixed::of(moved).to_f64(), from + change * share)
    }),
];

/// The value of a share.
fn share(share: <Fixed as WideState>::Share) -> f64 {
    f64::from(share.to_bits()) * 2_f64.powi(-32)
}
