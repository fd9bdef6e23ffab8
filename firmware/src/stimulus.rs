//! What a channel is to do, and what a stimulator can.

use core::fmt;
use serde::{Deserialize, Serialize};

/// Shortest phase, µs: the pulse timer's interrupt that begins it sets how long the next one lasts, and has to be
/// through by then.
pub const LEAST_PHASE_US: u32 = 20;

/// Without current before anything is switched, and after it, µs: converters and switches have settled by then.
pub(crate) const SETTLE_US: u16 = LEAST_PHASE_US as u16;
/// Shortest gap, µs: settling, and turning the bridge.
const LEAST_GAP_US: u32 = 2 * LEAST_PHASE_US;

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
    /// The greatest count: 4095 of a converter of 12 bits.
    pub full_scale_counts: u16,
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

impl Stimulus {
    /// From the start of a pulse to that of the next, µs; rounded down.
    pub fn period_us(&self) -> u32 {
        10_000_000 / u32::from(self.frequency_tenths_pps.max(1))
    }

    /// From the start of a pulse until another may begin, settling included, µs.
    pub fn duration_us(&self) -> u32 {
        let width = u32::from(self.width_us);
        let settling = 3 * u32::from(SETTLE_US);
        width + u32::from(self.gap_us) + width * u32::from(self.recovery) + settling
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
        within("width_us", self.width_us.into(), LEAST_PHASE_US, 1000)?;
        within("gap_us", self.gap_us.into(), LEAST_GAP_US, 200)?;
        within("recovery", self.recovery.into(), 1, 8)
    }
}
