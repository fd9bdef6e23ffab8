//! Published fibre types and shared elements.
//!
//! A test compares them with `host-sim/data/fibers.csv` and `elements.csv`.

use crate::equations::activation_frequency::ActivationParams;
use crate::equations::excitation::ExcitationParams;
use crate::equations::force_length::ForceLengthParams;
use crate::equations::force_velocity::ForceVelocityParams;
use crate::equations::passive::{CompressionParams, ParallelParams};
use crate::equations::sag::SagParams;
use crate::equations::tendon::TendonParams;
use crate::equations::yielding::YieldParams;
use crate::params::{ElementParams, FiberType};

/// The paper's muscle, for tests.
#[cfg(test)]
pub(crate) const PAPER_MUSCLE: super::MuscleParams<2> = super::MuscleParams {
    mass: 97.5e-3,
    fascicle_length: 0.11,
    tendon_length: 0.02,
    max_path_length: 0.184,
    recruitment_saturation: 0.8,
    class: super::class::Class::Standard,
    elements: paper_table_1::ELEMENTS,
    fibers: [
        super::FiberParams { fraction: 0.6, fiber_type: paper_table_1::SLOW },
        super::FiberParams { fraction: 0.4, fiber_type: paper_table_1::FAST },
    ],
};

/// Milliseconds in seconds.
const fn ms(milliseconds: f64) -> f64 {
    milliseconds * 1e-3
}

/// Table 1 of the paper: the default.
pub mod paper_table_1 {
    use super::*;

    /// Elements that all fibre types share.
    pub const ELEMENTS: ElementParams = ElementParams {
        tendon: TendonParams { stiffness: 27.8, toe: 0.0047, slack_length: 0.964 },
        parallel: ParallelParams {
            stiffness: 23.0,
            toe: 0.046,
            slack_length: 1.17,
            viscosity: 0.01,
        },
        compression: CompressionParams { strength: -0.02, steepness: -21.0, onset_length: 0.7 },
        specific_tension: 31.8 * 1e4,
        density: 1.06 * 1e3,
    };

    /// Slow fibres.
    pub const SLOW: FiberType = FiberType {
        rank: 2,
        half_force_frequency: 12.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 1.12, skewness: 2.3, roundness: 1.62 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -7.88,
            shortening: [5.88, 0.0],
            lengthening: [-4.7, 8.41, -5.34],
            lengthening_velocity: 0.35,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.1, length_dependence: 5.0 },
        excitation: ExcitationParams {
            rise: ms(34.3),
            rise_per_frequency: ms(22.7),
            fall: ms(47.0),
            fall_per_activation: ms(25.2),
        },
        effective_length_time: ms(0.088),
        sag: None,
        yielding: Some(YieldParams { depth: 0.35, velocity: 0.1, time_constant: ms(200.0) }),
    };

    /// Fast fibres.
    pub const FAST: FiberType = FiberType {
        rank: 3,
        half_force_frequency: 20.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 0.75, skewness: 1.55, roundness: 2.12 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -9.15,
            shortening: [-5.7, 9.18],
            lengthening: [-1.53, 0.0, 0.0],
            lengthening_velocity: 0.69,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.1, length_dependence: 3.3 },
        excitation: ExcitationParams {
            rise: ms(20.6),
            rise_per_frequency: ms(13.6),
            fall: ms(28.2),
            fall_per_activation: ms(15.1),
        },
        effective_length_time: ms(0.088),
        sag: Some(SagParams { resting_level: 1.76, firing_level: 0.96, time_constant: ms(43.0) }),
        yielding: None,
    };
}

/// Human muscle, as shipped with the authors' VM 4.0.1.
pub mod human_vm4 {
    use super::*;

    /// Elements that all fibre types share.
    pub const ELEMENTS: ElementParams = ElementParams {
        tendon: TendonParams { stiffness: 27.8, toe: 0.0047, slack_length: 0.964 },
        parallel: ParallelParams {
            stiffness: 23.0,
            toe: 0.046,
            slack_length: 1.17,
            viscosity: 0.01,
        },
        compression: CompressionParams {
            strength: -0.02,
            steepness: -21.0375,
            onset_length: 0.7022222222222221,
        },
        specific_tension: 31.8 * 1e4,
        density: 1.06 * 1e3,
    };

