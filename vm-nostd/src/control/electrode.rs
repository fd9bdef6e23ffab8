//! An electrode: the pulse that recruits an activation.

use super::fes_params::Modulation;
use crate::beyond_paper::recruitment_curve::{
    Pulse, PulseStatus, RecruitmentCurve, RecruitmentCurveParams,
};
use crate::error::ParameterError;
use crate::scalar::Scalar;
use crate::summed::summed;

summed! {
    /// A recruitment curve, and the half of the pulse that is constant.
    #[derive(Clone, Copy, Debug)]
    pub(super) struct Electrode<S: Scalar> {
        curve: RecruitmentCurve<S>,
        by_width: bool,
        constant: S::Quantity,
    }
}

impl<S: Scalar> Electrode<S> {
    pub(super) fn build(
        curve: &RecruitmentCurveParams,
        modulation: Modulation,
    ) -> Result<Self, ParameterError> {
        let (by_width, constant) = match modulation {
            Modulation::Width { amplitude } => (true, amplitude * 1e3),
            Modulation::Amplitude { width } => (false, width * 1e6),
        };
        let curve = RecruitmentCurve::build(curve)?;
        Ok(Self { curve, by_width, constant: S::quantity(constant) })
    }

    /// The pulse that recruits an activation, and whether there is one.
    pub(super) fn pulse(&self, activation: S) -> (Pulse<S>, bool) {
        let constant = self.constant;
        let (pulse, status) = if self.by_width {
            let (width, status) = self.curve.width_for(activation, constant);
            (Pulse { amplitude: constant, width }, status)
        } else {
            let (amplitude, status) = self.curve.amplitude_for(activation, constant);
            (Pulse { amplitude, width: constant }, status)
        };
        (pulse, !status.contains(PulseStatus::UNREACHABLE))
    }
}
