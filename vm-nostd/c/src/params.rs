//! Parameters in C.

use crate::choice::{FLAG, choice};
use model::{
    ActivationParams, Class, CompressionParams, ElementParams, ExcitationParams, FiberParams,
    FiberType, ForceLengthParams, ForceVelocityParams, MuscleParams, ParallelParams,
    ParameterError, SagParams, TendonParams, YieldParams, paper_table_1,
};

/// Accuracy class: substeps of 0.25 ms or less; the default.
pub const VM_CLASS_STANDARD: u32 = 0;
/// Accuracy class: one substep a tick, unless the muscle rings too fast or too much for that.
pub const VM_CLASS_ECONOMY: u32 = 1;
/// Accuracy class: substeps of 0.063 ms or less, and ticks longer than 0.25 ms in equal parts.
pub const VM_CLASS_FINE: u32 = 2;

/// Version of header and library: major, minor and patch, two digits each.
pub const VM_VERSION: u32 = 100;
/// Greatest number of fibre types. A library without the feature `types` has two only.
pub const VM_MAX_FIBERS: usize = 6;

/// VM_VERSION of the library.
#[allow(unsafe_code)]
#[unsafe(no_mangle)]
pub extern "C" fn vm_version() -> u32 {
    VM_VERSION
}

/// A muscle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmMuscleParams {
    /// VM_VERSION: the version of this header.
    pub version: u32,
    /// How accurate it is computed: VM_CLASS_STANDARD (0), VM_CLASS_ECONOMY or VM_CLASS_FINE.
    pub accuracy_class: u32,
    /// Number of fibre types used; 1 to 6, or 2 only without the library's feature `types`.
    pub fiber_count: u32,
    /// Mass, kg; 1e-5 to 30.
    pub mass_kg: f64,
    /// Optimal fascicle length L_ce0, m; 0.005 to 1.
    pub fascicle_length_m: f64,
    /// Optimal tendon length L_se0, m; 0.0005 to 2.
    pub tendon_length_m: f64,
    /// Longest musculotendon path L_mt_max, m. It scales the parallel elastic element; paths may be
    /// longer.
    pub max_path_length_m: f64,
    /// Activation U_r at which all fibres are recruited in the natural mode; 0.01 to 1.
    pub recruitment_saturation: f64,
    /// Coefficients shared by the fibre types.
    pub elements: VmElements,
    /// Fibre types in order of rank; their fractions add to 1. Only the first `fiber_count` are
    /// read.
    pub fibers: [VmFiber; VM_MAX_FIBERS],
}

/// Coefficients shared by the fibre types.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmElements {
    /// c_T.
    pub tendon_stiffness: f64,
    /// k_T.
    pub tendon_toe: f64,
    /// L_r_T, L_se0.
    pub tendon_slack_length: f64,
    /// c_1.
    pub parallel_stiffness: f64,
    /// k_1.
    pub parallel_toe: f64,
    /// L_r1, L_max.
    pub parallel_slack_length: f64,
    /// eta, F0 s/L_ce0.
    pub parallel_viscosity: f64,
    /// c_2.
    pub compression_strength: f64,
    /// k_2.
    pub compression_steepness: f64,
    /// L_r2, L_ce0.
    pub compression_onset_length: f64,
    /// Force per cross-sectional area, N/m^2.
    pub specific_tension: f64,
    /// Density of muscle, kg/m^3.
    pub density: f64,
}

