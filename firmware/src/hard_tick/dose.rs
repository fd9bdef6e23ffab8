//! What a stimulus does to a patient: its charge and its mean square.

use crate::between::stimulus::Stimulus;

/// Charge of a phase, nC, rounded up, from µA times µs in pC.
pub(crate) fn charge_nc(stimulus: &Stimulus) -> u64 {
    (u64::from(stimulus.amplitude_ua) * u64::from(stimulus.width_us)).div_ceil(1000)
}

/// Mean square of a channel's current, µA²: A² w (1 + 1/k) f, with a recharge phase that is k times
/// weaker and longer. Saturates; amplitudes count up to 1 A, above every limit.
pub(crate) fn mean_square(stimulus: &Stimulus) -> u64 {
    let amplitude = u64::from(stimulus.amplitude_ua.min(1_000_000));
    let recovery = u64::from(stimulus.recovery.max(1));
    let on_us = u64::from(stimulus.width_us) * (recovery + 1);
    let frequency = u64::from(stimulus.frequency_tenths_pps);
    // 10^12 times 2^24 fits; 10^7 is µs in a second, and tenths of a pulse.
    (amplitude * amplitude * on_us / 10_000).saturating_mul(frequency) / recovery / 1_000
}
