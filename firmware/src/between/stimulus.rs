//! Stimulus of a channel, and its limits.

use crate::between::guarded::Sum;
use core::fmt;
use serde::{Deserialize, Serialize};
use vm_nostd::Checksum;

/// Shortest phase, µs: the pulse timer's interrupt at its start must set the next phase before its
/// end.
pub const LEAST_PHASE_US: u32 = 20;

/// Time without current before and after switching, µs, in which converter and switches settle.
pub(crate) const SETTLE_US: u16 = LEAST_PHASE_US as u16;
/// Shortest interphase gap, µs: settling, and reversing the bridge.
const LEAST_GAP_US: u32 = 2 * LEAST_PHASE_US;
/// Widest stimulating phase, µs.
pub(crate) const MOST_WIDTH_US: u16 = 1000;
/// Longest interphase gap, µs.
const MOST_GAP_US: u32 = 200;
/// Greatest ratio of recharge to stimulating phase.
pub(crate) const MOST_RECOVERY: u8 = 8;
/// The strongest current source, µA.
pub(crate) const MOST_FULL_SCALE_UA: u32 = 500_000;
/// Greatest count of the converter.
pub(crate) const MOST_COUNTS: u16 = 4095;
/// Longest pulse of a valid stimulus, with settling, µs.
pub(crate) const LONGEST_PULSE_US: u32 = Stimulus {
    amplitude_ua: 0,
    width_us: MOST_WIDTH_US,
    gap_us: MOST_GAP_US as u16,
    frequency_tenths_pps: 10,
    recovery: MOST_RECOVERY,
}
.duration_us();

/// Pulse train of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stimulus {
    /// Amplitude of the stimulating phase, µA; 0 to [`Scale::full_scale_ua`].
    pub amplitude_ua: u32,
    /// Width of the stimulating phase, µs; [`LEAST_PHASE_US`] to 1,000.
    pub width_us: u16,
    /// Interphase gap, µs; 40 to 200.
    pub gap_us: u16,
    /// Frequency, pulses in ten seconds; 10 to 5,000.
    pub frequency_tenths_pps: u16,
    /// The recharge phase is this many times weaker and longer; 1 to 8.
    pub recovery: u8,
}

/// Scale of the current source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// Current at the greatest count, µA; 1 to 500,000.
    pub full_scale_ua: u32,
    /// Greatest count; 8 to 4095 (a 12-bit converter).
    pub full_scale_counts: u16,
}

impl Scale {
    /// Greatest count, at least 1.
    pub(crate) const fn counts(&self) -> u32 {
        if self.full_scale_counts == 0 { 1 } else { self.full_scale_counts as u32 }
    }

    /// Counts of a current (µA), rounded down, clamped to full scale.
    pub(crate) fn counts_of(&self, current_ua: u32) -> u16 {
        // µA times counts may have 35 bits.
        let current = u64::from(current_ua.min(self.full_scale_ua));
        // At most the greatest count.
        (current * u64::from(self.counts()) / u64::from(self.full_scale_ua.max(1))) as u16
    }
}

impl Sum for Scale {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { full_scale_ua, full_scale_counts } = *self;
        checksum.add(full_scale_ua);
        checksum.add(full_scale_counts.into());
    }
}

impl Sum for Stimulus {
    fn sum(&self, checksum: &mut Checksum) {
        let Self { amplitude_ua, width_us, gap_us, frequency_tenths_pps, recovery } = *self;
        checksum.add(amplitude_ua);
        checksum.add(u32::from(width_us) << 16 | u32::from(gap_us));
        checksum.add(u32::from(frequency_tenths_pps) << 16 | u32::from(recovery));
    }
}

/// A refused stimulus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StimulusError {
    /// Name of the field; `duration_us` is that of the pulse, which must fit into its period.
    pub field: &'static str,
    /// The refused value, in the field's unit.
    pub value: u32,
    /// Least allowed value.
    pub least: u32,
    /// Greatest allowed value.
    pub most: u32,
}

impl fmt::Display for StimulusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { field, value, least, most } = self;
        write!(f, "{field} = {value}: must be {least} to {most}")
    }
}

impl core::error::Error for StimulusError {}

pub(crate) fn within(
    field: &'static str,
    value: u32,
    least: u32,
    most: u32,
) -> Result<(), StimulusError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(StimulusError { field, value, least, most })
    }
}

/// Period of a frequency in pulses per ten seconds, µs; rounded up.
pub(crate) fn period_us(frequency_tenths_pps: u16) -> u32 {
    10_000_000_u32.div_ceil(frequency_tenths_pps.max(1).into())
}

impl Stimulus {
    /// Period, µs; rounded up, so that no second has a pulse too many.
    pub fn period_us(&self) -> u32 {
        period_us(self.frequency_tenths_pps)
    }

    /// Duration of a pulse with settling, µs.
    pub const fn duration_us(&self) -> u32 {
        let width = self.width_us as u32;
        let settling = 3 * SETTLE_US as u32;
        width + self.gap_us as u32 + width * self.recovery as u32 + settling
    }

    /// Validates the stimulus for a scale; the error has field, value and limit.
    pub fn validate(&self, scale: &Scale) -> Result<(), StimulusError> {
        within("amplitude_ua", self.amplitude_ua, 0, scale.full_scale_ua)?;
        self.validate_shape()?;
        within("frequency_tenths_pps", self.frequency_tenths_pps.into(), 10, 5000)?;
        within("duration_us", self.duration_us(), 0, self.period_us())
    }

    /// Validates width, gap and recovery only.
    pub(crate) fn validate_shape(&self) -> Result<(), StimulusError> {
        within("width_us", self.width_us.into(), LEAST_PHASE_US, MOST_WIDTH_US.into())?;
        within("gap_us", self.gap_us.into(), LEAST_GAP_US, MOST_GAP_US)?;
        within("recovery", self.recovery.into(), 1, MOST_RECOVERY.into())
    }
}