/// A fibre type and its share of a muscle.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmFiber {
    /// Share of the cross-sectional area; 0.001 to 1.
    pub fraction: f64,
    /// Order of recruitment: super-slow 1, slow 2, fast 3; 1 to 255.
    pub rank: u8,
    /// 1 if the type has sag, 0 if not.
    pub has_sag: u8,
    /// 1 if the type has yield, 0 if not.
    pub has_yield: u8,
    /// f_0.5, pps.
    pub half_force_frequency: f64,
    /// f_min, f_0.5.
    pub minimum_frequency: f64,
    /// f_max, f_0.5.
    pub maximum_frequency: f64,
    /// omega of FL.
    pub force_length_width: f64,
    /// beta of FL.
    pub force_length_skewness: f64,
    /// rho of FL.
    pub force_length_roundness: f64,
    /// V_max, L_ce0/s, negative.
    pub maximum_velocity: f64,
    /// c_V0, c_V1 of FV.
    pub shortening: [f64; 2],
    /// a_V0, a_V1, a_V2 of FV.
    pub lengthening: [f64; 3],
    /// b_V of FV.
    pub lengthening_velocity: f64,
    /// a_f of Af.
    pub activation_scale: f64,
    /// n_f0 of Af.
    pub activation_exponent: f64,
    /// n_f1 of Af.
    pub activation_length_dependence: f64,
    /// T_f1, s.
    pub rise_s: f64,
    /// T_f2, s.
    pub rise_per_frequency_s: f64,
    /// T_f3, s.
    pub fall_s: f64,
    /// T_f4, s.
    pub fall_per_activation_s: f64,
    /// T_L, s; used in VM_MODE_EFFECTIVE_LENGTH only, and checked in all.
    pub effective_length_time_s: f64,
    /// a_S1, if it sags.
    pub sag_resting_level: f64,
    /// a_S2, if it sags.
    pub sag_firing_level: f64,
    /// T_S, s, if it sags.
    pub sag_time_s: f64,
    /// c_Y, if it yields.
    pub yield_depth: f64,
    /// V_Y, L_ce0/s, if it yields.
    pub yield_velocity: f64,
    /// T_Y, s, if it yields.
    pub yield_time_s: f64,
}

/// The class of a number.
pub(crate) fn class_of(number: u32) -> Result<Class, ParameterError> {
    let classes = [
        (VM_CLASS_STANDARD, Class::Standard),
        (VM_CLASS_ECONOMY, Class::Economy),
        (VM_CLASS_FINE, Class::Fine),
    ];
    choice("accuracy_class", number, &classes)
}

impl VmMuscleParams {
    /// Converts to the model's type; an unknown class and flags other than 0 and 1 are refused.
    pub(crate) fn model<const N: usize>(&self) -> Result<MuscleParams<N>, ParameterError> {
        let e = &self.elements;
        let mut fibers = [FiberParams { fraction: 1.0, fiber_type: paper_table_1::SLOW }; N];
        for (index, (place, fiber)) in fibers.iter_mut().zip(&self.fibers).enumerate() {
            *place = fiber.model(index)?;
        }
        let class = class_of(self.accuracy_class)?;
        Ok(MuscleParams {
            mass: self.mass_kg,
            fascicle_length: self.fascicle_length_m,
            tendon_length: self.tendon_length_m,
            max_path_length: self.max_path_length_m,
            recruitment_saturation: self.recruitment_saturation,
            class,
            elements: ElementParams {
                tendon: TendonParams {
                    stiffness: e.tendon_stiffness,
                    toe: e.tendon_toe,
                    slack_length: e.tendon_slack_length,
                },
                parallel: ParallelParams {
                    stiffness: e.parallel_stiffness,
                    toe: e.parallel_toe,
                    slack_length: e.parallel_slack_length,
                    viscosity: e.parallel_viscosity,
                },
                compression: CompressionParams {
                    strength: e.compression_strength,
                    steepness: e.compression_steepness,
                    onset_length: e.compression_onset_length,
                },
                specific_tension: e.specific_tension,
                density: e.density,
            },
            fibers,
        })
    }
}

impl From<&ElementParams> for VmElements {
    fn from(e: &ElementParams) -> Self {
        Self {
            tendon_stiffness: e.tendon.stiffness,
            tendon_toe: e.tendon.toe,
            tendon_slack_length: e.tendon.slack_length,
            parallel_stiffness: e.parallel.stiffness,
            parallel_toe: e.parallel.toe,
            parallel_slack_length: e.parallel.slack_length,
            parallel_viscosity: e.parallel.viscosity,
            compression_strength: e.compression.strength,
            compression_steepness: e.compression.steepness,
            compression_onset_length: e.compression.onset_length,
            specific_tension: e.specific_tension,
            density: e.density,
        }
    }
}

