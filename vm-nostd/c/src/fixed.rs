//! Muscles computed in fixed point.

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
use model::{Fixed, Input, Output};

/// Bytes of memory of a muscle without fibre types, and of each type.
pub const VM_MUSCLE_FIXED_BASE: usize = 304;
/// Each type.
pub const VM_MUSCLE_FIXED_PER_TYPE: usize = 208;
/// Bytes of memory of a muscle in a discrete mode without fibre types, and of each type.
pub const VM_UNITS_FIXED_BASE: usize = 5928;
/// Each type.
pub const VM_UNITS_FIXED_PER_TYPE: usize = 160;
/// Bytes of memory of an inverse without fibre types, and of each type.
pub const VM_STEADY_FIXED_BASE: usize = 216;
/// Each type.
pub const VM_STEADY_FIXED_PER_TYPE: usize = 72;
/// Bytes of a VmMuscleFixed: two types.
pub const VM_MUSCLE_FIXED_SIZE: usize = 720;
/// Bytes of a VmSteadyFixed: two types.
pub const VM_STEADY_FIXED_SIZE: usize = 360;
/// Bytes of a VmFatigueFixed.
pub const VM_FATIGUE_FIXED_SIZE: usize = 72;
/// Bytes of a VmCurveFixed.
pub const VM_CURVE_FIXED_SIZE: usize = 88;
/// Words of the saved state of a muscle of two types in VM_MODE_CONTINUOUS or VM_MODE_FES.
pub const VM_FIXED_STATE_WORDS: usize = 31;

/// Mark of a muscle, and of an inverse.
const MARK: u32 = 0x564D_5158;
const STEADY_MARK: u32 = 0x564D_5358;

/// Memory in C.
#[repr(C, align(8))]
pub struct VmMuscleFixed([u64; VM_MUSCLE_FIXED_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmSteadyFixed([u64; VM_STEADY_FIXED_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmFatigueFixed([u64; VM_FATIGUE_FIXED_SIZE / 8]);
/// Memory in C.
#[repr(C, align(8))]
pub struct VmCurveFixed([u64; VM_CURVE_FIXED_SIZE / 8]);

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputFixed {
    /// Path length at the tick's end, um.
    pub path_length_um: i32,
    /// Activation U, or strength of the stimulus (FES), thousandths; 0..1000.
    pub activation_per_mille: u16,
    /// Stimulation frequency, tenths of a pps; 0..5000 (FES only).
    pub stimulation_tenths_pps: u16,
}

/// Outputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmOutputFixed {
    /// Tendon force, mN; never negative.
    pub force_mn: i32,
    /// Fascicle length, 2^-24 L_ce0.
    pub fascicle_length: i32,
    /// Fascicle velocity, 2^-24 L_ce0/s, positive when lengthening.
    pub fascicle_velocity: i32,
    /// Tendon force relative to F0, 2^-24 F0: finer than mN if F0 is below 16,777 N.
    pub relative_force: i32,
    /// VM_STATUS_ flags; 0 if nothing was clipped or limited.
    pub status: u16,
}

impl InputOf<Fixed> for VmInputFixed {
    fn input(self) -> Input<Fixed> {
        Input::<Fixed>::from_integers(
            self.activation_per_mille,
            self.path_length_um,
            self.stimulation_tenths_pps,
        )
    }
}

impl OutputOf<Fixed> for VmOutputFixed {
    fn of(output: Output<Fixed>) -> Self {
        Self {
            force_mn: output.force,
            fascicle_length: output.fascicle_length.number(),
            fascicle_velocity: output.fascicle_velocity.number(),
            relative_force: output.relative_force.number(),
            status: output.status.bits(),
        }
    }
}

impl VmOutputFixed {
    /// Leaves the force of a fitness, as the model does.
    fn tire(&mut self, fitness: Fixed) {
        self.force_mn = model::Scalar::of_share(fitness, self.force_mn);
        let relative = Fixed::number_from(self.relative_force);
        self.relative_force = (fitness * relative).number();
    }
}

functions! {
    STATE_WORDS = VM_FIXED_STATE_WORDS,
    MUSCLE_BASE = VM_MUSCLE_FIXED_BASE,
    MUSCLE_PER_TYPE = VM_MUSCLE_FIXED_PER_TYPE,
    UNITS_BASE = VM_UNITS_FIXED_BASE,
    UNITS_PER_TYPE = VM_UNITS_FIXED_PER_TYPE,
    STEADY_BASE = VM_STEADY_FIXED_BASE,
    STEADY_PER_TYPE = VM_STEADY_FIXED_PER_TYPE,
    S = Fixed,
    Muscle = VmMuscleFixed,
    Input = VmInputFixed,
    Output = VmOutputFixed,
    Info = VmInfoFixed,
    Steady = VmSteadyFixed,
    Fatigue = VmFatigueFixed,
    Curve = VmCurveFixed,
    FiberCurves = VmFiberCurvesFixed,
    ElementCurves = VmElementCurvesFixed,
    Path = i32,
    Number = i32,
    Newtons = i32,
    Word = u32,
    size = vm_fixed_size,
    build = vm_fixed_build,
    build_units = vm_fixed_build_units,
    rest = vm_fixed_rest,
    step = vm_fixed_step,
    observe = vm_fixed_observe,
    info = vm_fixed_info,
    save = vm_fixed_save,
    restore = vm_fixed_restore,
    checksums = vm_fixed_checksums,
    fiber_curves = vm_fixed_fiber_curves,
    element_curves = vm_fixed_element_curves,
}

extra_functions! {
    S = Fixed,
    Input = VmInputFixed,
    Output = VmOutputFixed,
    Steady = VmSteadyFixed,
    SteadyOutput = VmSteadyOutputFixed,
    Fatigue = VmFatigueFixed,
    Curve = VmCurveFixed,
    Number = i32,
    Amount = i32,
    Newtons = i32,
    Word = u32,
    fatigued = vm_fixed_fatigued,
    fatigue_build = vm_fixed_fatigue_build,
    fatigue_advance = vm_fixed_fatigue_advance,
    fatigue_save = vm_fixed_fatigue_save,
    fatigue_restore = vm_fixed_fatigue_restore,
    curve_build = vm_fixed_curve_build,
    curve_activation = vm_fixed_curve_activation,
    curve_amplitude = vm_fixed_curve_amplitude_for,
    curve_width = vm_fixed_curve_width_for,
    curve_checksum = vm_fixed_curve_checksum,
    steady_build = vm_fixed_steady_build,
    steady_force = vm_fixed_steady_force,
    steady_activation = vm_fixed_steady_activation_for,
}
