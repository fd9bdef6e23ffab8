//! The independent reference: Virtual Muscle 4.0 in `f64`, written from the paper.
//!
//! It shares no code with `vm-nostd` (a test checks), since shared code would share bugs. Symbols
//! are the paper's, so that each line can be compared with the page.
//!
//! Source: Song, Raphael, Lan & Loeb, J. Neural Eng. 5 (2008) 175-184.

mod elements;
mod fatigue;
mod muscle;
mod pennation;
mod recruitment;
mod simulation;
mod units;

pub use fatigue::Fatigue;
pub use muscle::{Elements, Fiber, FiberType, Muscle, Sag, Yielding};
pub use pennation::Pennation;
pub use recruitment::Mode;
pub use simulation::{Input, Sample, Simulation, SolverError};
pub use units::UnitSizes;