impl VmFiber {
    fn model(&self, index: usize) -> Result<FiberParams, ParameterError> {
        let flag = |field, value: u8| {
            choice(field, value.into(), &FLAG)
                .map_err(|error| ParameterError { fiber: Some(index), ..error })
        };
        let sags = flag("has_sag", self.has_sag)?;
        let yields = flag("has_yield", self.has_yield)?;
        Ok(FiberParams {
            fraction: self.fraction,
            fiber_type: FiberType {
                rank: self.rank,
                half_force_frequency: self.half_force_frequency,
                minimum_frequency: self.minimum_frequency,
                maximum_frequency: self.maximum_frequency,
                force_length: ForceLengthParams {
                    width: self.force_length_width,
                    skewness: self.force_length_skewness,
                    roundness: self.force_length_roundness,
                },
                force_velocity: ForceVelocityParams {
                    maximum_velocity: self.maximum_velocity,
                    shortening: self.shortening,
                    lengthening: self.lengthening,
                    lengthening_velocity: self.lengthening_velocity,
                },
                activation: ActivationParams {
                    scale: self.activation_scale,
                    exponent: self.activation_exponent,
                    length_dependence: self.activation_length_dependence,
                },
                excitation: ExcitationParams {
                    rise: self.rise_s,
                    rise_per_frequency: self.rise_per_frequency_s,
                    fall: self.fall_s,
                    fall_per_activation: self.fall_per_activation_s,
                },
                effective_length_time: self.effective_length_time_s,
                sag: sags.then_some(SagParams {
                    resting_level: self.sag_resting_level,
                    firing_level: self.sag_firing_level,
                    time_constant: self.sag_time_s,
                }),
                yielding: yields.then_some(YieldParams {
                    depth: self.yield_depth,
                    velocity: self.yield_velocity,
                    time_constant: self.yield_time_s,
                }),
            },
        })
    }

    /// A type with a fraction of one half.
    pub(crate) fn of(t: &FiberType) -> Self {
        let nothing = (0.0, 0.0, 0.0);
        let sag =
            t.sag.as_ref().map_or(nothing, |s| (s.resting_level, s.firing_level, s.time_constant));
        let yielding =
            t.yielding.as_ref().map_or(nothing, |y| (y.depth, y.velocity, y.time_constant));
        Self {
            fraction: 0.5,
            rank: t.rank,
            has_sag: t.sag.is_some().into(),
            has_yield: t.yielding.is_some().into(),
            half_force_frequency: t.half_force_frequency,
            minimum_frequency: t.minimum_frequency,
            maximum_frequency: t.maximum_frequency,
            force_length_width: t.force_length.width,
            force_length_skewness: t.force_length.skewness,
            force_length_roundness: t.force_length.roundness,
            maximum_velocity: t.force_velocity.maximum_velocity,
            shortening: t.force_velocity.shortening,
            lengthening: t.force_velocity.lengthening,
            lengthening_velocity: t.force_velocity.lengthening_velocity,
            activation_scale: t.activation.scale,
            activation_exponent: t.activation.exponent,
            activation_length_dependence: t.activation.length_dependence,
            rise_s: t.excitation.rise,
            rise_per_frequency_s: t.excitation.rise_per_frequency,
            fall_s: t.excitation.fall,
            fall_per_activation_s: t.excitation.fall_per_activation,
            effective_length_time_s: t.effective_length_time,
            sag_resting_level: sag.0,
            sag_firing_level: sag.1,
            sag_time_s: sag.2,
            yield_depth: yielding.0,
            yield_velocity: yielding.1,
            yield_time_s: yielding.2,
        }
    }
}
