//! Tests across files.

mod oracle;
mod saturation;
mod words;
