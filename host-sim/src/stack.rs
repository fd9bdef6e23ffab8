//! Worst-case stack of a program for a Cortex-M, computed from its image.
//!
//! Every function is walked instruction by instruction, tracking the stack depth; callees add to
//! the depth at their call. An indirect call, a frame of unknown size or recursion is reported as a
//! problem, because the depth is then unknown. Interrupts nest: each priority adds its deepest
//! handler and the exception frame.

mod calls;
mod description;
mod effect;
mod function;
mod report;

pub use calls::{Deepest, Step};
pub use description::{Description, Ends, Handler, Indirect, Priority, Ram, Thread};
pub use report::{Entry, Report, StackError, report};
