//! Tests across files.

mod kernels;
mod oracle;
mod saturation;
mod words;
