//! Parameters of a prosthesis in C.

use crate::control::VM_ANTAGONISTS;
use crate::control::fes_params::antagonists;
use crate::control::joint_params::{VmAngleRange, VmPath};
use crate::params::VmMuscleParams;
use crate::result::Refusal;
use model::control::{CommandLimits, EnvelopeParams, ProsthesisParams};

/// Ticks that an envelope can delay by.
pub const VM_DELAY_TICKS: usize = 100;

/// Envelope of an EMG.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmEnvelope {
    /// Mean rectified EMG at rest, mV; 0 to 9.
    pub rest_mv: f64,
    /// Mean rectified EMG of a maximal voluntary contraction, mV; 0.001 and 5 % more than at rest,
    /// to 10.
    pub maximal_mv: f64,
    /// Cutoff, Hz; 0.5 to 20.
    pub cutoff_frequency_hz: f64,
    /// Electromechanical delay, s; 0 to 100 ticks.
    pub delay_s: f64,
    /// Shape; -3 to 0. More negative raises weak contractions.
    pub shape: f64,
}

/// Limits of a torque.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmTorqueLimits {
    /// Least torque, N m; -30,000 to 30,000.
    pub least_nm: f64,
    /// Greatest torque, N m; at least the least, to 30,000.
    pub most_nm: f64,
    /// Greatest change, N m/s; 1.2e-4 per time step (0.12 at 1 ms) to 1e7.
    pub rate_nm_per_s: f64,
}

/// Limits of a stiffness.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmStiffnessLimits {
    /// Least stiffness, N m/rad; -30,000 to 30,000.
    pub least_nm_per_rad: f64,
    /// Greatest stiffness, N m/rad; at least the least, to 30,000.
    pub most_nm_per_rad: f64,
    /// Greatest change, N m/rad/s; 1.2e-4 per time step (0.12 at 1 ms) to 1e7.
    pub rate_nm_per_rad_s: f64,
}

/// A prosthesis; pairs are flexor and extensor.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmProsthesisParams {
    /// Range of the joint.
    pub range: VmAngleRange,
    /// Muscles, of as many fibre types.
    pub muscles: [VmMuscleParams; VM_ANTAGONISTS],
    /// Their paths, of one angle.
    pub paths: [VmPath; VM_ANTAGONISTS],
    /// Their EMGs.
    pub envelopes: [VmEnvelope; VM_ANTAGONISTS],
    /// Limits of the torque.
    pub torque: VmTorqueLimits,
    /// Limits of the stiffness.
    pub stiffness: VmStiffnessLimits,
}

impl VmProsthesisParams {
    pub(crate) fn model<const N: usize>(&self) -> Result<ProsthesisParams<N>, Refusal> {
        let (muscles, paths) = antagonists(&self.muscles, &self.paths)?;
        let (torque, stiffness) = (&self.torque, &self.stiffness);
        Ok(ProsthesisParams {
            range: self.range.model(),
            muscles,
            paths,
            envelopes: self.envelopes.map(|envelope| EnvelopeParams {
                rest: envelope.rest_mv,
                maximal: envelope.maximal_mv,
                cutoff_frequency: envelope.cutoff_frequency_hz,
                delay: envelope.delay_s,
                shape: envelope.shape,
            }),
            torque: CommandLimits {
                least: torque.least_nm,
                most: torque.most_nm,
                rate: torque.rate_nm_per_s,
            },
            stiffness: CommandLimits {
                least: stiffness.least_nm_per_rad,
                most: stiffness.most_nm_per_rad,
                rate: stiffness.rate_nm_per_rad_s,
            },
        })
    }
}
