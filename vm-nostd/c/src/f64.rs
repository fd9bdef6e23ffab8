//! Muscles computed in double.

use crate::floating::floating;
use crate::template::*;

floating! { f64 }

arithmetic! {
    S = f64,
    prefix = "vm_f64_",
    Path = f64,
    Number = f64,
    Amount = f64,
    Newtons = f64,
    Word = u64,
    MUSCLE_BASE = 392,
    MUSCLE_PER_TYPE = 352,
    UNITS_BASE = 8136,
    UNITS_PER_TYPE = 288,
    STEADY_BASE = 312,
    STEADY_PER_TYPE = 128,
    FATIGUE_SIZE = 112,
    CURVE_SIZE = 120,
    JOINT_BASE = 80,
    JOINT_PER_MUSCLE = 208,
    JOINT_PER_MUSCLE_OF_TWO = 376,
    PROSTHESIS_OWN = 2352,
    FES_OWN = 1488,
    STATE_WORDS = 22,
    PROSTHESIS_WORDS = 254,
    FES_WORDS = 19,
}
