//! Virtual Muscle 4.0 without `std`: a model of human muscle, by fibre type, that a stimulator
//! or a prosthesis steps once per tick inside its firmware.
//!
//! [`MuscleParams`] are validated once, when a [`Muscle`] is built for a [`TimeStep`]; after
//! that [`Muscle::step`] cannot fail, allocates nothing and has no loop that depends on data.
//! Inputs outside the stated domain are saturated and reported in [`Output::status`].
//!
//! Source: Song, Raphael, Lan & Loeb, "Computationally efficient models of neuromuscular
//! recruitment and mechanics", J. Neural Eng. 5 (2008) 175-184.
#![cfg_attr(not(test), no_std)]

mod activation;
mod bank;
mod checksum;
mod contraction;
mod domain;
mod error;
mod excitation;
mod fatigue;
mod force_length;
mod force_velocity;
mod lag;
mod muscle;
#[cfg(test)]
mod oracle;
mod params;
mod passive;
mod presets;
mod recruitment;
mod recruitment_curve;
mod sag;
#[cfg(test)]
mod saturation;
mod scalar;
mod state;
mod steady;
mod tendon;
mod time_step;
mod units;
mod yielding;

pub use activation::ActivationParams;
pub use bank::{Bank, BankFull, BankedMuscle};
pub use checksum::Checksum;
pub use domain::Status;
pub use error::{Limit, ParameterError};
pub use excitation::ExcitationParams;
pub use fatigue::{Fatigue, FatigueParams, FatigueState};
pub use force_length::ForceLengthParams;
pub use force_velocity::ForceVelocityParams;
pub use muscle::{
    ContinuousMuscle, DiscreteMuscle, EffectiveLengthMuscle, FesMuscle, Input, Muscle, Output,
};
pub use params::{ElementParams, FiberParams, FiberType, MuscleParams};
pub use passive::{CompressionParams, ParallelParams};
pub use presets::{feline_vm4, human_vm4, paper_table_1};
#[doc(hidden)]
pub use recruitment::ActingLength;
pub use recruitment::{
    EffectiveLength, FascicleLength, IntramuscularFes, MotorUnits, NaturalContinuous,
    NaturalDiscrete, Recruitment, UnitSizes,
};
pub use recruitment_curve::{Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams};
pub use sag::SagParams;
pub use scalar::Scalar;
pub use scalar::fixed::Fixed;
pub use state::{RestoreError, State};
pub use steady::{Steady, SteadyFes};
pub use tendon::TendonParams;
pub use time_step::TimeStep;
pub use yielding::YieldParams;
