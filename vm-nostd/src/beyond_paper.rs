//! Extensions beyond the paper.

pub(crate) mod fatigue;
pub(crate) mod recruitment_curve;
pub(crate) mod steady;