    /// Super-slow fibres.
    pub const SUPER_SLOW: FiberType = FiberType {
        rank: 1,
        half_force_frequency: 6.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 1.12435451050223, skewness: 2.3, roundness: 1.62 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -3.94,
            shortening: [5.88, 0.0],
            lengthening: [-4.7, 8.41, -5.31],
            lengthening_velocity: 0.17467980295566504,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 5.0 },
        excitation: ExcitationParams {
            rise: ms(68.56666666666666),
            rise_per_frequency: ms(45.33333333333333),
            fall: ms(94.06666666666666),
            fall_per_activation: ms(50.43333333333333),
        },
        effective_length_time: ms(0.088),
        sag: None,
        yielding: Some(YieldParams { depth: 0.35, velocity: 0.1, time_constant: ms(200.0) }),
    };

    /// Slow fibres.
    pub const SLOW: FiberType = FiberType {
        rank: 2,
        half_force_frequency: 12.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 1.12435451050223, skewness: 2.3, roundness: 1.62 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -7.88,
            shortening: [5.88, 0.0],
            lengthening: [-4.7, 8.41, -5.31],
            lengthening_velocity: 0.34935960591133003,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 5.0 },
        excitation: ExcitationParams {
            rise: ms(34.28333333333334),
            rise_per_frequency: ms(22.666666666666668),
            fall: ms(47.03333333333334),
            fall_per_activation: ms(25.21666666666667),
        },
        effective_length_time: ms(0.088),
        sag: None,
        yielding: Some(YieldParams { depth: 0.35, velocity: 0.1, time_constant: ms(200.0) }),
    };

    /// Fast fibres.
    pub const FAST: FiberType = FiberType {
        rank: 3,
        half_force_frequency: 20.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams {
            width: 0.7463277822392793,
            skewness: 1.55,
            roundness: 2.12,
        },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -9.1516,
            shortening: [-5.7, 9.18],
            lengthening: [-1.53, 0.0, 0.0],
            lengthening_velocity: 0.68637,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 3.31 },
        excitation: ExcitationParams {
            rise: ms(20.57),
            rise_per_frequency: ms(13.6),
            fall: ms(28.22),
            fall_per_activation: ms(15.13),
        },
        effective_length_time: ms(0.088),
        sag: Some(SagParams { resting_level: 1.76, firing_level: 0.96, time_constant: ms(43.0) }),
        yielding: None,
    };
}

/// Feline muscle, as shipped with the authors' VM 4.0.1.
pub mod feline_vm4 {
    use super::*;

    /// Elements that all fibre types share.
    pub const ELEMENTS: ElementParams = ElementParams {
        tendon: TendonParams { stiffness: 27.8, toe: 0.0047, slack_length: 0.964 },
        parallel: ParallelParams {
            stiffness: 23.0,
            toe: 0.046,
            slack_length: 1.17,
            viscosity: 0.01,
        },
        compression: CompressionParams { strength: -0.02, steepness: -18.7, onset_length: 0.79 },
        specific_tension: 31.8 * 1e4,
        density: 1.06 * 1e3,
    };

    /// Super-slow fibres.
    pub const SUPER_SLOW: FiberType = FiberType {
        rank: 1,
        half_force_frequency: 8.5,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 1.26, skewness: 2.3, roundness: 1.62 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -4.06,
            shortening: [5.88, 0.0],
            lengthening: [-4.7, 8.41, -5.31],
            lengthening_velocity: 0.18,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 5.0 },
        excitation: ExcitationParams {
            rise: ms(48.4),
            rise_per_frequency: ms(32.0),
            fall: ms(66.4),
            fall_per_activation: ms(35.6),
        },
        effective_length_time: ms(0.088),
        sag: None,
        yielding: Some(YieldParams { depth: 0.35, velocity: 0.1, time_constant: ms(200.0) }),
    };

    /// Slow fibres.
    pub const SLOW: FiberType = FiberType {
        rank: 2,
        half_force_frequency: 20.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 1.26, skewness: 2.3, roundness: 1.62 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -9.552941176470588,
            shortening: [5.88, 0.0],
            lengthening: [-4.7, 8.41, -5.31],
            lengthening_velocity: 0.4235294117647059,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 5.0 },
        excitation: ExcitationParams {
            rise: ms(20.57),
            rise_per_frequency: ms(13.6),
            fall: ms(28.22),
            fall_per_activation: ms(15.13),
        },
        effective_length_time: ms(0.088),
        sag: None,
        yielding: Some(YieldParams { depth: 0.35, velocity: 0.1, time_constant: ms(200.0) }),
    };

    /// Fast fibres.
    pub const FAST: FiberType = FiberType {
        rank: 3,
        half_force_frequency: 34.0,
        minimum_frequency: 0.5,
        maximum_frequency: 2.0,
        force_length: ForceLengthParams { width: 0.81, skewness: 1.55, roundness: 2.12 },
        force_velocity: ForceVelocityParams {
            maximum_velocity: -14.0,
            shortening: [-5.7, 9.18],
            lengthening: [-1.53, 0.0, 0.0],
            lengthening_velocity: 1.05,
        },
        activation: ActivationParams { scale: 0.56, exponent: 2.11, length_dependence: 3.31 },
        excitation: ExcitationParams {
            rise: ms(12.1),
            rise_per_frequency: ms(8.0),
            fall: ms(16.6),
            fall_per_activation: ms(8.9),
        },
        effective_length_time: ms(0.088),
        sag: Some(SagParams { resting_level: 1.76, firing_level: 0.96, time_constant: ms(43.0) }),
        yielding: None,
    };
}
