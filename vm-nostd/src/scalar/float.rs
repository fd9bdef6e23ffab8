//! Floating point: the same portable code on host and target.

mod double;
mod single;

use super::sealed::Sealed;
use super::{Balance, Lags, Scalar};

/// `f64` functions that are used when a muscle is built.
pub(crate) use double::{one_minus_exp, square_root, tangent};

macro_rules! float {
    ($float:ty, $bits:ty, $kernels:ident, $arithmetic:literal) => {
        impl Sealed for $float {}

        impl Scalar for $float {
            type Bits = $bits;
            type Factor = Self;
            type Part = Self;
            type Unit = Self;
            type LagState = Self;
            type Share = Self;
            type PathLength = Self;
            type Quantity = Self;
            type Force = Self;

            const ARITHMETIC: u32 = $arithmetic;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const MINUS_HALF: Self = -0.5;
            const LEAST: Self = 1e-36;
            const LARGEST_COEFFICIENT: f64 = f64::MAX;
            const SIDE_BY_SIDE: bool = true;
            const MAXIMAL_FORCES: (f64, f64) = (0.0, f64::MAX);
            const FORCE_STEP: f64 = 0.0;
            const LONGEST_PATH: f64 = f64::MAX;
            const LAG_STATE_WORDS: usize = 1;

            fn from_f64(value: f64) -> Self {
                value as Self
            }
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            fn to_bits(self) -> Self::Bits {
                <$float>::to_bits(self)
            }
            fn from_bits(bits: Self::Bits) -> Self {
                <$float>::from_bits(bits)
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            fn is_saturated(self) -> bool {
                self == Self::INFINITY
            }

            fn factor(value: f64) -> Self {
                value as Self
            }
            fn scaled(self, factor: &Self) -> Self {
                self * factor
            }
            fn part(value: f64) -> Self {
                value as Self
            }
            fn portion(self, part: Self) -> Self {
                self * part
            }
            fn rounded_portion(self, part: Self) -> Self {
                self * part
            }
            fn unit(self) -> Self {
                self
            }
            fn by(self, unit: Self) -> Self {
                self * unit
            }
            fn ratio(self, divisor: Self) -> Self {
                self / divisor
            }

            fn half(self) -> Self {
                0.5 * self
            }
            #[inline(always)]
            fn polynomials<const N: usize, const TERMS: usize>(
                self,
                terms: [&[Self; TERMS]; N],
            ) -> [Self; N] {
                let mut values = [0.0; N];
                for power in (0..TERMS).rev() {
                    for (value, terms) in values.iter_mut().zip(&terms) {
                        *value = terms[power] + *value * self;
                    }
                }
                values
            }

            fn reciprocal(self) -> Self {
                1.0 / self
            }
            fn reciprocal_factor(self) -> Self {
                1.0 / self
            }
            #[inline(always)]
            fn ratios<const N: usize>(dividends: [Self; N], divisors: [Self; N]) -> [Self; N] {
                let mut ratios = Self::reciprocals(divisors);
                for (ratio, dividend) in ratios.iter_mut().zip(dividends) {
                    *ratio *= dividend;
                }
                ratios
            }
            /// One division for all: each reciprocal is the reciprocal of the product of all
            /// numbers, times the product of the others.
            #[inline(always)]
            fn reciprocals<const N: usize>(numbers: [Self; N]) -> [Self; N] {
                let mut product = 1.0;
                let mut reciprocals = numbers.map(|number| {
                    let before = product;
                    product *= number;
                    before
                });
                let mut rest = 1.0 / product;
                for (reciprocal, number) in reciprocals.iter_mut().zip(&numbers).rev() {
                    *reciprocal *= rest;
                    rest *= number;
                }
                reciprocals
            }

            #[inline(always)]
            fn exp(self) -> Self {
                $kernels::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $kernels::ln(self)
            }
            #[inline(always)]
            fn softplus(self) -> (Self, Self) {
                $kernels::softplus(self)
            }
            #[inline(always)]
            fn weibull(self) -> Self {
                $kernels::weibull(self)
            }
            #[inline(always)]
            fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N] {
                Self::reciprocals(factors.map(|factor| 1.0 + factor * self))
            }
            #[inline(always)]
            fn is_between_0_and(self, end: Self) -> bool {
                self * (end - self) > 0.0
            }
            #[inline(always)]
            fn is_negative(self) -> bool {
                self.is_sign_negative()
            }
            #[inline(always)]
            fn of_sign(self, negative: bool) -> Self {
                if self.is_sign_negative() == negative { self } else { 0.0 }
            }
            #[inline(always)]
            fn hyperbola_root(
                self,
                line: Self,
                steepness: Self,
                half_curvature: Self,
                inertia: Self,
                viscosity: Self,
            ) -> Balance<Self> {
                // The balance times steepness (1 + bend u) is quadratic in u, with
                // bend = -half_curvature/steepness.
                let line_product = steepness * line;
                let square = steepness * steepness;
                let curvature_product = self * half_curvature;
                let linear = line_product + square - curvature_product;
                // linear² + 4 line_product curvature_product, written as a sum of positive terms.
                let difference = line_product + curvature_product - square;
                let discriminant = difference * difference + 4.0 * line_product * square;
                let root = $kernels::square_root(discriminant);
                // The root exceeds |difference| by more than the rounding errors: both denominators
                // are positive.
                let denominator = linear + root;
                let secant_denominator = denominator + 2.0 * curvature_product;
                // The secant is steepness denominator/secant_denominator. Both quotients share one
                // division.
                let damping = viscosity * secant_denominator + steepness * denominator;
                let total = inertia * secant_denominator + damping;
                let reciprocal = 1.0 / (denominator * total);
                let per_total = denominator * reciprocal;
                Balance {
                    root: -2.0 * self * steepness * (total * reciprocal),
                    damped: damping * per_total,
                    reciprocal: secant_denominator * per_total,
                }
            }

            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            fn lag_state(self) -> Self {
                self
            }
            fn of(state: Self) -> Self {
                state
            }
            fn advanced(state: Self, difference: Self, share: Self) -> Self {
                state + difference * share
            }
            fn advanced_by_two(state: Self, first: (Self, Self), second: (Self, Self)) -> Self {
                // Adds the changes first: those of a slow lag are far below the ULP of its value.
                state + (first.0 * first.1 + second.0 * second.1)
            }
            fn share(value: f64) -> Self {
                value as Self
            }
            fn lag_response(self) -> Self {
                $kernels::one_minus_exp(self)
            }
            /// In `f32` the relative error of each is below 3e-6.
            #[inline(always)]
            fn lags(self) -> [Lags<Self>; 2] {
                let half = self * 0.5;
                let response_at_half = $kernels::short_lag_response(half);
                let response = response_at_half * (2.0 - response_at_half);
                [
                    Lags { response: response_at_half, delayed: half * (1.0 - response_at_half) },
                    Lags { response, delayed: self * (1.0 - response) },
                ]
            }
            fn lag_state_words(state: Self) -> impl Iterator<Item = Self::Bits> {
                core::iter::once(state.to_bits())
            }
            fn lag_state_from_words(words: &mut impl Iterator<Item = Self::Bits>) -> Option<Self> {
                words.next().map(<$float>::from_bits)
            }

            fn path_length(metres: f64) -> Self {
                metres as Self
            }
            fn path_metres(path: Self) -> f64 {
                f64::from(path)
            }
            fn path_is_finite(path: Self) -> bool {
                path.is_finite()
            }
            fn per_metre(value: f64) -> Self {
                value as Self
            }
            fn path_difference(path: Self, other: Self, per_metre: &Self) -> Self {
                (path - other) * per_metre
            }
            fn path_factor(metres: f64) -> Self {
                metres as Self
            }
            fn lengthened(path: Self, by: Self, factor: &Self) -> Self {
                path + by * factor
            }
            fn path_bits(path: Self) -> Self::Bits {
                path.to_bits()
            }
            fn path_from_bits(bits: Self::Bits) -> Self {
                <$float>::from_bits(bits)
            }

            fn quantity(value: f64) -> Self {
                value as Self
            }
            fn quantity_value(quantity: Self) -> f64 {
                f64::from(quantity)
            }
            fn quantity_is_finite(quantity: Self) -> bool {
                quantity.is_finite()
            }
            fn per_quantity(value: f64) -> Self {
                value as Self
            }
            fn of_quantity(quantity: Self, per_unit: &Self) -> Self {
                quantity * per_unit
            }
            fn quantity_factor(value: f64) -> Self {
                value as Self
            }
            fn as_quantity(self, quantity_factor: &Self) -> Self {
                self * quantity_factor
            }

            fn force_factor(newtons: f64) -> Self {
                newtons as Self
            }
            fn force(self, force_factor: &Self) -> Self {
                self * force_factor
            }
            fn per_newton(value: f64) -> Self {
                value as Self
            }
            fn of_force(force: Self, per_newton: &Self) -> Self {
                force * per_newton
            }
            fn of_share(self, force: Self) -> Self {
                self * force
            }
            fn force_bits(force: Self) -> Self::Bits {
                force.to_bits()
            }
            fn newtons(force: Self) -> f64 {
                f64::from(force)
            }
            fn newtons_of(force: Self, _: Self, _: f64) -> f64 {
                f64::from(force)
            }
        }
    };
}

