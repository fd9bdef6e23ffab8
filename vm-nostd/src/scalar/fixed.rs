//! Fixed point: Q8.24, and Q8.56 for the state of lags.

#[cfg(test)]
mod exhaustive;
mod exponential;
mod factor;
mod mantissa;
mod number;
mod part;
mod pieces;
mod polynomial;
mod product;
mod quotient;
mod root;
mod unit;

pub use factor::Factor;
pub use number::Fixed;
#[cfg(test)]
pub(crate) use number::saturations;
pub use part::Part;
pub use unit::Unit;

use super::sealed::Sealed;
use super::{Balance, Lags, Scalar};
use crate::summed::summed_numbers;
use factor::nearest;
use fixed::types::{I16F16, I23F9};
use number::ONE;

/// Units of [`I23F9`] in a metre.
const PATH_UNITS: f64 = 512e6;
const UNITS: f64 = (1 << 24) as f64;
const QUANTITY_UNITS: f64 = (1 << 16) as f64;
/// Q8.56 has 32 more fractional bits than Q8.24.
const LAG_SHIFT: u32 = 32;

impl Sealed for Fixed {}

summed_numbers! {
    Fixed: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
    I16F16: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
    I23F9: |number| number.to_bits().cast_unsigned(),
        |word| Some(Self::from_bits(word.cast_signed()));
}

impl Scalar for Fixed {
    type Bits = u32;
    type Factor = Factor;
    type Part = Part;
    type Unit = Unit;
    /// Q8.56.
    type LagState = i64;
    /// Q0.32.
    type Share = u32;
    /// µm, in steps of 2 nm, to 4.19 m.
    type PathLength = I23F9;
    type Quantity = I16F16;
    /// mN.
    type Force = i32;

    const ARITHMETIC: u32 = 3;
    const ZERO: Self = Self::from_bits(0);
    const ONE: Self = Self::from_bits(ONE);
    const HALF: Self = Self::from_bits(ONE / 2);
    const MINUS_HALF: Part = Part::MINUS_HALF;
    const LEAST: Self = Self::from_bits(1);
    const LARGEST_COEFFICIENT: f64 = 60.0;
    const SIDE_BY_SIDE: bool = false;
    const MAXIMAL_FORCES: (f64, f64) = (1.0, 16e3);
    const FORCE_STEP: f64 = 1e-3;
    const LONGEST_PATH: f64 = 4.19;
    const LAG_STATE_WORDS: usize = 2;

    fn from_f64(value: f64) -> Self {
        Self::from_bits(nearest(value * UNITS))
    }
    fn to_f64(self) -> f64 {
        f64::from(self.to_bits()) / UNITS
    }
    fn to_bits(self) -> u32 {
        self.to_bits() as u32
    }
    fn from_bits(bits: u32) -> Self {
        Self::from_bits(bits as i32)
    }
    fn is_finite(self) -> bool {
        true
    }
    #[inline(always)]
    fn is_saturated(self) -> bool {
        // A rounded sum can be one ULP lower.
        self >= Self::from_bits(i32::MAX - 1)
    }

    fn factor(value: f64) -> Factor {
        Factor::new(value)
    }
    #[inline(always)]
    fn scaled(self, factor: &Factor) -> Self {
        Self::from_bits(factor.times(self.to_bits()))
    }
    fn part(value: f64) -> Part {
        Part::new(value)
    }
    #[inline(always)]
    fn portion(self, part: Part) -> Self {
        Self::from_bits(part.of(self.to_bits()))
    }
    #[inline(always)]
    fn rounded_portion(self, part: Part) -> Self {
        Self::from_bits(part.rounded_of(self.to_bits()))
    }
    #[inline(always)]
    fn unit(self) -> Unit {
        Unit::new(self.to_bits())
    }
    #[inline(always)]
    fn by(self, unit: Unit) -> Self {
        Self::from_bits(unit.of(self.to_bits()))
    }
    fn ratio(self, divisor: Self) -> Self {
        self.scaled(&divisor.reciprocal_factor())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // Without a branch, and saturating for the least number.
        let sign = self.to_bits() >> 31;
        Self::from_bits((self.to_bits() ^ sign).saturating_sub(sign))
    }

