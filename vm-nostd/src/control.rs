//! Control of joints by the model: from angles and targets to torques and stimulation, once a tick.
//!
//! [`Joint`] turns angles into paths and forces into torques; [`ANKLE`], [`KNEE`] and [`ELBOW`] are
//! joints with two published muscles each. [`Prosthesis`] turns two EMGs into torque and stiffness.
//! [`FesController`] turns a target angle or torque into stimulation of two antagonists, and
//! [`Intervals`] pulses that are not periodic into a stimulation frequency.

mod electrode;
mod envelope;
mod feed_forward;
mod fes_controller;
mod fes_io;
mod fes_params;
mod fes_saved;
mod fes_state;
mod gain_estimate;
mod intervals;
mod joint;
mod joint_presets;
mod lead;
mod limb;
mod limit;
mod path;
mod path_params;
mod pi;
mod prosthesis;
mod saved;
mod steady_natural;
mod stiffness;

pub use envelope::{Envelope, EnvelopeParams, EnvelopeState};
pub use fes_controller::FesController;
pub use fes_io::{ControlStatus, FesCommand, Sensors, Target};
pub use fes_params::{FesControllerParams, Measured, Modulation};
pub use fes_state::FesControllerState;
pub use gain_estimate::{GainEstimate, GainParams, Learnt};
pub use intervals::{IntervalState, Intervals};
pub use joint::{Joint, JointError, JointMuscle, JointStatus, Posture};
pub use joint_presets::{ANKLE, ELBOW, JointPreset, KNEE, MuscleOnJoint};
pub use lead::{Lead, LeadParams, LeadState};
pub use limb::LimbParams;
pub use limit::CommandLimits;
pub use path::Placed;
pub use path_params::{Action, AngleRange, LEAST_ARM, ORDER, PathParams};
pub use pi::{Pi, PiParams, PiState, Saturated};
pub use prosthesis::{
    Prosthesis, ProsthesisCommand, ProsthesisInput, ProsthesisParams, ProsthesisState,
    ProsthesisStatus,
};
pub use steady_natural::SteadyNatural;
pub use stiffness::Lumped;
