//! What the paper does not have.

pub(crate) mod fatigue;
pub(crate) mod recruitment_curve;
pub(crate) mod steady;
