//! The equations of the paper, one per file.

pub(crate) mod activation_frequency;
pub(crate) mod excitation;
pub(crate) mod force_length;
pub(crate) mod force_velocity;
pub(crate) mod passive;
pub(crate) mod sag;
pub(crate) mod tendon;
pub(crate) mod yielding;
