//! The timing models: cycles of each instruction in order of execution.
//!
//! Cortex-M4F: Arm, Cortex-M4 Technical Reference Manual r0p1, tables 3-1 (instruction set), 7-1
//! (floating point) and section 3.3.2 (load and store timing). Cortex-M3: Arm, Cortex-M3 Technical
//! Reference Manual r2p1 (DDI 0337I), table 3-1. Only long multiplication differs from the M4; the
//! pipeline stalls measured on an M4 are assumed for the M3. The settings span what the manuals
//! leave open: P, the cycles of a pipeline refill, is 1 to 3. The Cortex-M0+ is in [`m0_plus`]; its
//! manual leaves nothing open.

mod m0_plus;

use super::core::Core;
use super::instruction::{Class, Instruction, Place, Registers};

/// Assumption where the manual leaves the timing open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Shortest refill, every overlap happens.
    Optimistic,
    /// Agrees with published counts on hardware within a few percent.
    Typical,
    /// Longest refill, no overlap.
    Pessimistic,
}

impl Setting {
    /// P: cycles to refill the pipeline after a branch.
    fn refill(self) -> u64 {
        match self {
            Self::Optimistic => 1,
            Self::Typical => 2,
            Self::Pessimistic => 3,
        }
    }

    /// SDIV and UDIV: 2 to 12 cycles, depending on the operands, which a trace does not contain.
    fn divide(self) -> u64 {
        match self {
            Self::Optimistic => 2,
            Self::Typical => 7,
            Self::Pessimistic => 12,
        }
    }

    /// UMULL and SMULL: 1 cycle on an M4; 3 to 5 on an M3, depending on the operands.
    fn long_multiply(self, core: Core) -> u64 {
        match (core, self) {
            (Core::CortexM3, Self::Optimistic) => 3,
            (Core::CortexM3, Self::Typical) => 4,
            (Core::CortexM3, Self::Pessimistic) => 5,
            _ => 1,
        }
    }

    /// UMLAL and SMLAL: 1 cycle on an M4; 4 to 7 on an M3, depending on the operands.
    fn long_multiply_accumulate(self, core: Core) -> u64 {
        match (core, self) {
            (Core::CortexM3, Self::Optimistic) => 4,
            (Core::CortexM3, Self::Typical) => 6,
            (Core::CortexM3, Self::Pessimistic) => 7,
            _ => 1,
        }
    }
}

/// Cycles of VDIV and VSQRT.
const FLOAT_DIVIDE: u64 = 14;

/// State of the pipeline: exactly what the timing of the next instruction depends on. Equal states
/// give equal timing, so that the cost of a block can be cached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pipeline {
    /// Registers written by the last instruction if it was of `Class::Float`.
    float_result: Registers,
    /// Registers written by the last instruction if it was integer arithmetic.
    integer_result: Registers,
    /// Registers loaded by the last instruction if it was a single load or store, which can be
    /// pipelined.
    pipelined: Option<Registers>,
    /// Memory operand of the last instruction if it was a single store.
    stored: Option<Place>,
    /// The last instruction had 16 bits: a following IT is folded into it.
    narrow: bool,
    /// Cycles until the divider is free, and the registers it will write.
    divider_busy: u64,
    divider_result: Registers,
    /// The last instruction was a taken branch.
    jumped: bool,
}

impl Pipeline {
    /// Executes an instruction on a core and returns its cycles; `taken`: execution did not
    /// continue at the following address.
    pub fn execute(
        &mut self,
        core: Core,
        setting: Setting,
        instruction: &Instruction,
        taken: bool,
    ) -> u64 {
        if core == Core::CortexM0Plus {
            return m0_plus::cycles(instruction, taken);
        }
        let wait = self.wait(setting, instruction);
        let duration = self.duration(core, setting, instruction, taken);

        let (mut busy, mut result) = (self.divider_busy, self.divider_result);
        if instruction.class == Class::FloatDivide {
            // A division starts at issue, after the wait.
            (busy, result) = (wait + FLOAT_DIVIDE, instruction.writes);
        }
        let divider_busy = busy.saturating_sub(wait + duration);
        let integer = matches!(
            instruction.class,
            Class::Integer
                | Class::MultiplyAccumulate
                | Class::LongMultiply
                | Class::LongMultiplyAccumulate
        );
        let results = |of: bool| if of { instruction.writes } else { 0 };
        *self = Self {
            float_result: results(instruction.class == Class::Float),
            integer_result: results(integer),
            pipelined: instruction
                .is_single_access()
                .then_some(results(instruction.class == Class::Load)),
            stored: instruction.place.filter(|_| instruction.class == Class::Store),
            narrow: instruction.size == 2,
            divider_busy,
            divider_result: if divider_busy > 0 { result } else { 0 },
            jumped: taken,
        };
        wait + duration
    }

    /// Stall cycles of an instruction.
    fn wait(&self, setting: Setting, instruction: &Instruction) -> u64 {
        let uses = instruction.reads | instruction.addresses;
        let mut wait = 0;
        if uses & self.float_result != 0 {
            wait += 1;
        }
        if setting != Setting::Optimistic {
            if instruction.addresses & self.integer_result != 0 {
                wait += 1;
            }
            // A 32-bit instruction that straddles two words needs two fetches.
            if self.jumped && instruction.size == 4 && instruction.address % 4 == 2 {
                wait += 1;
            }
            // A store must leave the write buffer before its address can be read.
            if instruction.class == Class::Load
                && self.stored.is_some()
                && self.stored == instruction.place
            {
                wait += 1;
            }
        }
        let needs_divider = matches!(
            instruction.class,
            Class::Float
                | Class::FloatMove
                | Class::FloatMoveTwo
                | Class::FloatMultiplyAccumulate
                | Class::FloatDivide
        );
        if needs_divider || (uses | instruction.writes) & self.divider_result != 0 {
            wait = wait.max(self.divider_busy);
        }
        wait
    }

    /// Cycles of an instruction without stalls.
    fn duration(
        &self,
        core: Core,
        setting: Setting,
        instruction: &Instruction,
        taken: bool,
    ) -> u64 {
        let pipelined = setting != Setting::Pessimistic
            && self.pipelined.is_some_and(|loaded| instruction.addresses & loaded == 0);
        let work = match instruction.class {
            Class::Integer | Class::Store | Class::Float | Class::FloatMove => 1,
            Class::MultiplyAccumulate | Class::FloatMoveTwo | Class::StoreByRegister => 2,
            Class::LongMultiply => setting.long_multiply(core),
            Class::LongMultiplyAccumulate => setting.long_multiply_accumulate(core),
            Class::IntegerDivide => setting.divide(),
            Class::Load if pipelined => 1,
            Class::Load => 2,
            Class::LoadMany(words) | Class::StoreMany(words) => 1 + u64::from(words),
            Class::Branch | Class::Call | Class::BranchToRegister => 1,
            Class::IfThen => {
                let folded = match setting {
                    Setting::Optimistic => true,
                    Setting::Typical => self.narrow,
                    Setting::Pessimistic => false,
                };
                u64::from(!folded)
            }
            Class::FloatMultiplyAccumulate => 3,
            // The rest of a division overlaps with independent instructions.
            Class::FloatDivide if setting != Setting::Pessimistic => 1,
            Class::FloatDivide => FLOAT_DIVIDE,
        };
        let branches =
            matches!(instruction.class, Class::Branch | Class::Call | Class::BranchToRegister)
                || instruction.writes_program_counter();
        work + if branches && taken { setting.refill() } else { 0 }
    }
}

#[cfg(test)]
mod tests;
