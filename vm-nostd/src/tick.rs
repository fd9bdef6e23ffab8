//! Building blocks of a tick: inputs, ranges, lags and the time step.

pub(crate) mod admission;
pub(crate) mod course;
pub(crate) mod lag;
pub(crate) mod range;
pub(crate) mod time_step;
