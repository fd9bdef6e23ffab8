//! Conversion between numbers and values with a unit, and the limits of both.

use super::constant::Constant;
use super::{Factors, Representation};

/// Most parts in which the change of a path is taken.
pub(crate) const MOST_PARTS: u8 = 8;

/// Conversion between numbers and values with a unit.
pub(crate) trait Conversions: Representation + Factors + Copy {
    /// Number of the arithmetic in a saved state.
    const ARITHMETIC: u32;
    /// Largest representable coefficient.
    const LARGEST_COEFFICIENT: f64;
    /// Range of maximal isometric force that outputs can represent, N.
    const MAXIMAL_FORCES: (f64, f64);
    /// Resolution of forces, N.
    const FORCE_STEP: f64;
    /// Longest representable path, m.
    const LONGEST_PATH: f64;

    /// Whether a path length is finite.
    fn path_is_finite(path: Self::PathLength) -> bool;
    /// Factor from path lengths to numbers: `value` per m.
    fn per_metre(value: f64) -> Self::Factor;
    /// (`path` - `other`) times a factor per m.
    fn path_difference(
        path: Self::PathLength,
        other: Self::PathLength,
        per_metre: &Self::Factor,
    ) -> Self;
    /// Change of the difference from `other` if `path` becomes `after`. Changes one after the other
    /// add up to the whole one: exactly in fixed point.
    fn path_change(
        path: Self::PathLength,
        after: Self::PathLength,
        other: Self::PathLength,
        per_metre: &Self::Factor,
    ) -> Self;
    /// The path length one of `parts` equal parts (2 to [`MOST_PARTS`]) from `path` to `end`.
    fn path_towards(path: Self::PathLength, end: Self::PathLength, parts: u8) -> Self::PathLength;
    /// Factor from numbers to path lengths: `metres` per 1.
    fn path_factor(metres: f64) -> Self::Factor;
    /// A path length plus a number times a factor; saturates.
    fn lengthened(path: Self::PathLength, by: Self, factor: &Self::Factor) -> Self::PathLength;

    /// A constant of the model as a quantity.
    fn quantity_constant(constant: &Constant) -> Self::Quantity;
    /// Whether a quantity is finite.
    fn quantity_is_finite(quantity: Self::Quantity) -> bool;
    /// Factor from quantities to numbers: `value` per unit.
    fn per_quantity(value: f64) -> Self::Factor;
    /// A quantity times a factor per unit.
    fn of_quantity(quantity: Self::Quantity, per_unit: &Self::Factor) -> Self;
    /// Factor from numbers to quantities: units per 1.
    fn quantity_factor(value: f64) -> Self::Factor;
    /// A number times a factor as a quantity; saturates.
    fn to_quantity(self, quantity_factor: &Self::Factor) -> Self::Quantity;

    /// Factor from relative force to force, for F0 in N.
    fn force_factor(newtons: f64) -> Self::Factor;
    /// A force relative to F0 as a force.
    fn force(self, force_factor: &Self::Factor) -> Self::Force;
    /// Factor from forces to numbers: `value` per N.
    fn per_newton(value: f64) -> Self::Factor;
    /// A force times a factor per N.
    fn of_force(force: Self::Force, per_newton: &Self::Factor) -> Self;
}
