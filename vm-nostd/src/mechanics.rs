//! The mechanics: fascicles between their mass and the tendon.

pub(crate) mod contraction;
mod decay;
