//! What a channel is to do, and what a stimulator can.

use crate::guarded::Sum;
use core::fmt;
use serde::{Deserialize, Serialize};
use vm_nostd::Checksum;

/// Shortest phase, µs: the pulse timer's interrupt that begins it sets how long the next one lasts, and has to be
/// through by then.
pub const LEAST_PHASE_US: u32 = 20;

/// Without current before anything is switched, and after it, µs: converters and switches have settled by then.
pub(crate) const SETTLE_US: u16 = LEAST_PHASE_US as u16;
/// Shortest gap, µs: settling, and turning the bridge.
const LEAST_GAP_US: u32 = 2 * LEAST_PHASE_US;
/// Widest phase that stimulates, µs.
pub(crate) const MOST_WIDTH_US: u16 = 1000;
/// Longest gap, µs.
const MOST_GAP_US: u32 = 200;
/// How many times longer the recharge phase may be.
pub(crate) const MOST_RECOVERY: u8 = 8;
/// The strongest current source, µA.
pub(crate) const MOST_FULL_SCALE_UA: u32 = 500_000;
/// The greatest count of the converter that the output stage speaks to.
pub(crate) const MOST_COUNTS: u16 = 4095;
/// Longest pulse of any legal stimulus, settling included, µs.
pub(crate) const LONGEST_PULSE_US: u32 = Stimulus {
    amplitude_ua: 0,
    width_us: MOST_WIDTH_US,
    gap_us: MOST_GAP_US as u16,
    frequency_tenths_pps: 10,
    recovery: MOST_RECOVERY,
}
.duration_us();

/// Pulses of one channel, until it is told otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stimulus {
    /// Of the phase that stimulates, µA; 0 to [`Scale::full_scale_ua`].
    pub amplitude_ua: u32,
    /// Of the phase that stimulates, µs; [`LEAST_PHASE_US`] to 1,000.
    pub width_us: u16,
    /// Between the phases, µs; 40 to 200.
    pub gap_us: u16,
    /// Pulses in ten seconds; 10 (one a second) to 5,000.
    pub frequency_tenths_pps: u16,
    /// How many times weaker, and longer, the phase is that takes the charge back; 1 to 8.
    pub recovery: u8,
}

/// How the current source turns counts into current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// Current at the greatest count, µA; 1 to 500,000.
    pub full_scale_ua: u32,
    /// The greatest count; 8 to 4095, which is that of a converter of 12 bits.
    pub full_scale_counts: u16,
}

impl Scale {
    /// The greatest count; 1 where the scale says none.
    pub(crate) const fn counts(&self) -> u32 {
        if self.full_scale_counts == 0 { 1 } else { self.full_scale_counts as u32 }
    }

    /// Counts of a current (µA), rounded down; those of full scale for any beyond it.
    pub(crate) fn counts_of(&self, current_ua: u32) -> u16 {
        // 64 bits: µA times counts may have 35.
        let current = u64::from(current_ua.min(self.full_scale_ua));
        // No more than the greatest count.
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

/// A stimulus was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StimulusError {
    /// The field, by its name; `duration_us` is the pulse's, which has to fit into its period.
    pub field: &'static str,
    /// The refused value, in the field's unit.
    pub value: u32,
    /// The least that is taken.
    pub least: u32,
    /// The most that is taken.
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

/// Of so many pulses in ten seconds, µs; rounded up.
pub(crate) fn period_us(frequency_tenths_pps: u16) -> u32 {
    10_000_000_u32.div_ceil(frequency_tenths_pps.max(1).into())
}

impl Stimulus {
    /// From the start of a pulse to that of the next, µs; rounded up, or there would be a pulse too many in a second.
    pub fn period_us(&self) -> u32 {
        period_us(self.frequency_tenths_pps)
    }

    /// From the start of a pulse until another may begin, settling included, µs.
    pub const fn duration_us(&self) -> u32 {
        let width = self.width_us as u32;
        let settling = 3 * SETTLE_US as u32;
        width + self.gap_us as u32 + width * self.recovery as u32 + settling
    }

    /// Whether a stimulator of that scale can do it; the error names the field, its value and the limit it
    /// broke.
    pub fn validate(&self, scale: &Scale) -> Result<(), StimulusError> {
        within("amplitude_ua", self.amplitude_ua, 0, scale.full_scale_ua)?;
        self.validate_shape()?;
        within("frequency_tenths_pps", self.frequency_tenths_pps.into(), 10, 5000)?;
        within("duration_us", self.duration_us(), 0, self.period_us())
    }

    /// The same of what does not change from pulse to pulse: width, gap and recovery.
    pub(crate) fn validate_shape(&self) -> Result<(), StimulusError> {
        within("width_us", self.width_us.into(), LEAST_PHASE_US, MOST_WIDTH_US.into())?;
        within("gap_us", self.gap_us.into(), LEAST_GAP_US, MOST_GAP_US)?;
        within("recovery", self.recovery.into(), 1, MOST_RECOVERY.into())
    }
}
