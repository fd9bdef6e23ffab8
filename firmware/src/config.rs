//! Build-time configuration.

use crate::between::stimulus::Scale;

/// The shortest tick, µs.
pub(crate) const SHORTEST_TICK_US: u32 = 500;
/// The longest tick, µs.
pub(crate) const LONGEST_TICK_US: u32 = 2000;

/// Tick time, µs: `VM_TICK_US` at build time, 500 to 2,000, by default 1,000. Other values do not
/// build.
pub const TICK_US: u32 = match option_env!("VM_TICK_US") {
    None => 1000,
    Some(text) => match u32::from_str_radix(text, 10) {
        Ok(tick_us) => tick_us,
        Err(_) => panic!("VM_TICK_US: must be a whole number"),
    },
};
const _: () = assert!(
    TICK_US >= SHORTEST_TICK_US && TICK_US <= LONGEST_TICK_US,
    "VM_TICK_US: must be 500 to 2000"
);

/// Muscles of a device.
pub const MUSCLES: usize = 2;
/// Fibre types of each muscle.
pub const TYPES: usize = 2;
/// Channels of the output stage.
pub const CHANNELS: usize = 4;
/// Current source of the board: 50 mA at 4095 counts.
pub const SCALE: Scale = Scale { full_scale_ua: 50_000, full_scale_counts: 4095 };
