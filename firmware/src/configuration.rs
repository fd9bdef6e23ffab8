//! Build-time configuration.

use crate::limits::{LONGEST_TICK_US, SHORTEST_TICK_US};

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
