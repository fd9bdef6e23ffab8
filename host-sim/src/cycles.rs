//! What a tick costs on a Cortex-M4F, in cycles, from the instructions that really execute.
//!
//! QEMU runs the image and a plugin streams the address of every instruction; each address is
//! decoded once, and a timing model of the core adds up cycles. Flash wait states are not in it.

mod adversarial;
mod bench;
mod image;
mod instruction;
mod report;
mod timing;
mod trace;

pub use bench::{BenchError, Case, Cost, Measured, measure};
pub use image::{Function, Image, ImageError};
pub use instruction::{Class, Decoder, Instruction};
pub use report::{Budget, ReportError, Row, report};
pub use timing::{Core, Setting};
pub use trace::{TraceError, execute};
