//! Virtual Muscle 4.0 without `std`: a model of human muscle that a stimulator or a prosthesis
//! steps once per tick inside its firmware.
//!
//! [`MuscleParams`] are validated once, when a [`Muscle`] is built for a [`TimeStep`]. After that
//! [`Muscle::step`] cannot fail, allocates nothing and has no loop that depends on data. Inputs
//! outside their range are clipped and flagged in [`Output::status`]. Firmware that takes a muscle
//! from words in flash ([`Muscle::from_words`]) contains no code that builds one.
//!
//! **Names:** [`Input::activation`] is U of the paper, which OpenSim and MuJoCo call excitation or
//! control. *Excitation* here (f_int, f_eff) is their activation dynamics. Velocities are in
//! optimal fascicle lengths per second (L_ce0/s), not in V_max.
//!
//! # Example
//!
//! ```
//! use vm_nostd::paper_table_1::{ELEMENTS, FAST, SLOW};
//! use vm_nostd::{Class, FesMuscle, FiberParams, Input, MuscleParams, TimeStep};
//!
//! let params = MuscleParams {
//!     mass: 97.5e-3,          // kg
//!     fascicle_length: 0.11,  // m
//!     tendon_length: 0.02,    // m
//!     max_path_length: 0.184, // m
//!     recruitment_saturation: 0.8,
//!     class: Class::Standard,
//!     elements: ELEMENTS,
//!     fibers: [
//!         FiberParams { fraction: 0.6, fiber_type: SLOW },
//!         FiberParams { fraction: 0.4, fiber_type: FAST },
//!     ],
//! };
//! let muscle = FesMuscle::<f32, 2>::build(&params, TimeStep::MILLISECOND)?;
//! let mut state = muscle.rest(0.16)?;
//! for _tick in 0..500 {
//!     let input = Input { activation: 0.5, path_length: 0.16, stimulation_frequency: 30.0 };
//!     let output = muscle.step(&mut state, input);
//!     assert!(output.status.is_empty() && output.force < 266.0); // N
//! }
//! # Ok::<(), vm_nostd::ParameterError>(())
//! ```
//!
//! # Modes
//!
//! | type | recruitment | [`Input::activation`] |
//! |---|---|---|
//! | [`ContinuousMuscle`] | natural, continuous | U, 0..1 |
//! | [`FesMuscle`] | FES at [`Input::stimulation_frequency`] | stimulus strength, 0..1 |
//! | [`DiscreteMuscle`] | natural, motor unit by motor unit | U, 0..1 |
//! | [`EffectiveLengthMuscle`] | the same, with an effective length per unit (VM 3.x) | U, 0..1 |
//!
//! All are a [`Muscle`]`<S, R, N>`: arithmetic `S`, recruitment `R`, `N` fibre types. A [`Bank`]
//! steps continuous and FES muscles together. [`RecruitmentCurve`] converts pulses to activation
//! and back, [`Fatigue`] scales force, and [`SteadyFes`] finds the activation that holds a force.
//!
//! # Arithmetics
//!
//! | `S` | for | path length | force | frequency |
//! |---|---|---|---|---|
//! | `f32` | cores with an FPU | m | N | pps |
//! | [`Fixed`] | cores without one (Q8.24); see [`Input::from_integers`] | µm | mN | pps |
//! | `f64` | tests | m | N | pps |
//!
//! Accuracy is a choice, too: [`Class`] selects the substeps of the mechanics.
//!
//! # Units
//!
//! Parameters are in SI units and `f64`. Forces are normalised to F0 = specific tension × PCSA,
//! where PCSA = mass/(density × fascicle length). Lengths of fascicles are in L_ce0, of the tendon
//! in L_se0, frequencies of a fibre type in f0.5, velocities in L_ce0/s and positive when
//! lengthening.
//!
//! # Equations and files
//!
//! | paper | item | unit | range | file |
//! |---|---|---|---|---|
//! | U | [`Input::activation`] | 1 | 0..1 | `recruitment/mode.rs` |
//! | f_stim | [`Input::stimulation_frequency`] | pps | 0..500 | `recruitment/fes.rs` |
//! | L_mt | [`Input::path_length`] | m | `path_domain` of the muscle | `domain.rs` |
//! | F0 F_se | [`Output::force`] | N | >= 0 | `equations/tendon.rs` |
//! | F_se | [`Output::relative_force`] | F0 | >= 0 | `equations/tendon.rs` |
//! | L | [`Output::fascicle_length`] | L_ce0 | `fascicle_domain` | `mechanics/contraction.rs` |
//! | V | [`Output::fascicle_velocity`] | L_ce0/s | -60..60 | `mechanics/contraction.rs` |
//! | U_eff | effective activation | 1 | 0..1 | `recruitment/continuous.rs` |
//! | W_i, Uth_i | recruitment | 1 | 0..1 | `recruitment/continuous.rs` |
//! | f_env | firing frequency | f0.5 | 0..10 | `recruitment/firing.rs` |
//! | pcsa_j, Uth_j | [`MotorUnits`], [`UnitSizes`] | 1 | 0..1 | `recruitment/motor_units.rs` |
//! | L_eff, T_L | effective length | L_ce0, s | as L; 5e-5..0.01 | `recruitment/acting_length.rs` |
//! | f_int, f_eff, T_f | [`ExcitationParams`] | f0.5, s | >= 0 | `equations/excitation.rs` |
//! | Af, n_f | [`ActivationParams`] | 1 | 0..1, >= 0.2 | `equations/activation_frequency.rs` |
//! | Y | [`YieldParams`] | 1 | 0..1 | `equations/yielding.rs` |
//! | S | [`SagParams`] | 1 | 0.01..10 | `equations/sag.rs` |
//! | FL | [`ForceLengthParams`] | 1 | 0..1 | `equations/force_length.rs` |
//! | FV | [`ForceVelocityParams`] | 1 | >= 0, V >= V_max | `equations/force_velocity.rs` |
//! | F_pe1, F_pe2 | `ParallelParams`, `CompressionParams` | F0 | any, ≤0 | `equations/passive.rs` |
//! | F_se(L_se) | [`TendonParams`] | F0 | >= 0 | `equations/tendon.rs` |
//! | F0 | [`MuscleParams::max_isometric_force`] | N | > 0 | `params.rs` |
//! | L_max | [`MuscleParams::maximum_fascicle_length`] | L_ce0 | 0.8..2 | `params.rs` |
//!
//! # Features
//!
//! - `serde`: parameters to and from any of its formats. They are validated when a muscle is built,
//!   not when they are read.
//! - `defmt`: [`Input`], [`Output`], [`Status`] and [`ParameterError`] implement `defmt::Format`.
//!
//! The default is none.
//!
//! # Source
//!
//! Song, Raphael, Lan & Loeb, "Computationally efficient models of neuromuscular recruitment and
//! mechanics", J. Neural Eng. 5 (2008) 175-184.
#![cfg_attr(not(test), no_std)]

