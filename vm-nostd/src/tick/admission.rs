//! Clamps inputs to their validity ranges.

use crate::status::Status;
use crate::tick::range::Range;

/// Whether an input was clipped or not finite.
#[derive(Clone, Copy)]
pub(crate) enum Admission {
    AsIs,
    Clipped,
    NotFinite,
}

impl Admission {
    pub(crate) fn flags(self, clipped: Status, not_finite: Status) -> Status {
        match self {
            Self::AsIs => Status::empty(),
            Self::Clipped => clipped,
            Self::NotFinite => not_finite,
        }
    }
}

/// Clamps a value to a range; NaN is replaced by `instead`. Infinities are clamped too, but
/// reported as not finite.
pub(crate) fn admit_one<T: Copy + PartialOrd>(
    range: &Range<T>,
    value: T,
    instead: T,
    is_finite: impl Fn(T) -> bool,
) -> (T, Admission) {
    if range.contains(value) {
        return (value, Admission::AsIs);
    }
    let is_number = value.partial_cmp(&value).is_some();
    let (clipped, _) = range.clip(if is_number { value } else { instead });
    (clipped, if is_finite(value) { Admission::Clipped } else { Admission::NotFinite })
}
