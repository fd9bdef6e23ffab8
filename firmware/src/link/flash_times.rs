//! How long flash holds up the core.

use super::storage::MOST_WRITTEN;

/// Longest erase of a sector of 128 KB at x8, ms (2,000 typically). `stm32f4xx-hal` uses x8, which
/// any supply allows.
pub const MOST_ERASE_MS: u32 = 4_000;
/// Longest write of a byte, µs (16 typically).
const MOST_WRITE_US: u32 = 100;
/// Longest time to store a content, ms.
pub const MOST_STORE_MS: u32 = MOST_ERASE_MS + (MOST_WRITTEN as u32 * MOST_WRITE_US).div_ceil(1000);
