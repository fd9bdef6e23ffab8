//! States of lags, Q8.56.

use super::exponential;
use super::number::Fixed;
use super::product;
use super::share::Share;
use crate::scalar::{Lags, WideState};

/// Q8.56 has 32 more fractional bits than Q8.24.
const MORE_BITS: u32 = 32;

/// The state of a lag in Q8.56, -128 to 128.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagState(i64);

impl LagState {
    #[inline(always)]
    pub(super) fn new(number: Fixed) -> Self {
        Self(i64::from(number.to_bits()) << MORE_BITS)
    }

    /// The nearest number, saturated.
    #[inline(always)]
    pub(super) fn rounded(self) -> Fixed {
        let (whole, half) =
            ((self.0 >> MORE_BITS) as i32, (self.0 as u32 >> (MORE_BITS - 1)) as i32);
        Fixed::from_bits(whole.saturating_add(half))
    }
}

impl WideState for Fixed {
    type Share = Share;

    fn advanced(state: LagState, difference: Self, share: Share) -> LagState {
        // The result lies between two representable numbers, even if an intermediate sum wraps.
        LagState(state.0.wrapping_add(product::mixed(difference.to_bits(), share.to_bits())))
    }
    fn advanced_by_two(state: LagState, first: (Self, Share), second: (Self, Share)) -> LagState {
        Self::advanced(Self::advanced(state, first.0, first.1), second.0, second.1)
    }
    fn share(value: f64) -> Share {
        Share::new(value)
    }
    fn lag_response(self) -> Share {
        exponential::decay(self).rest()
    }
    /// Most of the error of each is from halving x, which can truncate half an ULP.
    #[inline(always)]
    fn lags(self) -> [Lags<Share>; 2] {
        let x = self.to_bits().max(0);
        let decay_at_half = exponential::decay(Self::from_bits(x >> 1));
        let decay = decay_at_half.squared();
        // x exp(-x) is below 0.37: Q8.24 times Q0.32, shifted, is Q0.32 again.
        let delayed = |decay: Share, shift: u32| {
            Share::from_bits((product::unsigned(x as u32, decay.to_bits()) >> shift) as u32)
        };
        [
            Lags { response: decay_at_half.rest(), delayed: delayed(decay_at_half, 25) },
            Lags { response: decay.rest(), delayed: delayed(decay, 24) },
        ]
    }
    fn lag_state_words(state: LagState) -> impl Iterator<Item = u32> {
        [state.0 as u32, (state.0 >> 32) as u32].into_iter()
    }
    fn lag_state_from_words(words: &mut impl Iterator<Item = u32>) -> Option<LagState> {
        let low = i64::from(words.next()?);
        Some(LagState(i64::from(words.next()? as i32) << 32 | low))
    }
}
