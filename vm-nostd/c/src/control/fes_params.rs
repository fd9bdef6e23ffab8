//! Parameters of the FES controller in C.

use crate::choice::{FLAG, choice};
use crate::control::VM_ANTAGONISTS;
use crate::control::joint_params::{VmAngleRange, VmPath};
use crate::extras::{VmCurveParams, VmFatigueParams};
use crate::params::VmMuscleParams;
use crate::result::Refusal;
use model::control::{
    FesControllerParams, GainParams, LimbParams, Measured, Modulation, PathParams, PiParams,
};
use model::{MuscleParams, ParameterError};

/// VmFesParams.measured: the joint's angle.
pub const VM_MEASURED_ANGLE: u32 = 0;
/// VmFesParams.measured: the muscles' torque.
pub const VM_MEASURED_TORQUE: u32 = 1;

/// VmModulation.modulated: the width carries the command, at `amplitude_a`.
pub const VM_MODULATE_WIDTH: u32 = 0;
/// VmModulation.modulated: the amplitude carries the command, at `width_s`.
pub const VM_MODULATE_AMPLITUDE: u32 = 1;

/// The limb that a joint moves.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmLimb {
    /// Inertia about the joint, kg m^2; 0 to 10.
    pub inertia_kg_m2: f64,
    /// Damping, N m s/rad; 0 to 100.
    pub damping_nm_s_per_rad: f64,
    /// Weight times the distance of its centre, N m; 0 to 200, and 0 where the joint's range is
    /// wider than 4 rad.
    pub gravity_nm: f64,
    /// Angle at which the limb hangs straight down, rad; -6.3 to 6.3.
    pub hanging_angle_rad: f64,
}

/// Which half of the pulse carries the command.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmModulation {
    /// VM_MODULATE_WIDTH (0) or VM_MODULATE_AMPLITUDE.
    pub modulated: u32,
    /// Amplitude of VM_MODULATE_WIDTH, A; 1e-4 to 0.2, and to 100 times the curve's saturation.
    pub amplitude_a: f64,
    /// Width of VM_MODULATE_AMPLITUDE, s; 2e-5 to 1e-3.
    pub width_s: f64,
}

/// Gains of the feedback, in N m per rad; with VM_MEASURED_TORQUE in N m per N m.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmFeedback {
    /// k_p; 0 to 1,000.
    pub proportional: f64,
    /// k_i, per s; 0 to 10,000.
    pub integral_per_s: f64,
    /// k_d, times s; 0 to 100.
    pub derivative_s: f64,
    /// Filter time of the derivative, s; 0.005 to 1.
    pub derivative_filter_s: f64,
    /// Greatest torque of the integral, N m; 0 to 1,000.
    pub most_integral_nm: f64,
}

/// On-line estimate of the muscles' gain.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmGain {
    /// Time constant, s; 0.1 to 1,000.
    pub time_s: f64,
    /// Least gain; 0.1 to 1.
    pub least_gain: f64,
    /// Greatest gain; 1 to 10.
    pub most_gain: f64,
    /// Torque below which nothing can be learnt, N m; 0.01 to 100.
    pub excitation_nm: f64,
}

/// An FES controller of a joint; pairs are flexor and extensor.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmFesParams {
    /// Range of the joint; targets are clipped to it.
    pub range: VmAngleRange,
    /// Muscles, of as many fibre types.
    pub muscles: [VmMuscleParams; VM_ANTAGONISTS],
    /// Their paths, of one angle.
    pub paths: [VmPath; VM_ANTAGONISTS],
    /// The limb that moves.
    pub limb: VmLimb,
    /// Electrodes.
    pub electrodes: [VmCurveParams; VM_ANTAGONISTS],
    /// How they are driven.
    pub modulation: [VmModulation; VM_ANTAGONISTS],
    /// Stimulation frequency, pps; 1 to 100.
    pub stimulation_frequency_pps: f64,
    /// Torque that each muscle makes against the other, N m; 0 to 100.
    pub cocontraction_nm: f64,
    /// Feedback.
    pub feedback: VmFeedback,
    /// Lag of the joint behind the target that the feedback expects, s; 0.001 to 1.
    pub expected_lag_s: f64,
    /// Filter time of the lead, s; a tenth of the muscle's rise and fall times to 1.
    pub lead_filter_time_s: f64,
    /// Fatigue that is made up for, if has_fatigue.
    pub fatigue: [VmFatigueParams; VM_ANTAGONISTS],
    /// Fitness that is made up for at most; 0.1 to 1.
    pub least_fitness: f64,
    /// Estimate of the muscles' gain, if has_gain.
    pub gain: VmGain,
    /// Least torque, N m; -1,000 to 0.
    pub least_torque_nm: f64,
    /// Greatest torque, N m; 0 to 1,000.
    pub most_torque_nm: f64,
    /// What is measured: VM_MEASURED_ANGLE (0) or VM_MEASURED_TORQUE.
    pub measured: u32,
    /// 1 if the muscle tires, 0 if not.
    pub has_fatigue: [u32; VM_ANTAGONISTS],
    /// 1 if the gain is estimated, 0 if not.
    pub has_gain: u32,
}

