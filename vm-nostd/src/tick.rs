//! What the equations of a tick are made of.

pub(crate) mod admission;
pub(crate) mod course;
pub(crate) mod lag;
pub(crate) mod range;
pub(crate) mod time_step;
