//! The fixed-point number: saturating Q8.24.

use super::product;
use core::ops::{Add, Mul, Neg, Sub};
use fixed::types::I8F24;

/// Fractional bits.
pub(super) const FRACTION: u32 = 24;
/// 1 in Q8.24.
pub(super) const ONE: i32 = 1 << FRACTION;

/// Fixed point for cores without a floating-point unit: Q8.24, from -128 to 128 with an ULP of
/// 6e-8, like `f32` near 1. Sums and products saturate.
///
/// It converts from and to [`I8F24`]. Products round toward minus infinity as in that type, but in
/// fewer instructions; on overflow they saturate to within 255 ULP of the limit of the range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Fixed(I8F24);

impl Fixed {
    /// The number `bits` × 2^-24.
    pub const fn from_bits(bits: i32) -> Self {
        Self(I8F24::from_bits(bits))
    }

    /// The number in units of 2^-24.
    pub const fn to_bits(self) -> i32 {
        self.0.to_bits()
    }
}

impl From<I8F24> for Fixed {
    fn from(number: I8F24) -> Self {
        Self(number)
    }
}

impl From<Fixed> for I8F24 {
    fn from(number: Fixed) -> Self {
        number.0
    }
}

impl Add for Fixed {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        #[cfg(test)]
        saturations::note(self.0.checked_add(other.0).is_none());
        Self(self.0.saturating_add(other.0))
    }
}

impl Sub for Fixed {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        #[cfg(test)]
        saturations::note(self.0.checked_sub(other.0).is_none());
        Self(self.0.saturating_sub(other.0))
    }
}

impl Neg for Fixed {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(I8F24::ZERO.saturating_sub(self.0))
    }
}

impl Mul for Fixed {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = exact(self.to_bits(), other.to_bits());
        #[cfg(test)]
        saturations::note(product.0 << 8 >> 8 != product.0);
        Self::from_bits(saturated(product))
    }
}

/// Product, rounded to nearest; saturates like `*`.
///
/// # Scaling and overflow
/// The product is at most 2^62: adding half a unit of Q8.24 does not overflow.
#[inline(always)]
pub(super) fn rounded_product(a: Fixed, b: Fixed) -> Fixed {
    let product = product::signed(a.to_bits(), b.to_bits()) + (1 << (FRACTION - 1));
    let words = ((product >> 32) as i32, product as u32);
    #[cfg(test)]
    saturations::note(words.0 << 8 >> 8 != words.0);
    Fixed::from_bits(saturated(words))
}

/// Exact product as high and low word; at most 2^62.
#[inline(always)]
pub(super) fn exact(a: i32, b: i32) -> (i32, u32) {
    let product = product::signed(a, b);
    ((product >> 32) as i32, product as u32)
}

/// High word of a product. It has the fractional bits of both factors less 32.
#[inline(always)]
pub(super) fn high(a: i32, b: i32) -> i32 {
    exact(a, b).0
}

/// High word of a², rounded up, minus one unit. It is computed so that the compiler does not know
/// its sign: a product of two signed numbers compiles to one instruction, but to three if one
/// factor is known to be positive.
#[inline(always)]
pub(super) fn square(a: i32) -> i32 {
    !high(a, a.wrapping_neg())
}

/// A product of two Q8.24 numbers, as two words, shifted to Q8.24: rounded toward minus infinity,
/// saturated.
///
/// # Scaling and overflow
/// The result fits if the high word has 24 bits; otherwise the high word is clamped to 24 bits by
/// one instruction (SSAT). The first byte of the low word is appended in any case, so that an
/// overflow saturates to within 255 ULP of the limit of the range.
#[inline(always)]
fn saturated((high, low): (i32, u32)) -> i32 {
    const MOST: i32 = 1 << (FRACTION - 1);
    (high.clamp(-MOST, MOST - 1) << (32 - FRACTION)) | (low >> FRACTION) as i32
}

/// Two words shifted right by `bits`, 1 to 32: rounded toward minus infinity, saturated.
///
/// # Scaling and overflow
/// The result fits if shifting the high word left and right again restores it. The check uses
/// 32-bit words: a 64-bit comparison compiles to twice the instructions.
pub(super) fn saturating_shift((high, low): (i32, u32), bits: u32) -> i32 {
    let left = 32 - bits;
    let word = (high << left) | (low >> 1 >> (bits - 1)) as i32;
    // On overflow, i32::MAX or its complement, i32::MIN.
    if word >> left == high { word } else { i32::MAX ^ (high >> 31) }
}

/// Counts the saturated sums and products of a thread, for tests.
#[cfg(test)]
pub(crate) mod saturations {
    use core::cell::Cell;

    thread_local! {
        static COUNT: Cell<u32> = const { Cell::new(0) };
    }

    pub(super) fn note(saturated: bool) {
        COUNT.with(|count| count.set(count.get() + u32::from(saturated)));
    }

    /// The count since the last call.
    pub(crate) fn take() -> u32 {
        COUNT.with(|count| count.replace(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_round_down_and_saturate() {
        let mut numbers: [i32; 400] = [0; 400];
        let mut state = 1_u64;
        for number in &mut numbers {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            // Random magnitude.
            *number = (state >> 32) as i32 >> (state >> 27 & 31);
        }
        let edges = [0, 1, -1, ONE, -ONE, i32::MAX, i32::MIN, i32::MAX - 1, ONE / 2, ONE + 1];
        let all = || edges.iter().chain(&numbers).copied();
        for (a, b) in all().flat_map(|a| all().map(move |b| (a, b))) {
            let clamped = |bits: u32| {
                let wide = (i64::from(a) * i64::from(b)) >> bits;
                wide.clamp(i32::MIN.into(), i32::MAX.into()) as i32
            };
            for bits in 1..=32 {
                assert_eq!(saturating_shift(exact(a, b), bits), clamped(bits), "{a} {b} {bits}");
            }
            let (found, expected) = (saturated(exact(a, b)), clamped(FRACTION));
            let ends = [i32::MIN, i32::MAX].contains(&expected);
            let distance = i64::from(found) - i64::from(expected);
            assert!(distance == 0 || ends && distance.abs() < 256, "{a} {b}: {found} {expected}");
        }
    }
}
