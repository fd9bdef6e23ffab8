//! Fixed point: Q8.24, and Q8.56 for the state of lags.

mod conversions;
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
mod share;
mod unit;
mod wide;

pub use factor::Factor;
pub(crate) use factor::{nearest_number, nearest_quantity};
pub use number::Fixed;
#[cfg(test)]
pub(crate) use number::saturations;
pub use part::Part;
#[cfg(test)]
pub(crate) use root::square_root as fixed_square_root;
pub use unit::Unit;
#[cfg(test)]
pub(crate) use wide::SPAN_BITS;
pub use wide::Wide;

use super::constant::Constant;
use super::sealed::Sealed;
use super::{Arithmetic, Balance, Factors, Kernels, Representation, Scalar};
use fixed::types::{I16F16, I23F9};
use number::ONE;

impl Sealed for Fixed {}

impl Representation for Fixed {
    type Bits = u32;
    type Wide = Wide;
    /// µm, in steps of 2 nm, to 4.19 m.
    type PathLength = I23F9;
    type Quantity = I16F16;
    /// mN.
    type Force = i32;
}

impl Arithmetic for Fixed {
    const HALF: Self = Self::from_bits(ONE / 2);
    const LEAST: Self = Self::from_bits(1);
    const SIDE_BY_SIDE: bool = false;

    #[inline(always)]
    fn constant(constant: &Constant) -> Self {
        constant.fixed
    }
    fn is_finite(self) -> bool {
        true
    }
    #[inline(always)]
    fn is_saturated(self) -> bool {
        // A rounded sum can be one ULP lower.
        self >= Self::from_bits(i32::MAX - 1)
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        number::rounded_product(self, other)
    }
    #[inline(always)]
    fn half(self) -> Self {
        Self::from_bits(self.to_bits() >> 1)
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
    fn abs(self) -> Self {
        // Without a branch, and saturating for the least number.
        let sign = self.to_bits() >> 31;
        Self::from_bits((self.to_bits() ^ sign).saturating_sub(sign))
    }
}

impl Factors for Fixed {
    type Factor = Factor;
    type Part = Part;
    type Unit = Unit;

    const MINUS_HALF: Part = Part::MINUS_HALF;

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
    fn part_constant(constant: &Constant) -> Part {
        constant.part
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
        Unit::new(self)
    }
    #[inline(always)]
    fn by(self, unit: Unit) -> Self {
        Self::from_bits(unit.of(self.to_bits()))
    }
}

impl Kernels for Fixed {
    fn ratio(self, divisor: Self) -> Self {
        self.scaled(&divisor.reciprocal_factor())
    }
    #[inline(always)]
    fn ratios<const N: usize>(mut dividends: [Self; N], divisors: [Self; N]) -> [Self; N] {
        for (dividend, divisor) in dividends.iter_mut().zip(divisors) {
            *dividend = dividend.ratio(divisor);
        }
        dividends
    }
    fn reciprocal(self) -> Self {
        quotient::reciprocal(self)
    }
    #[inline(always)]
    fn reciprocals<const N: usize>(mut numbers: [Self; N]) -> [Self; N] {
        for number in &mut numbers {
            *number = number.reciprocal();
        }
        numbers
    }
    fn reciprocal_factor(self) -> Factor {
        quotient::reciprocal_factor(self)
    }
    #[inline(always)]
    fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N] {
        quotient::reciprocals_of_one_plus(factors, self)
    }

    fn exp(self) -> Self {
        exponential::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        mantissa::ln(self)
    }
    #[inline(always)]
    fn ln_of_product(self, factor: Self) -> Self {
        mantissa::ln_of_product(self, factor)
    }
    #[inline(always)]
    fn softplus(self) -> (Self, Unit) {
        pieces::softplus(self)
    }
    fn weibull(self) -> Self {
        pieces::weibull(self)
    }
    #[inline(always)]
    fn polynomials<const N: usize, const TERMS: usize>(
        self,
        terms: [&[Self; TERMS]; N],
    ) -> [Self; N] {
        let mut values = [Self::ZERO; N];
        for (value, terms) in values.iter_mut().zip(terms) {
            *value = polynomial::at(self, terms);
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
        let (root, reciprocal) = root::hyperbola_root(&root::Forces {
            residual: self,
            line,
            steepness,
            half_curvature,
            inertia,
            viscosity,
        });
        let damped = (Self::ONE - inertia * reciprocal).unit();
        Balance { root, damped, reciprocal }
    }
}

impl Scalar for Fixed {
    const ZERO: Self = Self::from_bits(0);
    const ONE: Self = Self::from_bits(ONE);

    fn from_f64(value: f64) -> Self {
        nearest_number(value)
    }
    fn to_f64(self) -> f64 {
        conversions::value(self)
    }
    fn to_bits(self) -> u32 {
        self.to_bits() as u32
    }
    fn from_bits(bits: u32) -> Self {
        Self::from_bits(bits as i32)
    }

    fn wide(self) -> Wide {
        Wide::new(self)
    }
    fn of(state: Wide) -> Self {
        state.rounded()
    }

    fn path_length(metres: f64) -> I23F9 {
        conversions::nearest_path(metres)
    }
    fn path_metres(path: I23F9) -> f64 {
        conversions::metres(path)
    }
    fn path_bits(path: I23F9) -> u32 {
        path.to_bits() as u32
    }
    fn path_from_bits(bits: u32) -> I23F9 {
        I23F9::from_bits(bits as i32)
    }

    fn quantity(value: f64) -> I16F16 {
        nearest_quantity(value)
    }
    fn quantity_value(quantity: I16F16) -> f64 {
        conversions::quantity_value(quantity)
    }

    fn newtons(force: i32) -> f64 {
        f64::from(force) * 1e-3
    }
    fn newtons_of(_: i32, relative_force: Self, newtons: f64) -> f64 {
        relative_force.to_f64() * newtons
    }
    fn of_share(self, force: i32) -> i32 {
        number::saturating_shift(number::exact(self.to_bits(), force), number::FRACTION)
    }
    fn force_bits(force: i32) -> u32 {
        force as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_their_ranges_kernels_saturate() {
        let [zero, least, one] = [0, i32::MIN, 1].map(Fixed::from_bits);
        assert_eq!((zero.ln(), least.ln()), (one.ln(), one.ln()));
        let most = Fixed::from_bits(i32::MAX);
        assert_eq!([zero, least, one].map(Fixed::reciprocal), [most; 3]);
        assert_eq!(Fixed::from_bits(7).ratio(zero), Fixed::from_bits(7 << 24));
    }

    #[test]
    fn tables_take_3664_bytes() {
        let kernels = [
            exponential::TABLE_BYTES,
            mantissa::TABLE_BYTES,
            pieces::TABLE_BYTES,
            root::TABLE_BYTES,
        ];
        assert_eq!(kernels.iter().sum::<usize>(), 3664);
    }
}
