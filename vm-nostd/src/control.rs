//! Control of joints by the model: from angles and targets to torques and stimulation, once a tick.
//!
//! [`Joint`] turns angles into paths and forces into torques; [`ANKLE`], [`KNEE`] and [`ELBOW`] are
//! joints with two published muscles each. [`Prosthesis`] turns two EMGs into torque and stiffness.
//! [`FesController`] turns a target angle or torque into stimulation of two antagonists, and
//! [`Intervals`] pulses that are not periodic into a stimulation frequency.

mod envelope;
mod feed_forward;
mod fes_controller;
mod fes_params;
mod gain_estimate;
mod intervals;
mod joint;
mod joint_presets;
mod lead;
mod limb;
mod limit;
mod path;
mod pi;
mod prosthesis;
mod saved;
mod steady_natural;
mod stiffness;

pub use envelope::{Envelope, EnvelopeParams, EnvelopeState};
pub use fes_controller::{
    ControlStatus, FesCommand, FesController, FesControllerState, Sensors, Target,
};
pub use fes_params::{FesControllerParams, Measured, Modulation};
pub use gain_estimate::{GainEstimate, GainParams, Learnt};
pub use intervals::{IntervalState, Intervals};
pub use joint::{Joint, JointError, JointMuscle, JointStatus, Posture};
pub use joint_presets::{ANKLE, ELBOW, JointPreset, KNEE, MuscleOnJoint};
pub use lead::{Lead, LeadParams, LeadState};
pub use limb::LimbParams;
pub use limit::CommandLimits;
pub use path::{Action, AngleRange, LEAST_ARM, ORDER, PathParams, Placed};
pub use pi::{Pi, PiParams, PiState, Saturated};
pub use prosthesis::{
    Prosthesis, ProsthesisCommand, ProsthesisInput, ProsthesisParams, ProsthesisState,
    ProsthesisStatus,
};
pub use steady_natural::SteadyNatural;
pub use stiffness::Lumped;
