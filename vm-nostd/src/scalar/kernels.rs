//! Kernels: the functions beyond sums and products. Their error bounds are in the crate's README,
//! from the table in `tests/kernels`.

use super::factors::Factors;

/// Kernels. They and functions called once per tick are inlined: a call needs a stack frame and
/// spills registers.
pub(crate) trait Kernels: Factors {
    /// `self` divided by a positive number; saturates.
    #[must_use]
    fn ratio(self, divisor: Self) -> Self;
    /// Quotients by positive numbers.
    #[must_use]
    fn ratios<const N: usize>(dividends: [Self; N], divisors: [Self; N]) -> [Self; N];
    /// Reciprocal of a positive number; saturates.
    #[must_use]
    fn reciprocal(self) -> Self;
    /// Reciprocals of positive numbers.
    #[must_use]
    fn reciprocals<const N: usize>(numbers: [Self; N]) -> [Self; N];
    /// Reciprocal of a positive number as a factor, for several quotients by the same divisor.
    fn reciprocal_factor(self) -> Self::Factor;
    /// `1/(1 + factor self)` for each factor; the denominators must be positive.
    #[must_use]
    fn reciprocals_of_one_plus<const N: usize>(self, factors: [Self; N]) -> [Self; N];

    /// Exponential of `self`, which is at most 80; underflows to 0.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm of a positive number; for 0, approximately that of the smallest positive
    /// number.
    #[must_use]
    fn ln(self) -> Self;
    /// Natural logarithm of the product with another number, both positive or 0; unlike the product
    /// it cannot saturate.
    #[must_use]
    fn ln_of_product(self, factor: Self) -> Self;
    /// `ln(exp(self) + 1)` and its slope, the logistic function of `self`, 0..1.
    fn softplus(self) -> (Self, Self::Unit);
    /// `1 - exp(-exp(self))`, the Weibull distribution as a function of the logarithm.
    #[must_use]
    fn weibull(self) -> Self;
    /// Polynomials in `self` (-1..1). Coefficients are in order of powers, constant first; the sum
    /// of their magnitudes is at most 100.
    fn polynomials<const N: usize, const TERMS: usize>(
        self,
        terms: [&[Self; TERMS]; N],
    ) -> [Self; N];
    /// Solves a force balance with a residual `self`, a line and a hyperbola: the root u of
    /// `self` + `line` u + h(u) = 0. Also returns the damping at the root relative to the inertia.
    ///
    /// h(u) = `steepness` u/(1 + bend u), with half its curvature at 0 in `half_curvature`; the
    /// root is on the branch through 0. `line` and `steepness` are positive. The damping is
    /// `viscosity` plus the secant of the hyperbola, h(u)/u.
    fn hyperbola_root(
        self,
        line: Self,
        steepness: Self,
        half_curvature: Self,
        inertia: Self,
        viscosity: Self,
    ) -> Balance<Self>;
}

/// Root of a force balance, and the damping there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance<S: Factors> {
    /// The root.
    pub(crate) root: S,
    /// damping/(inertia + damping), 0..1.
    pub(crate) damped: S::Unit,
    /// 1/(inertia + damping).
    pub(crate) reciprocal: S,
}
