//! Tests of the model that need no reference live in `tests/model/tests`: they build without
//! `host-sim`.

pub mod knee;
pub mod muscles;
