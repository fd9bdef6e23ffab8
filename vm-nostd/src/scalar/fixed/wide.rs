//! States that add up small changes, Q8.56.

use super::exponential;
use super::number::Fixed;
use super::part::Part;
use super::product;
use super::share::Share;
use crate::scalar::{Lags, WideState};

/// Q8.56 has 32 more fractional bits than Q8.24.
const MORE_BITS: u32 = 32;
/// A span is a number of time constants times 2^5.
pub(crate) const SPAN_BITS: u32 = 5;

/// A number in Q8.56, -128 to 128.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wide(i64);

impl Wide {
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

    fn advanced(state: Wide, difference: Self, share: Share) -> Wide {
        // The result lies between two representable numbers, even if an intermediate sum wraps.
        Wide(state.0.wrapping_add(product::mixed(difference.to_bits(), share.to_bits())))
    }
    fn advanced_by_two(state: Wide, first: (Self, Share), second: (Self, Share)) -> Wide {
        Self::advanced(Self::advanced(state, first.0, first.1), second.0, second.1)
    }
    /// # Scaling and overflow
    /// Q8.24 times Q0.32 is Q8.56, at most 2^62, and needs no shift.
    #[inline(always)]
    fn stretched(state: Wide, stretch: Self, travel: Self, tick: Part) -> Wide {
        let taken = tick.exactly_of(travel.to_bits());
        Wide(state.0.saturating_add(Wide::new(stretch).0).saturating_sub(taken))
    }
    fn share(value: f64) -> Share {
        Share::new(value)
    }
    fn lag_response(self) -> Share {
        exponential::decay(self).rest()
    }
    /// # Scaling and overflow
    /// The number is below 4.
    #[inline(always)]
    fn span(self) -> Self {
        Self::from_bits(self.to_bits() << SPAN_BITS)
    }
    /// # Scaling and overflow
    /// A span of x in Q8.24 is x in Q3.29, and x/2 in Q2.30.
    #[inline(always)]
    fn lags(self) -> [Lags<Share>; 2] {
        let x = self.to_bits().max(0);
        let decay_at_half = exponential::decay_over(x, SPAN_BITS + 1);
        let decay = decay_at_half.squared();
        // x exp(-x) is below 0.37: Q3.29 times Q0.32, shifted, is Q0.32 again.
        let delayed = |decay: Share, shift: u32| {
            Share::from_bits((product::unsigned(x as u32, decay.to_bits()) >> shift) as u32)
        };
        [
            Lags { response: decay_at_half.rest(), delayed: delayed(decay_at_half, 30) },
            Lags { response: decay.rest(), delayed: delayed(decay, 29) },
        ]
    }
    fn wide_words(state: Wide) -> impl Iterator<Item = u32> {
        [state.0 as u32, (state.0 >> 32) as u32].into_iter()
    }
    fn wide_from_words(words: &mut impl Iterator<Item = u32>) -> Option<Wide> {
        let low = i64::from(words.next()?);
        Some(Wide(i64::from(words.next()? as i32) << 32 | low))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{Factors, Scalar};

    #[test]
    fn travel_below_an_increment_adds_up() {
        let tick = Fixed::part(1e-4);
        // 2^-12 L_ce0/s for 1e-4 s: 0.41 increments.
        let travel = Fixed::from_bits(1 << 12);
        let mut extension = Fixed::from_f64(0.25).wide();
        for _ in 0..1000 {
            extension = Fixed::stretched(extension, Fixed::ZERO, travel, tick);
        }
        let found = Fixed::of(extension).to_bits() - Fixed::from_f64(0.25).to_bits();
        assert_eq!(found, -410);
    }

    #[test]
    fn extensions_saturate() {
        let [most, least] = [i32::MAX, i32::MIN].map(Fixed::from_bits);
        let tick = Fixed::part(0.5);
        let stretched = |extension: Fixed, stretch, travel| {
            Fixed::of(Fixed::stretched(extension.wide(), stretch, travel, tick))
        };
        assert_eq!(stretched(most, most, least), most);
        assert_eq!(stretched(least, least, most), least);
        assert_eq!(stretched(most, least, Fixed::ZERO), Fixed::from_bits(-1));
    }
}
