//! Sizes of the structs that C shares. The header asserts them, and so may only be used by a
//! compiler that lays them out alike; VM_VERSION tells headers apart.

macro_rules! sizes {
    ($($thing:ident = $bytes:literal,)*) => {
        $(const _: () = assert!(size_of::<$thing>() == $bytes, stringify!($thing));)*
    };
}

use crate::derived::VmDerived;
use crate::extras::{VmCurveParams, VmFatigueParams};
use crate::f32::{
    VmElementCurvesF32, VmFiberCurvesF32, VmInfoF32, VmInputF32, VmOutputF32, VmSteadyOutputF32,
};
use crate::fixed::{
    VmElementCurvesFixed, VmFiberCurvesFixed, VmInfoFixed, VmInputFixed, VmOutputFixed,
    VmSteadyOutputFixed,
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
    VmInputF32 = 12,
    VmOutputF32 = 20,
    VmInfoF32 = 28,
    VmSteadyOutputF32 = 20,
    VmFiberCurvesF32 = 12,
    VmElementCurvesF32 = 12,
    VmInputFixed = 8,
    VmOutputFixed = 20,
    VmInfoFixed = 28,
    VmSteadyOutputFixed = 20,
    VmFiberCurvesFixed = 12,
    VmElementCurvesFixed = 12,
}

#[cfg(feature = "f64")]
use crate::f64::{
    VmElementCurvesF64, VmFiberCurvesF64, VmInfoF64, VmInputF64, VmOutputF64, VmSteadyOutputF64,
};

#[cfg(feature = "f64")]
sizes! {
    VmInputF64 = 24,
    VmOutputF64 = 40,
    VmInfoF64 = 40,
    VmSteadyOutputF64 = 40,
    VmFiberCurvesF64 = 24,
    VmElementCurvesF64 = 24,
}
