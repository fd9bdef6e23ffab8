//! Muscles computed in float.

use crate::floating::floating;
use crate::template::*;

floating! { f32 }

arithmetic! {
    S = f32,
    prefix = "vm_f32_",
    Path = f32,
    Number = f32,
    Amount = f32,
    Newtons = f32,
    Word = u32,
    MUSCLE_BASE = 200,
    MUSCLE_PER_TYPE = 176,
    UNITS_BASE = 4336,
    UNITS_PER_TYPE = 144,
    STEADY_BASE = 160,
    STEADY_PER_TYPE = 64,
    FATIGUE_SIZE = 64,
    CURVE_SIZE = 64,
    JOINT_BASE = 48,
    JOINT_PER_MUSCLE = 104,
    JOINT_PER_MUSCLE_OF_TWO = 192,
    PROSTHESIS_OWN = 1232,
    FES_OWN = 760,
    STATE_WORDS = 22,
    PROSTHESIS_WORDS = 254,
    FES_WORDS = 19,
}
