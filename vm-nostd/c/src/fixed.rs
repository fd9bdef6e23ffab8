//! Muscles computed in fixed point.

use crate::template::*;
use model::Fixed;

/// Inputs of a tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct VmInputA {
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
pub struct VmOutputA {
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

impl InputOf<Fixed> for VmInputA {
    fn input(self) -> Input<Fixed> {
        Input::<Fixed>::from_integers(
            self.activation_per_mille,
            self.path_length_um,
            self.stimulation_tenths_pps,
        )
    }
}

impl OutputOf<Fixed> for VmOutputA {
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

impl VmOutputA {
    /// Leaves the force of a fitness, as the model does.
    fn tire(&mut self, fitness: Fixed) {
        self.force_mn = model::Scalar::of_share(fitness, self.force_mn);
        let relative = Fixed::number_from(self.relative_force);
        self.relative_force = (fitness * relative).number();
    }
}

arithmetic! {
    S = Fixed,
    prefix = "vm_fixed_",
    Path = i32,
    Number = i32,
    Amount = i32,
    Newtons = i32,
    Word = u32,
    MUSCLE_BASE = 256,
    MUSCLE_PER_TYPE = 208,
    UNITS_BASE = 5928,
    UNITS_PER_TYPE = 160,
    STEADY_BASE = 216,
    STEADY_PER_TYPE = 72,
    FATIGUE_SIZE = 72,
    CURVE_SIZE = 88,
    JOINT_BASE = 56,
    JOINT_PER_MUSCLE = 128,
    JOINT_PER_MUSCLE_OF_TWO = 216,
    PROSTHESIS_OWN = 1288,
    FES_OWN = 912,
    STATE_WORDS = 32,
    PROSTHESIS_WORDS = 278,
    FES_WORDS = 29,
}
