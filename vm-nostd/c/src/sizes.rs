//! Sizes of the structs that C shares. The header asserts them, and so may only be used by a
//! compiler that lays them out alike; VM_VERSION tells headers apart.

macro_rules! sizes {
    ($($thing:ident = $bytes:literal,)*) => {
        $(const _: () = assert!(size_of::<$thing>() == $bytes, stringify!($thing));)*
    };
}

use crate::control::VmControlInfo;
use crate::control::fes_params::{VmFeedback, VmFesParams, VmGain, VmLimb, VmModulation};
use crate::control::joint_params::{VmAngleRange, VmJointMuscle, VmJointParams, VmPath};
use crate::control::prosthesis_params::{
    VmEnvelope, VmProsthesisParams, VmStiffnessLimits, VmTorqueLimits,
};
use crate::derived::VmDerived;
use crate::extras::{VmCurveParams, VmFatigueParams};
use crate::f32::{
    VmElementCurvesA as VmElementCurvesF32, VmFesCommandA as VmFesCommandF32,
    VmFiberCurvesA as VmFiberCurvesF32, VmInfoA as VmInfoF32, VmInputA as VmInputF32,
    VmOutputA as VmOutputF32, VmPlacedA as VmPlacedF32, VmPostureA as VmPostureF32,
    VmProsthesisCommandA as VmProsthesisCommandF32, VmProsthesisInputA as VmProsthesisInputF32,
    VmSensorsA as VmSensorsF32, VmSteadyOutputA as VmSteadyOutputF32, VmTargetA as VmTargetF32,
};
use crate::fixed::{
    VmElementCurvesA as VmElementCurvesFixed, VmFesCommandA as VmFesCommandFixed,
    VmFiberCurvesA as VmFiberCurvesFixed, VmInfoA as VmInfoFixed, VmInputA as VmInputFixed,
    VmOutputA as VmOutputFixed, VmPlacedA as VmPlacedFixed, VmPostureA as VmPostureFixed,
    VmProsthesisCommandA as VmProsthesisCommandFixed, VmProsthesisInputA as VmProsthesisInputFixed,
    VmSensorsA as VmSensorsFixed, VmSteadyOutputA as VmSteadyOutputFixed,
    VmTargetA as VmTargetFixed,
};
use crate::params::{VmElements, VmFiber, VmMuscleParams};
use crate::result::VmError;
use crate::units::{VmUnitSizes, VmUnits};

sizes! {
    VmElements = 96,
    VmFiber = 232,
    VmMuscleParams = 1544,
    VmError = 128,
    VmDerived = 64,
    VmUnitSizes = 24,
    VmUnits = 144,
    VmFatigueParams = 32,
    VmCurveParams = 32,
    VmAngleRange = 16,
    VmPath = 136,
    VmJointMuscle = 168,
    VmJointParams = 1056,
    VmEnvelope = 40,
    VmTorqueLimits = 24,
    VmStiffnessLimits = 24,
    VmProsthesisParams = 3504,
    VmLimb = 32,
    VmModulation = 24,
    VmFeedback = 40,
    VmGain = 32,
    VmFesParams = 3728,
    VmControlInfo = 8,
    VmInputF32 = 12,
    VmOutputF32 = 20,
    VmInfoF32 = 28,
    VmSteadyOutputF32 = 20,
    VmFiberCurvesF32 = 12,
    VmElementCurvesF32 = 12,
    VmPlacedF32 = 20,
    VmPostureF32 = 124,
    VmProsthesisInputF32 = 12,
    VmProsthesisCommandF32 = 24,
    VmTargetF32 = 16,
    VmSensorsF32 = 8,
    VmFesCommandF32 = 40,
    VmInputFixed = 8,
    VmOutputFixed = 20,
    VmInfoFixed = 28,
    VmSteadyOutputFixed = 20,
    VmFiberCurvesFixed = 12,
    VmElementCurvesFixed = 12,
    VmPlacedFixed = 20,
    VmPostureFixed = 124,
    VmProsthesisInputFixed = 12,
    VmProsthesisCommandFixed = 24,
    VmTargetFixed = 16,
    VmSensorsFixed = 8,
    VmFesCommandFixed = 40,
}

#[cfg(feature = "f64")]
use crate::f64::{
    VmElementCurvesA as VmElementCurvesF64, VmFesCommandA as VmFesCommandF64,
    VmFiberCurvesA as VmFiberCurvesF64, VmInfoA as VmInfoF64, VmInputA as VmInputF64,
    VmOutputA as VmOutputF64, VmPlacedA as VmPlacedF64, VmPostureA as VmPostureF64,
    VmProsthesisCommandA as VmProsthesisCommandF64, VmProsthesisInputA as VmProsthesisInputF64,
    VmSensorsA as VmSensorsF64, VmSteadyOutputA as VmSteadyOutputF64, VmTargetA as VmTargetF64,
};

#[cfg(feature = "f64")]
sizes! {
    VmInputF64 = 24,
    VmOutputF64 = 40,
    VmInfoF64 = 40,
    VmSteadyOutputF64 = 40,
    VmFiberCurvesF64 = 24,
    VmElementCurvesF64 = 24,
    VmPlacedF64 = 40,
    VmPostureF64 = 248,
    VmProsthesisInputF64 = 24,
    VmProsthesisCommandF64 = 40,
    VmTargetF64 = 32,
    VmSensorsF64 = 16,
    VmFesCommandF64 = 72,
}
