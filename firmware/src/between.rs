//! What the levels hand each other, and what all of them know.

pub(crate) mod fault;
pub(crate) mod guarded;
pub(crate) mod limits;
pub(crate) mod link_queues;
pub(crate) mod motion;
pub(crate) mod permission;
pub(crate) mod plan;
pub(crate) mod shared;
pub(crate) mod step;
pub(crate) mod stimulus;
pub(crate) mod waveform;

#[cfg(test)]
mod tests;
