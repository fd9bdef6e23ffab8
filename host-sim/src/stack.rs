//! Worst-case stack of a program for a Cortex-M, computed from its image.
//!
//! Every function is walked instruction by instruction with the stack depth at each; calls are
//! followed from the depth at which they are made. An indirect call, a frame of unknown size or
//! recursion makes the result unknown and is named. Interrupts nest: each priority adds its deepest
//! handler and the exception frame.

mod calls;
mod description;
mod effect;
mod function;
mod report;

pub use calls::{Deepest, Step};
pub use description::{Description, Ends, Handler, Indirect, Priority, Ram, Thread};
pub use report::{Entry, Report, StackError, report};