/// Applies to each of a pair; a refusal names the muscle.
fn each<A, B: Copy>(
    pair: &[A; VM_ANTAGONISTS],
    convert: impl Fn(&A) -> Result<B, ParameterError>,
) -> Result<[B; VM_ANTAGONISTS], Refusal> {
    let of = |muscle: usize| move |error: ParameterError| Refusal::from(error).of_muscle(muscle);
    let [flexor, extensor] = pair;
    Ok([convert(flexor).map_err(of(0))?, convert(extensor).map_err(of(1))?])
}

/// Muscles and paths of a flexor and an extensor.
pub(crate) fn antagonists<const N: usize>(
    muscles: &[VmMuscleParams; VM_ANTAGONISTS],
    paths: &[VmPath; VM_ANTAGONISTS],
) -> Result<([MuscleParams<N>; VM_ANTAGONISTS], [PathParams<1>; VM_ANTAGONISTS]), Refusal> {
    Ok((each(muscles, VmMuscleParams::model)?, each(paths, VmPath::model)?))
}

const MEASURED: [(u32, Measured); 2] =
    [(VM_MEASURED_ANGLE, Measured::Angle), (VM_MEASURED_TORQUE, Measured::Torque)];

impl VmFesParams {
    pub(crate) fn model<const N: usize>(&self) -> Result<FesControllerParams<N>, Refusal> {
        let (muscles, paths) = antagonists(&self.muscles, &self.paths)?;
        let modulation = each(&self.modulation, |modulation| {
            let width = Modulation::Width { amplitude: modulation.amplitude_a };
            let amplitude = Modulation::Amplitude { width: modulation.width_s };
            let modulations = [(VM_MODULATE_WIDTH, width), (VM_MODULATE_AMPLITUDE, amplitude)];
            choice("modulated", modulation.modulated, &modulations)
        })?;
        let tires = each(&self.has_fatigue, |&flag| choice("has_fatigue", flag, &FLAG))?;
        let mut fatigue = [None; VM_ANTAGONISTS];
        for ((place, params), tires) in fatigue.iter_mut().zip(&self.fatigue).zip(tires) {
            *place = tires.then(|| params.model());
        }
        let (limb, feedback, gain) = (&self.limb, &self.feedback, &self.gain);
        Ok(FesControllerParams {
            range: self.range.model(),
            muscles,
            paths,
            limb: LimbParams {
                inertia: limb.inertia_kg_m2,
                damping: limb.damping_nm_s_per_rad,
                gravity: limb.gravity_nm,
                hanging_angle: limb.hanging_angle_rad,
            },
            electrodes: self.electrodes.each_ref().map(VmCurveParams::model),
            modulation,
            stimulation_frequency: self.stimulation_frequency_pps,
            cocontraction: self.cocontraction_nm,
            measured: choice("measured", self.measured, &MEASURED)?,
            feedback: PiParams {
                proportional: feedback.proportional,
                integral: feedback.integral_per_s,
                derivative: feedback.derivative_s,
                derivative_filter: feedback.derivative_filter_s,
                most: feedback.most_integral_nm,
            },
            expected_lag: self.expected_lag_s,
            lead_filter_time: self.lead_filter_time_s,
            fatigue,
            least_fitness: self.least_fitness,
            gain: choice("has_gain", self.has_gain, &FLAG)?.then_some(GainParams {
                time: gain.time_s,
                least: gain.least_gain,
                most: gain.most_gain,
                excitation: gain.excitation_nm,
            }),
            torque: (self.least_torque_nm, self.most_torque_nm),
        })
    }
}
