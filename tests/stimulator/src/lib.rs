//! Tests of the stimulator's library live in `tests/stimulator/tests`: they build without `host-sim`.

pub mod bench;
pub mod client;
pub mod device;
pub mod electrodes;
pub mod host;
