//! Muscles computed in double.

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
pub const VM_MUSCLE_F64_BASE: usize = 488;
/// Each type.
pub const VM_MUSCLE_F64_PER_TYPE: usize = 352;
/// Bytes of memory of a muscle in a discrete mode without fibre types, and of each type.
pub const VM_UNITS_F64_BASE: usize = 8136;
/// Each type.
pub const VM_UNITS_F64_PER_TYPE: usize = 288;
/// Bytes of memory of an inverse without fibre types, and of each type.
pub const VM_STEADY_F64_BASE: usize = 312;
/// Each type.
pub const VM_STEADY_F64_PER_TYPE: usize = 128;
/// Bytes of a VmMuscleF64: two types.
pub const VM_MUSCLE_F64_SIZE: usize = 1192;
/// Bytes of a VmSteadyF64: two types.
pub const VM_STEADY_F64_SIZE: usize = 568;
/// Bytes of a VmFatigueF64.
pub const VM_FATIGUE_F64_SIZE: usize = 112;
/// Bytes of a VmCurveF64.
pub const VM_CURVE_F64_SIZE: usize = 120;
/// Words of the saved state of a muscle of two types in VM_MODE_CONTINUOUS or VM_MODE_FES.
pub const VM_F64_STATE_WORDS: usize = 22;

/// Mark of a muscle, and of an inverse.
const MARK: u32 = 0x564D_4636;
const STEADY_MARK: u32 = 0x564D_5336;

/// Memory in C.
#[repr(C, align(8))]
pub struct VmMuscleF64([u64; VM_MUSCLE_F64_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmSteadyF64([u64; VM_STEADY_F64_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmFatigueF64([u64; VM_FATIGUE_F64_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmCurveF64([u64; VM_CURVE_F64_SIZE / 8]);

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputF64 {
    /// Activation U, or strength of the stimulus (FES); 0..1.
    pub activation: f64,
    /// Path length at the tick's end, m.
    pub path_length_m: f64,
    /// Stimulation frequency, pps; 0..500 (FES only).
    pub stimulation_frequency_pps: f64,
}

/// Outputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmOutputF64 {
    /// Tendon force, N; never negative.
    pub force_n: f64,
    /// Fascicle length, L_ce0.
    pub fascicle_length: f64,
    /// Fascicle velocity, L_ce0/s, positive when lengthening.
    pub fascicle_velocity: f64,
    /// Tendon force relative to F0.
    pub relative_force: f64,
    /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
    pub status: u16,
}

impl InputOf<f64> for VmInputF64 {
    fn input(self) -> Input<f64> {
        Input {
            activation: self.activation,
            path_length: self.path_length_m,
            stimulation_frequency: self.stimulation_frequency_pps,
        }
    }
}

impl OutputOf<f64> for VmOutputF64 {
    fn of(output: Output<f64>) -> Self {
        Self {
            force_n: output.force,
            fascicle_length: output.fascicle_length.number(),
            fascicle_velocity: output.fascicle_velocity.number(),
            relative_force: output.relative_force.number(),
            status: output.status.bits(),
        }
    }
}

impl VmOutputF64 {
    /// Leaves the force of a fitness, as the model does.
    fn tire(&mut self, fitness: f64) {
        self.force_n = model::Scalar::of_share(fitness, self.force_n);
        let relative = f64::number_from(self.relative_force);
        self.relative_force = (fitness * relative).number();
    }
}

functions! {
    STATE_WORDS = VM_F64_STATE_WORDS,
    MUSCLE_BASE = VM_MUSCLE_F64_BASE,
    MUSCLE_PER_TYPE = VM_MUSCLE_F64_PER_TYPE,
    UNITS_BASE = VM_UNITS_F64_BASE,
    UNITS_PER_TYPE = VM_UNITS_F64_PER_TYPE,
    STEADY_BASE = VM_STEADY_F64_BASE,
    STEADY_PER_TYPE = VM_STEADY_F64_PER_TYPE,
    S = f64,
    Muscle = VmMuscleF64,
    Input = VmInputF64,
    Output = VmOutputF64,
    Info = VmInfoF64,
    Steady = VmSteadyF64,
    Fatigue = VmFatigueF64,
    Curve = VmCurveF64,
    FiberCurves = VmFiberCurvesF64,
    ElementCurves = VmElementCurvesF64,
    Path = f64,
    Number = f64,
    Newtons = f64,
    Word = u64,
    size = vm_f64_size,
    build = vm_f64_build,
    build_units = vm_f64_build_units,
    rest = vm_f64_rest,
    step = vm_f64_step,
    observe = vm_f64_observe,
    info = vm_f64_info,
    save = vm_f64_save,
    restore = vm_f64_restore,
    checksums = vm_f64_checksums,
    fiber_curves = vm_f64_fiber_curves,
    element_curves = vm_f64_element_curves,
}

extra_functions! {
    S = f64,
    Input = VmInputF64,
    Output = VmOutputF64,
    Steady = VmSteadyF64,
    SteadyOutput = VmSteadyOutputF64,
    Fatigue = VmFatigueF64,
    Curve = VmCurveF64,
    Number = f64,
    Amount = f64,
    Newtons = f64,
    Word = u64,
    fatigued = vm_f64_fatigued,
    fatigue_build = vm_f64_fatigue_build,
    fatigue_advance = vm_f64_fatigue_advance,
    fatigue_save = vm_f64_fatigue_save,
    fatigue_restore = vm_f64_fatigue_restore,
    curve_build = vm_f64_curve_build,
    curve_activation = vm_f64_curve_activation,
    curve_amplitude = vm_f64_curve_amplitude_for,
    curve_width = vm_f64_curve_width_for,
    curve_checksum = vm_f64_curve_checksum,
    steady_build = vm_f64_steady_build,
    steady_force = vm_f64_steady_force,
    steady_activation = vm_f64_steady_activation_for,
}
