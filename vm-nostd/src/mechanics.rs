//! The mechanics: fascicles between their mass and the tendon.

mod abreast;
pub(crate) mod contraction;
mod decay;
