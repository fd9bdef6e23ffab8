//! Shares: factors from 0 to 1 with the resolution that states need.

use super::product;
use crate::summed::summed_numbers;

/// A share from 0 to 1 in Q0.32. 1 would be 2^32 and is clamped below it.
#[derive(Clone, Copy, Debug)]
pub struct Share(u32);

impl Share {
    /// 1 - 2^-32.
    pub(super) const MOST: Self = Self(u32::MAX);

    /// The nearest share.
    pub(super) fn new(value: f64) -> Self {
        Self((value * 4_294_967_296.0 + 0.5) as u32)
    }

    /// The share `bits` in Q0.32.
    #[inline(always)]
    pub(super) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The share in units of 2^-32.
    #[inline(always)]
    pub(crate) fn to_bits(self) -> u32 {
        self.0
    }

    /// What is left of [`Share::MOST`].
    #[inline(always)]
    pub(super) fn rest(self) -> Self {
        Self(u32::MAX - self.0)
    }

    /// Its square, rounded toward zero.
    #[inline(always)]
    pub(super) fn squared(self) -> Self {
        Self((product::unsigned(self.0, self.0) >> 32) as u32)
    }
}

summed_numbers! {
    Share: |share| share.0, |word| Some(Self(word));
}