    #[inline(always)]
    fn half(self) -> Self {
        Self::from_bits(self.to_bits() >> 1)
    }
    #[inline(always)]
    fn polynomials<const N: usize, const TERMS: usize>(
        self,
        terms: [&[Self; TERMS]; N],
    ) -> [Self; N] {
        let mut values = [Self::ZERO; N];
        for (value, terms) in values.iter_mut().zip(terms) {
            let terms = terms.iter().map(|t| t.to_bits());
            *value = Self::from_bits(polynomial::at(self.to_bits(), terms));
        }
        values
    }

    fn reciprocal(self) -> Self {
        Self::from_bits(quotient::reciprocal(self.to_bits()))
    }
    #[inline(always)]
    fn ratios<const N: usize>(mut dividends: [Self; N], divisors: [Self; N]) -> [Self; N] {
        for (dividend, divisor) in dividends.iter_mut().zip(divisors) {
            *dividend = dividend.ratio(divisor);
        }
        dividends
    }
    #[inline(always)]
    fn reciprocals<const N: usize>(mut numbers: [Self; N]) -> [Self; N] {
        for number in &mut numbers {
            *number = number.reciprocal();
        }
        numbers
    }
    fn reciprocal_factor(self) -> Factor {
        quotient::reciprocal_factor(self.to_bits())
    }

