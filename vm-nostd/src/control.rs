//! Control of joints by the model: from angles and targets to torques and stimulation, once a tick.
//!
//! [`Joint`] turns angles into paths and forces into torques; [`ANKLE`], [`KNEE`] and [`ELBOW`] are
//! joints with two published muscles each. [`Prosthesis`] turns two EMGs into torque and stiffness.

mod envelope;
mod joint;
mod joint_presets;
mod limit;
mod path;
mod prosthesis;
mod saved;
mod stiffness;

pub use envelope::{Envelope, EnvelopeParams, EnvelopeState};
pub use joint::{Joint, JointError, JointMuscle, JointStatus, Posture};
pub use joint_presets::{ANKLE, ELBOW, JointPreset, KNEE, MuscleOnJoint};
pub use limit::CommandLimits;
pub use path::{Action, AngleRange, LEAST_ARM, ORDER, PathParams, Placed};
pub use prosthesis::{
    Prosthesis, ProsthesisCommand, ProsthesisInput, ProsthesisParams, ProsthesisState,
    ProsthesisStatus,
};
pub use stiffness::Lumped;
