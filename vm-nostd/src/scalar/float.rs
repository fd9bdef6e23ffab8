//! Floating point: the same portable code on host and target.

mod double;
mod single;

use super::sealed::Sealed;
use super::{Lags, Scalar};

/// In `f64`, for computations when a muscle is built.
pub(crate) use double::{one_minus_exp, square_root, tangent};

macro_rules! float {
    ($float:ty, $bits:ty, $kernels:ident, $arithmetic:literal) => {
        impl Sealed for $float {}

        impl Scalar for $float {
            type Bits = $bits;
            type Factor = Self;
            type LagState = Self;
            type Share = Self;
            type PathLength = Self;
            type Quantity = Self;
            type Force = Self;

            const ARITHMETIC: u32 = $arithmetic;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const LEAST: Self = 1e-36;
            const LARGEST_COEFFICIENT: f64 = f64::MAX;
            const MAXIMAL_FORCES: (f64, f64) = (0.0, f64::MAX);
            const FORCE_STEP: f64 = 0.0;
            const LONGEST_PATH: f64 = f64::MAX;
            const SLOW_WORDS: usize = 1;

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
            fn ratio(self, divisor: Self) -> Self {
                self / divisor
            }

            fn half(self) -> Self {
                0.5 * self
            }
            #[inline(always)]
            fn polynomial<const N: usize>(self, terms: &[Self; N]) -> (Self, Self) {
                let [lower @ .., before, last] = terms.as_slice() else {
                    return (terms.iter().sum(), 0.0);
                };
                let (mut value, mut slope) = (before + last * self, *last);
                for term in lower.iter().rev() {
                    slope = value + slope * self;
                    value = term + value * self;
                }
                (value, slope)
            }

            fn reciprocal(self) -> Self {
                1.0 / self
            }
            fn reciprocal_factor(self) -> Self {
                1.0 / self
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
            fn weibull(self) -> (Self, Self) {
                $kernels::weibull(self)
            }
            fn reciprocal_of_one_plus(self, factor: Self) -> Self {
                1.0 / (1.0 + factor * self)
            }
            #[inline(always)]
            fn hyperbola_root(
                self,
                line: Self,
                steepness: Self,
                half_curvature: Self,
            ) -> (Self, Self) {
                // Times steepness² (1 + bend u) it is quadratic; bend = -half_curvature/steepness.
                let straight = steepness * line;
                let square = steepness * steepness;
                let bent = self * half_curvature;
                let linear = straight + square - bent;
                // linear² + 4 straight bent, as a sum of positive terms.
                let difference = straight + bent - square;
                let discriminant = difference * difference + 4.0 * straight * square;
                let root = $kernels::square_root(discriminant);
                // The root is at least |difference|: each sum is smaller only by rounding, and only
                // if both of its terms are large.
                let whole = Scalar::max(linear + root, 2.0 * straight);
                let after = Scalar::max(whole + 2.0 * bent, 2.0 * square);
                let reciprocal = 1.0 / (whole * after);
                (-2.0 * self * steepness * (after * reciprocal), whole * (whole * reciprocal))
            }

            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            fn lag_state(self) -> Self {
                self
            }
            fn of(slow: Self) -> Self {
                slow
            }
            fn advanced(slow: Self, difference: Self, share: Self) -> Self {
                slow + difference * share
            }
            fn advanced_by_two(slow: Self, first: (Self, Self), second: (Self, Self)) -> Self {
                // Compares changes: those of a slow lag are far below the ULP of its value.
                slow + (first.0 * first.1 + second.0 * second.1)
            }
            fn share(value: f64) -> Self {
                value as Self
            }
            fn lag_response(self) -> Self {
                $kernels::one_minus_exp(self)
            }
            /// In `f32` each within 3e-6 of its value.
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
            fn lag_state_words(slow: Self) -> impl Iterator<Item = Self::Bits> {
                core::iter::once(slow.to_bits())
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

    /// Calls `check` with a residual, a line, a steepness and half a curvature, over the ranges of
    /// valid muscles.
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
            let (root, share) = residual.hyperbola_root(line, steepness, half_curvature);
            let below = 1.0 - half_curvature / steepness * root;
            assert!(below > 0.0, "{residual} {line} {steepness} {half_curvature}: {root}");
            assert!((share * below - 1.0).abs() < 1e-4, "{share} {below}");
            let left = residual + line * root + steepness * share * root;
            assert!(left.abs() <= 1e-6 * residual.abs(), "{root}: {left} of {residual}");
        });
    }

    #[test]
    fn roots_in_f32_agree_with_f64_except_for_cancellation() {
        over_balances(|residual, line, steepness, half_curvature| {
            let [r, l, s, h] = [residual, line, steepness, half_curvature].map(|x| x as f32);
            let found = r.hyperbola_root(l, s, h);
            let [r, l, s, h] = [r, l, s, h].map(f64::from);
            let exact = r.hyperbola_root(l, s, h);
            // Next to a large product the line's term is rounded, and in the secant the steepness':
            // if the least steepness stands for 0, few of its bits remain.
            let bent = (r * h).abs();
            let of_root = 1e-5 * (1.0 + bent / (l * s));
            let of_share = of_root + 2.2e-6 * bent / (s * s);
            for (found, exact, bound) in [(found.0, exact.0, of_root), (found.1, exact.1, of_share)]
            {
                let relative = (f64::from(found) - exact).abs() / exact.abs().max(1e-30);
                assert!(relative <= bound, "{r} {l} {s} {h}: {found} {exact}");
            }
        });
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
