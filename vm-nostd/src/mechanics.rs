//! The mechanics: a mass between the fascicles and the tendon.

pub(crate) mod contraction;
mod decay;
mod elementwise;
