//! The exported functions of an arithmetic, from templates.
//!
//! A template is a macro whose names have an `A` where C's have the arithmetic: `vm_a_build` is
//! exported as `vm_f32_build`, and `VmMuscleA` is C's VmMuscleF32. The file of an arithmetic gives
//! what differs. cbindgen does not expand macros: for the header `tests/tests/c_api.rs` does what
//! `arithmetic!` does, with what it finds between the marks `<functions>` of each template.

/// All functions of an arithmetic: types in C, sizes in memory, in this order.
macro_rules! arithmetic {
    ($($key:ident = $value:tt,)*) => {
        $crate::functions::functions! { $($value,)* }
        $crate::extra_functions::extra_functions! { $($value,)* }
        $crate::control_functions::control_functions! { $($value,)* }
    };
}
pub(crate) use arithmetic;

// What the templates name.
pub(crate) use crate::arithmetic::{Arithmetic, InputOf, OutputOf};
pub(crate) use crate::control::controller;
pub(crate) use crate::control::fes::FesControllers;
pub(crate) use crate::control::fes_params::VmFesParams;
pub(crate) use crate::control::joint::{self, Given, Room};
pub(crate) use crate::control::joint_params::{VM_JOINT_ANGLES, VM_JOINT_MUSCLES, VmJointParams};
pub(crate) use crate::control::prosthesis::Prostheses;
pub(crate) use crate::control::prosthesis_params::{VM_DELAY_TICKS, VmProsthesisParams};
pub(crate) use crate::control::{VM_ANTAGONISTS, VmControlInfo};
pub(crate) use crate::extras::{self, Question, VmCurveParams, VmFatigueParams};
pub(crate) use crate::muscle::{self, Emitted, Order};
pub(crate) use crate::outcome::{plain, told};
pub(crate) use crate::params::VmMuscleParams;
pub(crate) use crate::pointer::{Place, read};
pub(crate) use crate::result::{VmError, VmResult};
pub(crate) use crate::units::VmUnits;
pub(crate) use model::control::{
    FesCommand, JointStatus, Placed, ProsthesisCommand, ProsthesisInput, Sensors, Target,
};
pub(crate) use model::{Input, Output};
