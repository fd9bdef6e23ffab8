//! Arithmetics of the model: floating point and fixed point behind one trait.
//!
//! [`Scalar`] has what callers need. What the equations need is in traits of this crate, one for
//! each purpose.

mod arithmetic;
pub(crate) mod cold;
pub(crate) mod constant;
mod conversions;
mod factors;
pub(crate) mod fixed;
pub(crate) mod float;
mod kernels;
mod representation;
pub(crate) mod sealed;
mod series;
mod wide;

pub(crate) use arithmetic::Arithmetic;
pub(crate) use conversions::{Conversions, MOST_PARTS};
pub(crate) use factors::Factors;
pub(crate) use kernels::{Balance, Kernels};
pub use representation::Representation;
pub(crate) use wide::{Lags, WideState};

use crate::summed::FromWords;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

/// An arithmetic of the model: `f32` with a floating-point unit, [`Fixed`](crate::Fixed) without
/// one, `f64` for comparison. Sealed.
///
/// Results are bit-identical on all machines: `a * b + c` is never fused, and the kernels are
/// portable code. Sums and products saturate in fixed point.
///
/// The kernels of the model are private: their ranges are those that its equations need.
///
/// ```compile_fail,E0624
/// fn beyond<S: vm_nostd::Scalar>(number: S) -> S {
///     number.weibull()
/// }
/// ```
#[expect(private_bounds, reason = "what the equations need is no concern of callers")]
pub trait Scalar:
    Representation
    + Arithmetic
    + Factors
    + Kernels
    + WideState
    + Conversions
    + FromWords
    + Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;

    /// Nearest value. Used when a muscle is built, never in a tick.
    fn from_f64(value: f64) -> Self;
    /// The value, exactly.
    fn to_f64(self) -> f64;
    /// The value as a word of a saved state.
    fn to_bits(self) -> Self::Bits;
    /// The value of a word from [`to_bits`](Scalar::to_bits).
    fn from_bits(bits: Self::Bits) -> Self;

    /// `self` with the resolution of a state.
    fn wide(self) -> Self::Wide;
    /// The nearest number to a state.
    fn of(state: Self::Wide) -> Self;

    /// Nearest path length to one in m. Not used in a tick.
    fn path_length(metres: f64) -> Self::PathLength;
    /// Path length in m, exact or rounded to `f64`.
    fn path_metres(path: Self::PathLength) -> f64;
    /// The word of a path length.
    fn path_bits(path: Self::PathLength) -> Self::Bits;
    /// The path length whose word is `bits`.
    fn path_from_bits(bits: Self::Bits) -> Self::PathLength;

    /// Nearest quantity to one in its unit. Not used in a tick.
    fn quantity(value: f64) -> Self::Quantity;
    /// A quantity in its unit, exactly.
    fn quantity_value(quantity: Self::Quantity) -> f64;

    /// Nearest force to one in N. Not used in a tick.
    fn from_newtons(newtons: f64) -> Self::Force {
        Self::ONE.force(&Self::force_factor(newtons))
    }
    /// Force in N, exact or rounded to `f64`.
    fn newtons(force: Self::Force) -> f64;
    /// Force in N for a muscle whose F0 is `newtons`, from the one of `force` and `relative_force`
    /// that has the higher resolution.
    fn newtons_of(force: Self::Force, relative_force: Self, newtons: f64) -> f64;
    /// A force times a share, 0..1.
    fn of_share(self, force: Self::Force) -> Self::Force;
    /// The word of a force.
    fn force_bits(force: Self::Force) -> Self::Bits;
}
