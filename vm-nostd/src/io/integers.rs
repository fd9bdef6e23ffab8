//! Inputs in integer units.

use super::Input;
use crate::scalar::fixed::Fixed;
use fixed::types::{I16F16, I23F9};

/// A thousandth in units of 2^-24, times 2^16.
const PER_MILLE: u64 = 1_099_511_628;
/// A tenth in units of 2^-16, times 2^16.
const TENTH: u64 = 429_496_730;

impl Input<Fixed> {
    /// Inputs from integers: activation in thousandths, path length in µm, stimulation frequency
    /// in tenths of a pulse per second.
    ///
    /// Path lengths are exact; thousandths and tenths are rounded to nearest. Values outside the
    /// validity range are clipped and flagged by the tick, like any input; a path beyond ±4.19 m
    /// is clipped here.
    ///
    /// ```
    /// use vm_nostd::{Fixed, Input};
    /// let input = Input::<Fixed>::from_integers(500, 160_000, 205);
    /// assert_eq!(input.activation, Fixed::from_bits(1 << 23)); // 0.5
    /// assert_eq!(input.path_length, 160_000);
    /// assert_eq!(input.stimulation_frequency, 20.5);
    /// ```
    pub fn from_integers(
        activation_per_mille: u16,
        path_length_um: i32,
        stimulation_tenths_pps: u16,
    ) -> Self {
        let rounded = |value: u16, unit: u64| ((u64::from(value) * unit + (1 << 15)) >> 16) as u32;
        let frequency = rounded(stimulation_tenths_pps, TENTH);
        Self {
            activation: Fixed::from_bits(rounded(activation_per_mille, PER_MILLE) as i32),
            path_length: I23F9::saturating_from_num(path_length_um),
            stimulation_frequency: I16F16::from_bits(frequency as i32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_taken_exactly_or_to_the_nearest_fraction() {
        for value in 0..=u16::MAX {
            let input = Input::<Fixed>::from_integers(value, i32::from(value) - 9, value);
            let exact = f64::from(value) / 1000.0 * 16_777_216.0;
            let nearest = |limit| if value <= limit { 0.51 } else { 1.0 };
            let activation = f64::from(input.activation.to_bits());
            assert!((activation - exact).abs() <= nearest(1000), "{value}");
            assert_eq!(input.path_length, i32::from(value) - 9);
            let exact = f64::from(value) / 10.0 * 65_536.0;
            let frequency = f64::from(input.stimulation_frequency.to_bits());
            assert!((frequency - exact).abs() <= nearest(5000), "{value}");
        }
        let far = Input::<Fixed>::from_integers(0, i32::MAX, 0);
        assert_eq!(far.path_length, I23F9::MAX);
    }
}
