//! Muscles computed in float.

use crate::arithmetic::{Arithmetic, InputOf, OutputOf};
use crate::extra_functions::extra_functions;
use crate::extras::{self, Question, VmCurveParams, VmFatigueParams};
use crate::functions::functions;
use crate::muscle::{self, Order};
use crate::outcome::{plain, told};
use crate::params::VmMuscleParams;
use crate::pointer::{Place, read};
use crate::result::{VmError, VmResult};
use crate::units::VmUnits;
use model::{Input, Output};

/// Bytes of memory of a muscle without fibre types, and of each type.
pub const VM_MUSCLE_F32_BASE: usize = 248;
/// Each type.
pub const VM_MUSCLE_F32_PER_TYPE: usize = 176;
/// Bytes of memory of a muscle in a discrete mode without fibre types, and of each type.
pub const VM_UNITS_F32_BASE: usize = 4336;
/// Each type.
pub const VM_UNITS_F32_PER_TYPE: usize = 144;
/// Bytes of memory of an inverse without fibre types, and of each type.
pub const VM_STEADY_F32_BASE: usize = 160;
/// Each type.
pub const VM_STEADY_F32_PER_TYPE: usize = 64;
/// Bytes of a VmMuscleF32: two types.
pub const VM_MUSCLE_F32_SIZE: usize = 600;
/// Bytes of a VmSteadyF32: two types.
pub const VM_STEADY_F32_SIZE: usize = 288;
/// Bytes of a VmFatigueF32.
pub const VM_FATIGUE_F32_SIZE: usize = 64;
/// Bytes of a VmCurveF32.
pub const VM_CURVE_F32_SIZE: usize = 64;
/// Words of the saved state of a muscle of two types in VM_MODE_CONTINUOUS or VM_MODE_FES.
pub const VM_F32_STATE_WORDS: usize = 22;

/// Mark of a muscle, and of an inverse.
const MARK: u32 = 0x564D_4633;
const STEADY_MARK: u32 = 0x564D_5333;

/// Memory in C.
#[repr(C, align(8))]
pub struct VmMuscleF32([u64; VM_MUSCLE_F32_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmSteadyF32([u64; VM_STEADY_F32_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmFatigueF32([u64; VM_FATIGUE_F32_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmCurveF32([u64; VM_CURVE_F32_SIZE / 8]);

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputF32 {
    /// Activation U, or strength of the stimulus (FES); 0..1.
    pub activation: f32,
    /// Path length at the tick's end, m.
    pub path_length_m: f32,
    /// Stimulation frequency, pps; 0..500 (FES only).
    pub stimulation_frequency_pps: f32,
}

/// Outputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmOutputF32 {
    /// Tendon force, N; never negative.
    pub force_n: f32,
    /// Fascicle length, L_ce0.
    pub fascicle_length: f32,
    /// Fascicle velocity, L_ce0/s, positive when lengthening.
    pub fascicle_velocity: f32,
    /// Tendon force relative to F0.
    pub relative_force: f32,
    /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
    pub status: u16,
}

impl InputOf<f32> for VmInputF32 {
    fn input(self) -> Input<f32> {
        Input {
            activation: self.activation,
            path_length: self.path_length_m,
            stimulation_frequency: self.stimulation_frequency_pps,
        }
    }
}

impl OutputOf<f32> for VmOutputF32 {
    fn of(output: Output<f32>) -> Self {
        Self {
            force_n: output.force,
            fascicle_length: output.fascicle_length.number(),
            fascicle_velocity: output.fascicle_velocity.number(),
            relative_force: output.relative_force.number(),
            status: output.status.bits(),
        }
    }
}

impl VmOutputF32 {
    /// Leaves the force of a fitness, as the model does.
    fn tire(&mut self, fitness: f32) {
        self.force_n = model::Scalar::of_share(fitness, self.force_n);
        let relative = f32::number_from(self.relative_force);
        self.relative_force = (fitness * relative).number();
    }
}

functions! {
    STATE_WORDS = VM_F32_STATE_WORDS,
    MUSCLE_BASE = VM_MUSCLE_F32_BASE,
    MUSCLE_PER_TYPE = VM_MUSCLE_F32_PER_TYPE,
    UNITS_BASE = VM_UNITS_F32_BASE,
    UNITS_PER_TYPE = VM_UNITS_F32_PER_TYPE,
    STEADY_BASE = VM_STEADY_F32_BASE,
    STEADY_PER_TYPE = VM_STEADY_F32_PER_TYPE,
    S = f32,
    Muscle = VmMuscleF32,
    Input = VmInputF32,
    Output = VmOutputF32,
    Info = VmInfoF32,
    Steady = VmSteadyF32,
    Fatigue = VmFatigueF32,
    Curve = VmCurveF32,
    FiberCurves = VmFiberCurvesF32,
    ElementCurves = VmElementCurvesF32,
    Path = f32,
    Number = f32,
    Newtons = f32,
    Word = u32,
    size = vm_f32_size,
    build = vm_f32_build,
    build_units = vm_f32_build_units,
    rest = vm_f32_rest,
    step = vm_f32_step,
    observe = vm_f32_observe,
    info = vm_f32_info,
    save = vm_f32_save,
    restore = vm_f32_restore,
    checksums = vm_f32_checksums,
    fiber_curves = vm_f32_fiber_curves,
    element_curves = vm_f32_element_curves,
}

extra_functions! {
    S = f32,
    Input = VmInputF32,
    Output = VmOutputF32,
    Steady = VmSteadyF32,
    SteadyOutput = VmSteadyOutputF32,
    Fatigue = VmFatigueF32,
    Curve = VmCurveF32,
    Number = f32,
    Amount = f32,
    Newtons = f32,
    Word = u32,
    fatigued = vm_f32_fatigued,
    fatigue_build = vm_f32_fatigue_build,
    fatigue_advance = vm_f32_fatigue_advance,
    fatigue_save = vm_f32_fatigue_save,
    fatigue_restore = vm_f32_fatigue_restore,
    curve_build = vm_f32_curve_build,
    curve_activation = vm_f32_curve_activation,
    curve_amplitude = vm_f32_curve_amplitude_for,
    curve_width = vm_f32_curve_width_for,
    curve_checksum = vm_f32_curve_checksum,
    steady_build = vm_f32_steady_build,
    steady_force = vm_f32_steady_force,
    steady_activation = vm_f32_steady_activation_for,
}
