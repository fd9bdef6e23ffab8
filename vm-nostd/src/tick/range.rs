//! A closed range.

use crate::scalar::Scalar;
use crate::summed::summed;
use core::ops::Add;

summed! {
    /// A closed range.
    #[derive(Clone, Copy, Debug)]
    #[doc(hidden)]
    pub struct Range<S> {
        pub(crate) least: S,
        pub(crate) most: S,
    }

    valid: |range| range.least <= range.most, where S: PartialOrd
}

impl<T: Copy + PartialOrd> Range<T> {
    pub(crate) fn new((least, most): (f64, f64), nearest: impl Fn(f64) -> T) -> Self {
        Self { least: nearest(least), most: nearest(most) }
    }

    /// Clamps a value and returns whether it was changed; NaN becomes the lower end.
    pub(crate) fn clip(&self, value: T) -> (T, bool) {
        let raised = if value > self.least { value } else { self.least };
        let clipped = if raised < self.most { raised } else { self.most };
        (clipped, clipped != value)
    }

    /// Whether a value is in the range, with a rounding tolerance.
    pub(crate) fn contains_within(&self, value: T, tolerance: T) -> bool
    where
        T: Add<Output = T>,
    {
        value + tolerance >= self.least && value <= self.most + tolerance
    }

    pub(crate) fn contains(&self, value: T) -> bool {
        value >= self.least && value <= self.most
    }
}

/// Range of a share, 0..1.
pub(crate) fn share<S: Scalar>() -> Range<S> {
    Range { least: S::ZERO, most: S::ONE }
}