mod bank;
mod beyond_paper;
mod checksum;
pub mod control;
mod curves;
mod domain;
mod emitted;
mod equations;
mod error;
mod fiber;
mod io;
#[cfg(feature = "defmt")]
mod logging;
mod mechanics;
mod muscle;
mod params;
mod recruitment;
mod saved;
mod scalar;
mod state;
mod status;
mod step;
mod summed;
#[cfg(test)]
mod tests;
mod tick;

pub use bank::{Bank, BankFull, BankedMuscle};
pub use beyond_paper::fatigue::{Fatigue, FatigueParams, FatigueState};
pub use beyond_paper::recruitment_curve::{
    Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams,
};
pub use beyond_paper::steady::{Steady, SteadyFes};
pub use checksum::Checksum;
pub use curves::{Curves, FiberCurves};
pub use emitted::{Differs, WordsError};
pub use equations::activation_frequency::ActivationParams;
pub use equations::excitation::ExcitationParams;
pub use equations::force_length::ForceLengthParams;
pub use equations::force_velocity::ForceVelocityParams;
pub use equations::passive::{CompressionParams, ParallelParams};
pub use equations::sag::SagParams;
pub use equations::tendon::TendonParams;
pub use equations::yielding::YieldParams;
pub use error::{Limit, ParameterError};
pub use io::{Input, Output};
pub use muscle::{ContinuousMuscle, DiscreteMuscle, EffectiveLengthMuscle, FesMuscle, Muscle};
pub use params::class::Class;
pub use params::presets::{feline_vm4, human_vm4, paper_table_1};
pub use params::{ElementParams, FiberParams, FiberType, MuscleParams};
#[doc(hidden)]
pub use recruitment::ActingLength;
pub use recruitment::{
    EffectiveLength, FascicleLength, IntramuscularFes, MotorUnits, NaturalContinuous,
    NaturalDiscrete, Recruitment, UnitSizes,
};
pub use saved::RestoreError;
pub use scalar::fixed::Fixed;
pub use scalar::{Representation, Scalar};
pub use state::State;
pub use status::Status;
pub use tick::time_step::TimeStep;

// Their types are in public signatures.
#[doc(no_inline)]
pub use {bitflags, fixed, heapless};
