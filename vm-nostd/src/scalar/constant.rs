//! Constants of the model, the same for every muscle.

use super::fixed::{Fixed, Part, nearest_number, nearest_quantity};
use fixed::types::I16F16;

/// A constant of the model, rounded for every arithmetic when the program is compiled. A muscle
/// need not store it, and no tick converts it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constant {
    pub(super) double: f64,
    pub(super) single: f32,
    pub(super) fixed: Fixed,
    /// As a factor from -1/2 to 1/2.
    pub(super) part: Part,
    /// As a quantity with a unit.
    pub(super) quantity: I16F16,
}

impl Constant {
    /// The nearest number of each arithmetic; fixed point saturates.
    pub(crate) const fn new(value: f64) -> Self {
        Self {
            double: value,
            single: value as f32,
            fixed: nearest_number(value),
            part: Part::new(value),
            quantity: nearest_quantity(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Scalar;

    fn agrees<S: Scalar>(value: f64, constant: &Constant) {
        assert_eq!(S::constant(constant), S::from_f64(value), "{value}");
        assert_eq!(S::quantity_constant(constant), S::quantity(value), "{value}");
        let of = |part: S::Part| S::ONE.portion(part);
        assert_eq!(of(S::part_constant(constant)), of(S::part(value)), "{value}");
    }

    #[test]
    fn constants_are_the_numbers_that_a_build_would_compute() {
        for value in [0.0, 1e-5, 1.0 / 64.0, -0.3, 0.1, 0.5, -60.0, 60.0, 500.0, 1e9, -1e9] {
            let constant = Constant::new(value);
            agrees::<f32>(value, &constant);
            agrees::<f64>(value, &constant);
            agrees::<Fixed>(value, &constant);
        }
    }
}