float!(f32, u32, single, 1);
float!(f64, u64, double, 2);

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls `check` with residual, line, steepness and half_curvature over the ranges of valid
    /// muscles.
    fn over_balances(check: impl Fn(f64, f64, f64, f64)) {
        for line in [2e-3, 0.05, 1.0, 50.0] {
            for steepness in [1e-5, 0.02, 1.0, 30.0] {
                for bend in [-3.0, -0.2, 0.0, 0.3, 20.0] {
                    for step in -500..=500 {
                        check(f64::from(step) * 0.01, line, steepness, -bend * steepness);
                    }
                }
            }
        }
    }

    #[test]
    fn roots_cancel_the_residual_on_the_branch_through_0() {
        over_balances(|residual, line, steepness, half_curvature| {
            let (inertia, viscosity) = (0.3, 0.01);
            let found =
                residual.hyperbola_root(line, steepness, half_curvature, inertia, viscosity);
            let root = found.root;
            let below = 1.0 - half_curvature / steepness * root;
            assert!(below > 0.0, "{residual} {line} {steepness} {half_curvature}: {root}");
            let secant = steepness / below;
            let error = residual + line * root + secant * root;
            assert!(error.abs() <= 1e-6 * residual.abs(), "{root}: {error} of {residual}");
            let damping = viscosity + secant;
            assert!((found.reciprocal * (inertia + damping) - 1.0).abs() < 1e-4, "{found:?}");
            assert!((found.damped - damping / (inertia + damping)).abs() < 1e-4, "{found:?}");
        });
    }

    #[test]
    fn roots_in_f32_agree_with_f64_except_for_cancellation() {
        over_balances(|residual, line, steepness, half_curvature| {
            let [r, l, s, h] = [residual, line, steepness, half_curvature].map(|x| x as f32);
            let found = r.hyperbola_root(l, s, h, 0.3, 0.01);
            let [r, l, s, h] = [r, l, s, h].map(f64::from);
            let exact = r.hyperbola_root(l, s, h, f64::from(0.3_f32), f64::from(0.01_f32));
            // The square root is up to 5e-5 too large. Bits are lost to cancellation where one
            // product is much larger than the line product (in the root) or than the square of the
            // steepness (in the secant), most if the steepness is at its lower bound.
            let bent = (r * h).abs();
            let most = s * l + s * s + bent;
            let of_root = 1.1e-4 * most / (s * l);
            let of_damping = 1.1e-4 * (most / (s * l) + most / (s * s));
            let relative =
                |found: f32, exact: f64| (f64::from(found) - exact).abs() / exact.abs().max(1e-30);
            for (error, bound) in [
                (relative(found.root, exact.root), of_root),
                (relative(found.damped, exact.damped), of_damping),
                (relative(found.reciprocal, exact.reciprocal), of_damping),
            ] {
                assert!(error <= bound, "{r} {l} {s} {h}: {found:?} {exact:?}");
            }
            assert!(found.root * residual as f32 <= 0.0 && (0.0..=1.0).contains(&found.damped));
        });
    }

    #[test]
    fn balances_of_extreme_numbers_are_finite() {
        let any = [0.0, 1e-30, 1e-8, 1e-3, 1.0, 30.0, 1e4, 1e7_f32];
        for residual in any.into_iter().flat_map(|x| [x, -x]) {
            for half_curvature in any.into_iter().flat_map(|x| [x, -x]) {
                for (line, steepness) in
                    any[3..7].iter().flat_map(|line| [3e-6, 1e-2, 3.0, 1e3].map(|s| (*line, s)))
                {
                    let found = residual.hyperbola_root(line, steepness, half_curvature, 1e-3, 0.0);
                    let what = format!("{residual} {line} {steepness} {half_curvature}: {found:?}");
                    assert!(found.root.is_finite() && found.root * residual <= 0.0, "{what}");
                    assert!((0.0..=1.000_001).contains(&found.damped), "{what}");
                    assert!(found.reciprocal >= 0.0 && found.reciprocal.is_finite(), "{what}");
                }
            }
        }
    }

    #[test]
    fn responses_of_two_lags_have_a_relative_error_below_3e_6() {
        for step in 1..=250_000 {
            let x = (f64::from(step) * 1e-5) as f32;
            for (lags, x) in x.lags().into_iter().zip([0.5 * f64::from(x), f64::from(x)]) {
                let found = [lags.response, lags.delayed].map(f64::from);
                for (found, exact) in found.into_iter().zip([-(-x).exp_m1(), x * (-x).exp()]) {
                    assert!((found / exact - 1.0).abs() <= 3e-6, "{x}: {found} {exact}");
                }
            }
        }
    }
}
