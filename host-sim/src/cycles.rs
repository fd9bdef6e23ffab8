//! Cycles per tick on a Cortex-M4F, M3 or M0+, estimated from the executed instructions.
//!
//! QEMU runs the image and a plugin streams the addresses of executed instructions; each is decoded
//! once, and a timing model of the core adds up cycles. Flash wait states are not modelled.

mod adversarial;
mod bench;
mod boot;
mod breakdown;
mod budgets;
mod case;
mod core;
mod estimator;
mod follow;
mod image;
mod instruction;
mod profile;
mod reach;
mod report;
mod row;
mod source;
mod timing;
mod trace;
mod unit_costs;

pub use boot::{Argument, ArgumentError, BootError};
pub use breakdown::{Part, by_class, by_function, hottest};
pub use core::Core;
pub use estimator::Cost;
pub(crate) use estimator::Decoded;
pub(crate) use image::Image;
pub use image::ImageError;
pub(crate) use instruction::Class;
pub use instruction::Instruction;
pub use profile::{MACHINE, Profile, ProfileError, of_case, of_image};
pub use reach::{Reached, reachable};
pub use report::{ReportError, is_listed, report, state_bytes};
pub use row::{CLOCKS, MARGIN, Row, Share, Spread};
pub use trace::Tracer;
pub use unit_costs::UnitCost;
