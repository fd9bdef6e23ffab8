//! A controller of the knee that tests of the FES controller share.

use std::f64::consts::FRAC_PI_2;
use vm_nostd::control::{
    FesControllerParams, GainParams, KNEE, LimbParams, Measured, Modulation, PiParams, Sensors,
    Target,
};
use vm_nostd::{FatigueParams, RecruitmentCurveParams, Scalar};

/// Without feedback.
pub const NONE: PiParams = PiParams {
    proportional: 0.0,
    integral: 0.0,
    derivative: 0.0,
    derivative_filter: 0.02,
    most: 40.0,
};

/// An electrode of the knee.
pub fn electrode() -> RecruitmentCurveParams {
    RecruitmentCurveParams { threshold: 4e-3, saturation: 12e-3, chronaxie: 2e-4, slope: 2.0 }
}

/// A controller of the knee without feedback.
pub fn params() -> FesControllerParams<2> {
    FesControllerParams {
        range: KNEE.range,
        muscles: KNEE.muscles.map(|muscle| muscle.params()),
        paths: KNEE.muscles.map(|muscle| muscle.path()),
        limb: LimbParams { inertia: 0.35, damping: 0.5, gravity: 12.0, hanging_angle: FRAC_PI_2 },
        electrodes: [electrode(); 2],
        modulation: [Modulation::Width { amplitude: 0.04 }, Modulation::Amplitude { width: 3e-4 }],
        stimulation_frequency: 30.0,
        cocontraction: 1.0,
        measured: Measured::Angle,
        feedback: PiParams { proportional: 0.0, integral: 0.0, most: 40.0, ..NONE },
        expected_lag: 0.06,
        lead_filter_time: 0.03,
        fatigue: [Some(FatigueParams::QUADRICEPS); 2],
        least_fitness: 0.3,
        gain: Some(GainParams { time: 5.0, least: 0.3, most: 2.0, excitation: 1.0 }),
        torque: (-80.0, 60.0),
    }
}

/// A target that stands still, rad.
pub fn still<S: Scalar>(angle: f64) -> Target<S> {
    Target {
        angle: S::from_f64(angle),
        velocity: S::ZERO,
        acceleration: S::ZERO,
        torque: S::quantity(0.0),
    }
}

/// A measured angle, rad.
pub fn sensed<S: Scalar>(angle: f64) -> Sensors<S> {
    Sensors { angle: S::from_f64(angle), torque: S::quantity(0.0) }
}
