//! The cores with a timing model.

use super::instruction::Class;
use crate::engine;
use crate::target::{self, Board};
use serde::{Deserialize, Serialize};

/// A core whose instruction timing is modelled.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum Core {
    /// Cortex-M4 with its single-precision floating-point unit.
    #[default]
    #[serde(rename = "cortex-m4f")]
    #[value(name = "cortex-m4f")]
    CortexM4F,
    /// Cortex-M3: no floating-point unit; long multiplication in 3 to 5 cycles, 4 to 7 with
    /// accumulation.
    CortexM3,
    /// Cortex-M0+ with the single-cycle multiplier: no long multiplication, no division.
    #[serde(rename = "cortex-m0plus")]
    #[value(name = "cortex-m0plus")]
    CortexM0Plus,
    /// Cortex-M33 with its single-precision floating-point unit. Its instructions are its own,
    /// their cycles those of the M4F: Arm publishes none.
    CortexM33,
    /// Cortex-M7. Its instructions are its own, their cycles those of the M4F, which does not issue
    /// two at once.
    CortexM7,
}

impl Core {
    /// All cores.
    pub const ALL: [Self; 5] =
        [Self::CortexM4F, Self::CortexM3, Self::CortexM0Plus, Self::CortexM33, Self::CortexM7];

    /// Its name in tables and budgets and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4F => "cortex-m4f",
            Self::CortexM3 => "cortex-m3",
            Self::CortexM0Plus => "cortex-m0plus",
            Self::CortexM33 => "cortex-m33",
            Self::CortexM7 => "cortex-m7",
        }
    }

    /// Whether its timing is the M4F's, for want of its own. Such cores have no budgets.
    pub fn is_timed_as_m4f(self) -> bool {
        matches!(self, Self::CortexM33 | Self::CortexM7)
    }

    /// The accuracy class of its rows: the M0+ is fast enough for the economy class only.
    pub fn class(self) -> engine::Class {
        match self {
            Self::CortexM0Plus => engine::Class::Economy,
            _ => engine::Class::Standard,
        }
    }

    /// The emulated board that runs its programs. QEMU has no board with an M0+. Its instructions
    /// are a subset of the M3's, whose board has more memory than the only one with an M0.
    pub fn board(self) -> Board {
        match self {
            Self::CortexM4F => target::STM32F405,
            Self::CortexM3 => target::CORTEX_M3,
            Self::CortexM0Plus => Board { machine: target::CORTEX_M3.machine, ..target::CORTEX_M0 },
            Self::CortexM33 => target::CORTEX_M33,
            Self::CortexM7 => target::CORTEX_M7,
        }
    }

    /// Whether the core has the instructions of a class.
    pub(super) fn executes(self, class: Class) -> bool {
        match class {
            Class::Float
            | Class::FloatMove
            | Class::FloatMoveTwo
            | Class::FloatMultiplyAccumulate
            | Class::FloatDivide => !matches!(self, Self::CortexM3 | Self::CortexM0Plus),
            Class::LongMultiply
            | Class::LongMultiplyAccumulate
            | Class::MultiplyAccumulate
            | Class::IntegerDivide
            | Class::IfThen => self != Self::CortexM0Plus,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_agree_in_json_and_on_the_command_line() {
        for core in Core::ALL {
            let json = serde_json::to_string(&core).expect("a name");
            let command_line = clap::ValueEnum::to_possible_value(&core).expect("a name");
            assert_eq!(json.trim_matches('"'), core.name());
            assert_eq!(command_line.get_name(), core.name());
        }
    }
}
