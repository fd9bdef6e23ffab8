//! Floating point: the same portable code on host and target.

mod double;
mod single;
#[cfg(test)]
mod tests;

use super::constant::Constant;
use super::sealed::Sealed;
use super::{
    Arithmetic, Balance, Conversions, Factors, Kernels, Lags, Representation, Scalar, WideState,
};

/// `f64` functions that are used when a muscle is built.
pub(crate) use double::{one_minus_exp, square_root, tangent};
#[cfg(test)]
pub(crate) use single::square_root as single_square_root;

macro_rules! float {
    ($float:ty, $bits:ty, $precision:ident, $arithmetic:literal) => {
        impl Sealed for $float {}

        impl Representation for $float {
            type Bits = $bits;
            type Wide = Self;
            type PathLength = Self;
            type Quantity = Self;
            type Force = Self;
        }

        impl Arithmetic for $float {
            const HALF: Self = 0.5;
            const LEAST: Self = 1e-36;
            const SIDE_BY_SIDE: bool = true;

            #[inline(always)]
            fn constant(constant: &Constant) -> Self {
                constant.$precision
            }
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
            fn is_saturated(self) -> bool {
                self == Self::INFINITY
            }
            #[inline(always)]
            fn times(self, other: Self) -> Self {
                self * other
            }
            fn half(self) -> Self {
                0.5 * self
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
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
        }

        impl Factors for $float {
            type Factor = Self;
            type Part = Self;
            type Unit = Self;

            const MINUS_HALF: Self = -0.5;

            fn factor(value: f64) -> Self {
                value as Self
            }
            fn scaled(self, factor: &Self) -> Self {
                self * factor
            }
            fn part(value: f64) -> Self {
                value as Self
            }
            #[inline(always)]
            fn part_constant(constant: &Constant) -> Self {
                constant.$precision
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
        }

        impl Kernels for $float {
            fn ratio(self, divisor: Self) -> Self {
                self / divisor
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
            fn reciprocal(self) -> Self {
                1.0 / self
            }
            fn reciprocal_factor(self) -> Self {
                1.0 / self
            }
            #[inline(always)]
            fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N] {
                Self::reciprocals(factors.map(|factor| 1.0 + factor * self))
            }

            #[inline(always)]
            fn exp(self) -> Self {
                $precision::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $precision::ln(self)
            }
            #[inline(always)]
            fn ln_of_product(self, factor: Self) -> Self {
                $precision::ln(self * factor)
            }
            #[inline(always)]
            fn softplus(self) -> (Self, Self) {
                $precision::softplus(self)
            }
            #[inline(always)]
            fn weibull(self) -> Self {
                $precision::weibull(self)
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
                let root = $precision::square_root(discriminant);
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
        }

        impl WideState for $float {
            type Share = Self;

            fn advanced(state: Self, difference: Self, share: Self) -> Self {
                state + difference * share
            }
            fn advanced_by_two(state: Self, first: (Self, Self), second: (Self, Self)) -> Self {
                // Adds the changes first: those of a slow lag are far below the ULP of its value.
                state + (first.0 * first.1 + second.0 * second.1)
            }
            #[inline(always)]
            fn stretched(extension: Self, stretch: Self, travel: Self, tick: Self) -> Self {
                extension + stretch - travel * tick
            }
            fn share(value: f64) -> Self {
                value as Self
            }
            fn lag_response(self) -> Self {
                $precision::one_minus_exp(self)
            }
            #[inline(always)]
            fn span(self) -> Self {
                self
            }
            /// In `f32` the relative error of each is below 3.2e-6.
            #[inline(always)]
            fn lags(self) -> [Lags<Self>; 2] {
                let half = self * 0.5;
                let response_at_half = $precision::short_lag_response(half);
                let response = response_at_half * (2.0 - response_at_half);
                [
                    Lags { response: response_at_half, delayed: half * (1.0 - response_at_half) },
                    Lags { response, delayed: self * (1.0 - response) },
                ]
            }
            fn wide_words(state: Self) -> impl Iterator<Item = Self::Bits> {
                core::iter::once(state.to_bits())
            }
            fn wide_from_words(words: &mut impl Iterator<Item = Self::Bits>) -> Option<Self> {
                words.next().map(<$float>::from_bits)
            }
        }

        impl Conversions for $float {
            const ARITHMETIC: u32 = $arithmetic;
            const LARGEST_COEFFICIENT: f64 = f64::MAX;
            const MAXIMAL_FORCES: (f64, f64) = (0.0, f64::MAX);
            const FORCE_STEP: f64 = 0.0;
            const LONGEST_PATH: f64 = f64::MAX;

            fn path_is_finite(path: Self) -> bool {
                path.is_finite()
            }
            fn per_metre(value: f64) -> Self {
                value as Self
            }
            fn path_difference(path: Self, other: Self, per_metre: &Self) -> Self {
                (path - other) * per_metre
            }
            #[inline(always)]
            fn path_change(path: Self, after: Self, _: Self, per_metre: &Self) -> Self {
                // Exact for paths within a factor of two; the positions would be rounded.
                Self::path_difference(after, path, per_metre)
            }
            fn path_towards(path: Self, end: Self, parts: u8) -> Self {
                path + (end - path) / Self::from(parts)
            }
            fn path_factor(metres: f64) -> Self {
                metres as Self
            }
            fn lengthened(path: Self, by: Self, factor: &Self) -> Self {
                path + by * factor
            }

            #[inline(always)]
            fn quantity_constant(constant: &Constant) -> Self {
                constant.$precision
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
            fn to_quantity(self, quantity_factor: &Self) -> Self {
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
        }

        impl Scalar for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

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

            fn wide(self) -> Self {
                self
            }
            fn of(state: Self) -> Self {
                state
            }

            fn path_length(metres: f64) -> Self {
                metres as Self
            }
            fn path_metres(path: Self) -> f64 {
                f64::from(path)
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

            fn newtons(force: Self) -> f64 {
                f64::from(force)
            }
            fn newtons_of(force: Self, _: Self, _: f64) -> f64 {
                f64::from(force)
            }
            fn of_share(self, force: Self) -> Self {
                self * force
            }
            fn force_bits(force: Self) -> Self::Bits {
                force.to_bits()
            }
        }
    };
}

float!(f32, u32, single, 1);
float!(f64, u64, double, 2);
