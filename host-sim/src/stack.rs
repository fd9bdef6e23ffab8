//! The most stack that a program for a Cortex-M can take, computed from its image.
//!
//! Every function is walked instruction by instruction with the depth of the stack at each; calls are followed from
//! the depth at which they are made. What cannot be followed (a call by a register, a frame whose size is not in its
//! instructions, recursion) makes the answer unknown, and is named. Interrupts nest: each priority adds its deepest
//! handler and what the core itself pushes.

mod calls;
mod description;
mod effect;
mod function;
mod report;

pub use calls::{Deepest, Step};
pub use description::{Description, Ends, Handler, Indirect, Priority, Ram, Thread};
pub use report::{Entry, Report, StackError, report};
