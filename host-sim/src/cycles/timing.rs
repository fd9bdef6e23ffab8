//! The timing model of the Cortex-M4F: cycles of each instruction in the order of execution.
//!
//! Sources: Arm, Cortex-M4 Technical Reference Manual r0p1, tables 3-1 (instruction set), 7-1
//! (floating point) and section 3.3.2 (load and store timing). The settings span what the
//! manual leaves open: P, the cycles of refilling the pipeline, is 1 to 3 there.

use super::instruction::{Class, Instruction, Registers};

/// How what the manual leaves open is settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Shortest refill, every overlap happens.
    Optimistic,
    /// As published counts on hardware come out within a few percent.
    Typical,
    /// Longest refill, no overlap at all.
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

    /// SDIV and UDIV take 2 to 12 cycles, by their operands, which a trace does not show.
    fn divide(self) -> u64 {
        match self {
            Self::Optimistic => 2,
            Self::Typical => 7,
            Self::Pessimistic => 12,
        }
    }
}

/// Cycles of VDIV and VSQRT.
const FLOAT_DIVIDE: u64 = 14;

/// A core that counts its cycles.
#[derive(Clone, Debug)]
pub struct Core {
    setting: Setting,
    cycles: u64,
    /// Result of the last instruction, if that was one of `Class::Float`.
    float_result: Registers,
    /// Result of the last instruction, if that was integer work.
    integer_result: Registers,
    /// What the last instruction loaded, if it was a single load or store that can be pipelined.
    pipelined: Option<Registers>,
    /// The last instruction had 16 bits: an IT behind it is folded into it.
    narrow: bool,
    /// When the divider is free, and what it will have written.
    divider_free: u64,
    divider_result: Registers,
    /// The last instruction was a branch that was taken.
    jumped: bool,
}

impl Core {
    /// A core that has executed nothing yet.
    pub fn new(setting: Setting) -> Self {
        Self {
            setting,
            cycles: 0,
            float_result: 0,
            integer_result: 0,
            pipelined: None,
            narrow: false,
            divider_free: 0,
            divider_result: 0,
            jumped: false,
        }
    }

    /// Cycles so far.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// Executes an instruction; `next` is the address of the one executed after it.
    pub fn execute(&mut self, instruction: &Instruction, next: u32) {
        let taken = next != instruction.address.wrapping_add(instruction.size);
        self.cycles += self.stall(instruction);
        let issued = self.cycles;
        self.cycles += self.duration(instruction, taken);

        let float = instruction.class == Class::Float;
        self.float_result = if float { instruction.writes } else { 0 };
        let integer = matches!(instruction.class, Class::Integer | Class::MultiplyAccumulate);
        self.integer_result = if integer { instruction.writes } else { 0 };
        self.pipelined = instruction
            .is_single_access()
            .then_some(if instruction.class == Class::Load { instruction.writes } else { 0 });
        self.narrow = instruction.size == 2;
        self.jumped = taken;
        if instruction.class == Class::FloatDivide {
            self.divider_free = issued + FLOAT_DIVIDE;
            self.divider_result = instruction.writes;
        }
    }

