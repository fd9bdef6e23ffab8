//! Messages of the closed loop: a joint's controller and what it commands.

use crate::config::MUSCLES;
use serde::{Deserialize, Serialize};
use vm_nostd::FatigueParams;
use vm_nostd::control::{AngleRange, GainParams, LimbParams, PathParams, PiParams};

/// A controller of a joint: the muscle at place 0 is the flexor, that at place 1 the extensor. Both
/// are uploaded before, with electrodes. For its fields see
/// [`FesControllerParams`](vm_nostd::control::FesControllerParams).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlUpload {
    /// Range of the joint, rad: targets are refused beyond it.
    pub range: AngleRange,
    /// Paths of both muscles.
    pub paths: [PathParams<1>; MUSCLES],
    /// The limb.
    pub limb: LimbParams,
    /// What carries the command to each muscle.
    pub modulation: [Modulation; MUSCLES],
    /// pps; 1 to 100.
    pub stimulation_frequency: f64,
    /// N m; 0 to 100.
    pub cocontraction: f64,
    /// Feedback of the angle.
    pub feedback: PiParams,
    /// s; 0.001 to 1.
    pub expected_lag: f64,
    /// s.
    pub lead_filter_time: f64,
    /// Fatigue that is made up for, if any.
    pub fatigue: [Option<FatigueParams>; MUSCLES],
    /// 0.1 to 1.
    pub least_fitness: f64,
    /// Estimate of the muscles' gain, if any.
    pub gain: Option<GainParams>,
    /// Least and greatest torque, N m; also of a target.
    pub torque: (f64, f64),
    /// Period of the angle's readings, µs; 1,000 to 10,000.
    pub sensor_period_us: u32,
}

/// What carries the command of a controller to a muscle's [`Electrode`](super::Electrode).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Modulation {
    /// The width, up to the electrode's, at this amplitude (µA; 100 to 200,000).
    Width {
        /// µA.
        amplitude_ua: u32,
    },
    /// The amplitude, up to this one (µA; 1 to 500,000), at the electrode's width.
    Amplitude {
        /// µA.
        most_ua: u32,
    },
}

/// What a controller commands in a tick, bit by bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Commanded {
    /// Stimulation of flexor and extensor, 0..1.
    pub activations: [f32; MUSCLES],
    /// Pulses that recruit it: mA and µs.
    pub pulses: [(f32, f32); MUSCLES],
    /// Torque asked of the model, N m.
    pub torque: f32,
    /// Estimated gain of the muscles.
    pub gain: f32,
    /// Flags of the controller.
    pub status: u16,
    /// Checksum of its state after the tick.
    pub state: u32,
}
