//! Tests of the stimulator's library live in `tests/stimulator/tests`: they build without
//! `host-sim`.

pub mod bench;
pub mod client;
pub mod device;
pub mod electrodes;
pub mod explorer;
pub mod host;
pub mod joint;
pub mod levels;
pub mod patient;
pub mod world;