    /// Cycles that an instruction waits for those before it.
    fn stall(&self, instruction: &Instruction) -> u64 {
        let uses = instruction.reads | instruction.addresses;
        let mut wait = 0;
        if uses & self.float_result != 0 {
            wait += 1;
        }
        if self.setting != Setting::Optimistic {
            if instruction.addresses & self.integer_result != 0 {
                wait += 1;
            }
            // A 32-bit instruction across two fetches has to be fetched twice.
            if self.jumped && instruction.size == 4 && instruction.address % 4 == 2 {
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
            wait = wait.max(self.divider_free.saturating_sub(self.cycles));
        }
        wait
    }

    /// Cycles that an instruction takes by itself.
    fn duration(&self, instruction: &Instruction, taken: bool) -> u64 {
        let refill = self.setting.refill();
        let pipelined = self.setting != Setting::Pessimistic
            && self.pipelined.is_some_and(|loaded| instruction.addresses & loaded == 0);
        let work = match instruction.class {
            Class::Integer | Class::Store | Class::Float | Class::FloatMove => 1,
            Class::MultiplyAccumulate | Class::FloatMoveTwo | Class::StoreByRegister => 2,
            Class::IntegerDivide => self.setting.divide(),
            Class::Load if pipelined => 1,
            Class::Load => 2,
            Class::LoadMany(words) | Class::StoreMany(words) => 1 + u64::from(words),
            Class::Branch => 1,
            Class::Call => 1,
            Class::BranchToRegister => 1,
            Class::IfThen => {
                let folded = match self.setting {
                    Setting::Optimistic => true,
                    Setting::Typical => self.narrow,
                    Setting::Pessimistic => false,
                };
                u64::from(!folded)
            }
            Class::FloatMultiplyAccumulate => 3,
            // The rest of a division runs beside what does not need it.
            Class::FloatDivide if self.setting != Setting::Pessimistic => 1,
            Class::FloatDivide => FLOAT_DIVIDE,
        };
        let branches =
            matches!(instruction.class, Class::Branch | Class::Call | Class::BranchToRegister)
                || instruction.writes_program_counter();
        work + if branches && taken { refill } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::instruction::Decoder;
    use super::*;

    /// Cycles of a straight sequence, and of a loop's pass where it ends with a branch back.
    fn cycles(setting: Setting, halfwords: &[u16], passes: u64) -> u64 {
        let code: Vec<u8> = halfwords.iter().flat_map(|h| h.to_le_bytes()).collect();
        let decoder = Decoder::new().expect("a decoder");
        let mut instructions = Vec::new();
        let mut at = 0;
        while at < code.len() {
            let one = decoder.decode(&code[at..], 0x1000 + at as u32).expect("an instruction");
            at += one.size as usize;
            instructions.push(one);
        }
        let mut core = Core::new(setting);
        for pass in 0..passes {
            for (index, one) in instructions.iter().enumerate() {
                let next = match instructions.get(index + 1) {
                    Some(next) => next.address,
                    None if pass + 1 < passes => instructions[0].address,
                    None => one.address + one.size,
                };
                core.execute(one, next);
            }
        }
        core.cycles()
    }

    /// Cycles of one more pass of a loop.
    fn per_pass(setting: Setting, halfwords: &[u16]) -> u64 {
        cycles(setting, halfwords, 101) - cycles(setting, halfwords, 100)
    }

    const VMUL_CHAINED: [u16; 2] = [0xEE20, 0x0A20]; // vmul.f32 s0, s0, s1
    const VMUL_APART: [u16; 2] = [0xEE61, 0x1A21]; // vmul.f32 s3, s2, s3
    const SUBS: u16 = 0x3801; // subs r0, #1
    const LDR: u16 = 0x6808; // ldr r0, [r1]
    const LDR_NEXT: u16 = 0x684A; // ldr r2, [r1, #4]
    const LDR_THROUGH: u16 = 0x6803; // ldr r3, [r0]
    const STR: u16 = 0x6008; // str r0, [r1]
    const ADDS_ADDRESS: u16 = 0x3104; // adds r1, #4
    const VDIV: [u16; 2] = [0xEE81, 0x0A01]; // vdiv.f32 s0, s2, s2
    const VADD: [u16; 2] = [0xEE31, 0x1A22]; // vadd.f32 s2, s2, s5

    /// `bne` back over some halfwords.
    fn bne_back(halfwords: u16) -> u16 {
        0xD100 | (0xFF & (0_u16.wrapping_sub(halfwords + 2)))
    }

    #[test]
    fn loops_of_multiplications_take_what_was_measured_on_hardware() {
        // Published: ten dependent VMUL in a loop, 22.3, 22.1 and 22.2 cycles a pass on STM32F405,
        // F411 and G431; one VMUL in a loop, 4.00, 4.00 and 4.01.
        let mut ten: Vec<u16> = VMUL_CHAINED.repeat(10);
        ten.extend([SUBS, bne_back(21)]);
        assert_eq!(per_pass(Setting::Optimistic, &ten), 22);
        assert_eq!(per_pass(Setting::Typical, &ten), 23);
        assert_eq!(per_pass(Setting::Pessimistic, &ten), 24);
        let one = [VMUL_CHAINED[0], VMUL_CHAINED[1], SUBS, bne_back(3)];
        assert_eq!(per_pass(Setting::Optimistic, &one), 4);
        assert_eq!(per_pass(Setting::Typical, &one), 5);
    }

    #[test]
    fn a_float_result_is_waited_for_by_the_next_instruction_only() {
        let apart = [VMUL_CHAINED, VMUL_APART, VMUL_CHAINED].concat();
        assert_eq!(cycles(Setting::Typical, &apart, 1), 3);
        let chained = VMUL_CHAINED.repeat(3);
        assert_eq!(cycles(Setting::Typical, &chained, 1), 5);
    }

    #[test]
    fn loads_and_stores_in_a_row_are_pipelined_unless_an_address_was_just_loaded() {
        assert_eq!(cycles(Setting::Typical, &[LDR], 1), 2);
        assert_eq!(cycles(Setting::Typical, &[LDR, LDR_NEXT], 1), 3);
        assert_eq!(cycles(Setting::Typical, &[LDR_NEXT, STR], 1), 3);
        assert_eq!(cycles(Setting::Typical, &[LDR, LDR_THROUGH], 1), 4);
        assert_eq!(cycles(Setting::Pessimistic, &[LDR, LDR_NEXT], 1), 4);
        // An address from the instruction before comes a cycle late.
        assert_eq!(cycles(Setting::Typical, &[ADDS_ADDRESS, LDR], 1), 4);
        assert_eq!(cycles(Setting::Optimistic, &[ADDS_ADDRESS, LDR], 1), 3);
    }

    #[test]
    fn a_division_runs_beside_what_does_not_need_it() {
        assert_eq!(cycles(Setting::Pessimistic, &VDIV, 1), 14);
        let beside = [VDIV[0], VDIV[1], SUBS, SUBS, LDR, VADD[0], VADD[1]];
        assert_eq!(cycles(Setting::Typical, &beside, 1), 15);
        assert_eq!(cycles(Setting::Pessimistic, &beside, 1), 14 + 2 + 2 + 1);
    }

    #[test]
    fn many_words_take_one_cycle_more_than_there_are() {
        assert_eq!(cycles(Setting::Typical, &[0xB5F0], 1), 6); // push {r4-r7, lr}
        assert_eq!(cycles(Setting::Typical, &[0xED2D, 0x8B04], 1), 5); // vpush {d8, d9}
    }

    #[test]
    fn a_taken_branch_refills_the_pipeline_and_one_not_taken_does_not() {
        let back = [SUBS, bne_back(1)];
        assert_eq!(per_pass(Setting::Optimistic, &back), 3);
        assert_eq!(per_pass(Setting::Typical, &back), 4);
        assert_eq!(per_pass(Setting::Pessimistic, &back), 5);
        assert_eq!(cycles(Setting::Typical, &back, 1), 2);
    }

    #[test]
    fn if_then_is_folded_into_a_narrow_instruction_before_it() {
        let folded = [SUBS, 0xBF08, 0x2001]; // subs; it eq; moveq r0, #1
        assert_eq!(cycles(Setting::Optimistic, &folded, 1), 2);
        assert_eq!(cycles(Setting::Typical, &folded, 1), 2);
        assert_eq!(cycles(Setting::Pessimistic, &folded, 1), 3);
        let alone = [VADD[0], VADD[1], 0xBF08, 0x2001];
        assert_eq!(cycles(Setting::Typical, &alone, 1), 3);
    }

    #[test]
    fn integer_divisions_take_the_worst_where_operands_are_not_known() {
        let udiv = [0xFBB0, 0xF0F1];
        assert_eq!(cycles(Setting::Optimistic, &udiv, 1), 2);
        assert_eq!(cycles(Setting::Pessimistic, &udiv, 1), 12);
    }
}
