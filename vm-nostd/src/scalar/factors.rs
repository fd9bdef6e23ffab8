//! Factors: constants of any magnitude, and numbers in ranges in which a product is cheap.

use super::constant::Constant;
use crate::summed::FromWords;
use core::fmt::Debug;
use core::ops::Add;

/// Products with factors.
pub(crate) trait Factors: Sized {
    /// A constant factor of any magnitude.
    type Factor: Copy + Debug + FromWords + Send + Sync;
    /// A factor from -1/2 to 1/2, such as a time in ticks since mid-tick.
    type Part: Copy + Debug + Add<Output = Self::Part> + FromWords + Send + Sync;
    /// A factor from 0 to 1.
    type Unit: Copy + Debug + Send + Sync;

    /// -1/2.
    const MINUS_HALF: Self::Part;

    /// The factor nearest to a constant. Used when a muscle is built.
    fn factor(value: f64) -> Self::Factor;
    /// Product with a constant; saturates.
    #[must_use]
    fn scaled(self, factor: &Self::Factor) -> Self;
    /// The part nearest to a constant, -1/2 to 1/2. Used when a muscle is built.
    fn part(value: f64) -> Self::Part;
    /// A constant of the model, -1/2 to 1/2, as a part.
    fn part_constant(constant: &Constant) -> Self::Part;
    /// Product with a part; fixed point rounds toward minus infinity.
    #[must_use]
    fn portion(self, part: Self::Part) -> Self;
    /// Product with a part; fixed point rounds to nearest.
    #[must_use]
    fn rounded_portion(self, part: Self::Part) -> Self;
    /// The number as a factor; clamped to 0..1 in fixed point.
    fn unit(self) -> Self::Unit;
    /// Product with a factor from 0 to 1; fixed point rounds toward minus infinity to a multiple of
    /// two ULP.
    #[must_use]
    fn by(self, unit: Self::Unit) -> Self;
}
