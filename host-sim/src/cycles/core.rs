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
}

impl Core {
    /// All cores.
    pub const ALL: [Self; 3] = [Self::CortexM4F, Self::CortexM3, Self::CortexM0Plus];

    /// Its name in tables and budgets and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4F => "cortex-m4f",
            Self::CortexM3 => "cortex-m3",
            Self::CortexM0Plus => "cortex-m0plus",
        }
    }

    /// The accuracy class of its rows: the M0+ is fast enough for the economy class only.
    pub fn class(self) -> engine::Class {
        match self {
            Self::CortexM4F | Self::CortexM3 => engine::Class::Standard,
            Self::CortexM0Plus => engine::Class::Economy,
        }
    }

    /// The emulated board that runs its programs. QEMU has no board with an M0+. Its instructions
    /// are a subset of the M3's, whose board has more memory than the only one with an M0.
    pub fn board(self) -> Board {
        match self {
            Self::CortexM4F => target::STM32F405,
            Self::CortexM3 => target::CORTEX_M3,
            Self::CortexM0Plus => {
                Board { machine: target::CORTEX_M3.machine, triple: target::CORTEX_M0.triple }
            }
        }
    }

    /// Whether the core has the instructions of a class.
    pub(super) fn executes(self, class: Class) -> bool {
        match class {
            Class::Float
            | Class::FloatMove
            | Class::FloatMoveTwo
            | Class::FloatMultiplyAccumulate
            | Class::FloatDivide => self == Self::CortexM4F,
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
