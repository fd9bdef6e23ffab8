//! Parameters of the FES controller.

use super::gain_estimate::GainParams;
use super::limb::LimbParams;
use super::path_params::{AngleRange, PathParams};
use super::pi::PiParams;
use crate::beyond_paper::fatigue::FatigueParams;
use crate::beyond_paper::recruitment_curve::{GREATEST_STRENGTH, RecruitmentCurveParams};
use crate::error::{ParameterError, within};
use crate::params::MuscleParams;

/// What the feedback compares with the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// The joint's angle.
    Angle,
    /// The muscles' torque.
    Torque,
}

/// Which half of the pulse carries the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Modulation {
    /// The width, at an amplitude (A; 1e-4 to 0.2, and to 100 times the electrode's saturation).
    Width {
        /// A.
        amplitude: f64,
    },
    /// The amplitude, at a width (s; 2e-5 to 1e-3).
    Amplitude {
        /// s.
        width: f64,
    },
}

impl Modulation {
    /// The constant half must be one that the recruitment curve takes: it would compute the other
    /// half for what it clips to.
    pub(super) fn validate(&self, curve: &RecruitmentCurveParams) -> Result<(), ParameterError> {
        match *self {
            Self::Width { amplitude } => {
                let most = (GREATEST_STRENGTH * curve.saturation).min(0.2);
                within("modulation.amplitude", amplitude, 1e-4, most)
            }
            Self::Amplitude { width } => within("modulation.width", width, 2e-5, 1e-3),
        }
    }
}

/// Parameters of a controller; pairs are flexor and extensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FesControllerParams<const N: usize> {
    /// Range of the joint; targets are clipped to it.
    pub range: AngleRange,
    /// Muscles.
    pub muscles: [MuscleParams<N>; 2],
    /// Their paths.
    pub paths: [PathParams<1>; 2],
    /// The limb that moves.
    pub limb: LimbParams,
    /// Electrodes' recruitment curves.
    pub electrodes: [RecruitmentCurveParams; 2],
    /// How they are driven.
    pub modulation: [Modulation; 2],
    /// Stimulation frequency, pps; 1 to 100. More is smoother and tires faster.
    pub stimulation_frequency: f64,
    /// Torque that each muscle makes against the other, N m; 0 to 100. More is stiffer, tires
    /// faster and hides the dead zone between the muscles.
    pub cocontraction: f64,
    /// What is measured.
    pub measured: Measured,
    /// Feedback.
    pub feedback: PiParams,
    /// Lag of the joint behind the target that the feedback expects, s; 0.001 to 1: about twice the
    /// lead's filter time and the sensor's delay. Too short makes the feedback fight the
    /// feed-forward, too long makes it slow.
    pub expected_lag: f64,
    /// Filter time of the lead, s; see [`LeadParams`](super::LeadParams).
    pub lead_filter_time: f64,
    /// Fatigue that is made up for, if any.
    pub fatigue: [Option<FatigueParams>; 2],
    /// Fitness that is made up for at most; 0.1 to 1. Less stimulates tired muscles more.
    pub least_fitness: f64,
    /// Estimate of the muscles' gain, if any.
    pub gain: Option<GainParams>,
    /// Least and greatest torque, N m; -1,000 to 0 and 0 to 1,000.
    pub torque: (f64, f64),
}

impl<const N: usize> FesControllerParams<N> {
    /// Validates what is not the muscles' own.
    pub(super) fn validate_own(&self) -> Result<(), ParameterError> {
        within("stimulation_frequency", self.stimulation_frequency, 1.0, 100.0)?;
        within("cocontraction", self.cocontraction, 0.0, 100.0)?;
        within("expected_lag", self.expected_lag, 1e-3, 1.0)?;
        within("least_fitness", self.least_fitness, 0.1, 1.0)?;
        within("torque.0", self.torque.0, -1e3, 0.0)?;
        within("torque.1", self.torque.1, 0.0, 1e3)
    }
}
