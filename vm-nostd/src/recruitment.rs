//! Recruitment modes: activation to firing and force of the fibre types; one file per mode.

mod acting_length;
mod continuous;
mod discrete;
mod fes;
mod firing;
mod lumped;
mod mode;
mod motor_units;
mod unit;

pub use acting_length::{ActingLength, EffectiveLength, FascicleLength};
pub use continuous::NaturalContinuous;
pub use discrete::NaturalDiscrete;
pub use fes::IntramuscularFes;
pub use lumped::LumpedState;
pub use mode::{Moment, Recruitment, RecruitmentState, RecruitmentTick};
pub use motor_units::{MotorUnits, UnitSizes};