    fn exp(self) -> Self {
        Self::from_bits(exponential::exp(self.to_bits()))
    }
    fn ln(self) -> Self {
        Self::from_bits(mantissa::ln(self.to_bits()))
    }
    #[inline(always)]
    fn softplus(self) -> (Self, Unit) {
        let (value, slope) = pieces::softplus(self.to_bits());
        (Self::from_bits(value), slope)
    }
    fn weibull(self) -> Self {
        Self::from_bits(pieces::weibull(self.to_bits()))
    }
    #[inline(always)]
    fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N] {
        quotient::reciprocals_of_one_plus(factors.map(Self::to_bits), self.to_bits())
            .map(Self::from_bits)
    }
    #[inline(always)]
    fn is_between_0_and(self, end: Self) -> bool {
        let rest = end.to_bits().saturating_sub(self.to_bits());
        self.to_bits() != 0 && (self.to_bits() ^ rest) >= 0
    }
    #[inline(always)]
    fn is_negative(self) -> bool {
        self.to_bits() < 0
    }
    #[inline(always)]
    fn of_sign(self, negative: bool) -> Self {
        if (self.to_bits() < 0) == negative { self } else { Self::from_bits(0) }
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
        let (root, reciprocal) = root::hyperbola_root(&root::Forces {
            residual: self.to_bits(),
            line: line.to_bits(),
            steepness: steepness.to_bits(),
            half_curvature: half_curvature.to_bits(),
            inertia: inertia.to_bits(),
            viscosity: viscosity.to_bits(),
        });
        let reciprocal = Self::from_bits(reciprocal);
        Balance {
            root: Self::from_bits(root),
            damped: (Self::ONE - inertia * reciprocal).unit(),
            reciprocal,
        }
    }

    fn lag_state(self) -> i64 {
        i64::from(self.to_bits()) << LAG_SHIFT
    }
    fn of(state: i64) -> Self {
        let (whole, half) = ((state >> LAG_SHIFT) as i32, (state as u32 >> (LAG_SHIFT - 1)) as i32);
        Self::from_bits(whole.saturating_add(half))
    }
    fn advanced(state: i64, difference: Self, share: u32) -> i64 {
        // The result lies between two representable numbers, even if an intermediate sum wraps.
        state.wrapping_add(product::mixed(difference.to_bits(), share))
    }
    fn advanced_by_two(state: i64, first: (Self, u32), second: (Self, u32)) -> i64 {
        Self::advanced(Self::advanced(state, first.0, first.1), second.0, second.1)
    }
    fn share(value: f64) -> u32 {
        (value * 4_294_967_296.0 + 0.5) as u32
    }
    fn lag_response(self) -> u32 {
        u32::MAX - exponential::decay(self.to_bits())
    }
    /// The error of each is below 2^-24; most of it is from halving x, which can truncate half an
    /// ULP.
    #[inline(always)]
    fn lags(self) -> [Lags<u32>; 2] {
        let x = self.to_bits().max(0);
        let decay_at_half = exponential::decay(x >> 1);
        let decay = (product::unsigned(decay_at_half, decay_at_half) >> 32) as u32;
        // x exp(-x) is below 0.37: Q8.24 times Q0.32, shifted, is Q0.32 again.
        let delayed = |decay: u32, shift: u32| (product::unsigned(x as u32, decay) >> shift) as u32;
        [
            Lags { response: u32::MAX - decay_at_half, delayed: delayed(decay_at_half, 25) },
            Lags { response: u32::MAX - decay, delayed: delayed(decay, 24) },
        ]
    }
    fn lag_state_words(state: i64) -> impl Iterator<Item = u32> {
        [state as u32, (state >> 32) as u32].into_iter()
    }
    fn lag_state_from_words(words: &mut impl Iterator<Item = u32>) -> Option<i64> {
        let low = i64::from(words.next()?);
        Some(i64::from(words.next()? as i32) << 32 | low)
    }

    fn path_length(metres: f64) -> I23F9 {
        I23F9::from_bits(nearest(metres * PATH_UNITS))
    }
    fn path_metres(path: I23F9) -> f64 {
        f64::from(path.to_bits()) / PATH_UNITS
    }
    fn path_is_finite(_: I23F9) -> bool {
        true
    }
    fn per_metre(value: f64) -> Factor {
        Factor::new(value * UNITS / PATH_UNITS)
    }
    #[inline(always)]
    fn path_difference(path: I23F9, other: I23F9, per_metre: &Factor) -> Self {
        Self::from_bits(per_metre.times(path.saturating_sub(other).to_bits()))
    }
    fn path_factor(metres: f64) -> Factor {
        Factor::new(metres * PATH_UNITS / UNITS)
    }
    fn lengthened(path: I23F9, by: Self, factor: &Factor) -> I23F9 {
        path.saturating_add(I23F9::from_bits(factor.times(by.to_bits())))
    }
    fn path_bits(path: I23F9) -> u32 {
        path.to_bits() as u32
    }
    fn path_from_bits(bits: u32) -> I23F9 {
        I23F9::from_bits(bits as i32)
    }

    fn quantity(value: f64) -> I16F16 {
        I16F16::from_bits(nearest(value * QUANTITY_UNITS))
    }
    fn quantity_value(quantity: I16F16) -> f64 {
        f64::from(quantity.to_bits()) / QUANTITY_UNITS
    }
    fn quantity_is_finite(_: I16F16) -> bool {
        true
    }
    fn per_quantity(value: f64) -> Factor {
        Factor::new(value * UNITS / QUANTITY_UNITS)
    }
    fn of_quantity(quantity: I16F16, per_unit: &Factor) -> Self {
        Self::from_bits(per_unit.times(quantity.to_bits()))
    }
    fn quantity_factor(value: f64) -> Factor {
        Factor::new(value * QUANTITY_UNITS / UNITS)
    }
    fn as_quantity(self, quantity_factor: &Factor) -> I16F16 {
        I16F16::from_bits(quantity_factor.times(self.to_bits()))
    }

    fn force_factor(newtons: f64) -> Factor {
        Factor::new(newtons * 1e3 / UNITS)
    }
    fn force(self, force_factor: &Factor) -> i32 {
        force_factor.times(self.to_bits())
    }
    fn per_newton(value: f64) -> Factor {
        Factor::new(value * UNITS * 1e-3)
    }
    fn of_force(force: i32, per_newton: &Factor) -> Self {
        Self::from_bits(per_newton.times(force))
    }
    fn of_share(self, force: i32) -> i32 {
        number::saturating_shift(number::exact(self.to_bits(), force), number::FRACTION)
    }
    fn force_bits(force: i32) -> u32 {
        force as u32
    }
    fn newtons(force: i32) -> f64 {
        f64::from(force) * 1e-3
    }
    fn newtons_of(_: i32, relative_force: Self, newtons: f64) -> f64 {
        relative_force.to_f64() * newtons
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn responses_of_two_lags_are_within_one_ulp() {
        for bits in (0..=40 << 20).step_by(37) {
            let x = f64::from(bits) / UNITS;
            for (lags, x) in Fixed::from_bits(bits).lags().into_iter().zip([0.5 * x, x]) {
                let found = [lags.response, lags.delayed].map(f64::from);
                for (found, exact) in found.into_iter().zip([-(-x).exp_m1(), x * (-x).exp()]) {
                    let off = (found - exact * 4_294_967_296.0).abs();
                    assert!(off <= 256.0, "{x}: {off} units of 2^-32");
                }
            }
        }
    }

    #[test]
    fn tables_take_3664_bytes() {
        let kernels = [
            super::exponential::TABLE_BYTES,
            super::mantissa::TABLE_BYTES,
            super::pieces::TABLE_BYTES,
            super::root::TABLE_BYTES,
        ];
        assert_eq!(kernels.iter().sum::<usize>(), 3664);
    }
}
