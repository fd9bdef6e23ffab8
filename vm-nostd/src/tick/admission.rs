//! An input as a range admits it, and what was wrong with it.

use crate::status::Status;
use crate::tick::range::Range;

/// What was wrong with an input.
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

/// A value as a range admits it, and what was wrong with it; `instead` is taken for not-a-number.
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
