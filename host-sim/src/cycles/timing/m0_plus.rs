//! The Cortex-M0+ with the single-cycle multiplier: Arm, Cortex-M0+ Technical Reference Manual
//! r0p1 (DDI 0484C), table 3.1, zero wait states, no single-cycle I/O port. The timing
//! of an instruction does not depend on those before it.

use crate::cycles::instruction::{Class, Instruction};

/// Cycles of an instruction; `taken`: execution did not continue at the following address.
pub(super) fn cycles(instruction: &Instruction, taken: bool) -> u64 {
    match instruction.class {
        Class::Load | Class::Store | Class::StoreByRegister => 2,
        // A return takes two more cycles; the program counter counts as one of the words.
        Class::LoadMany(words) if instruction.writes_program_counter() => 3 + u64::from(words),
        Class::LoadMany(words) | Class::StoreMany(words) => 1 + u64::from(words),
        Class::Call => 3,
        Class::BranchToRegister => 2,
        Class::Branch => 1 + u64::from(taken),
        // MOV and ADD to the program counter.
        _ if instruction.writes_program_counter() => 2,
        _ if matches!(instruction.mnemonic(), "mrs" | "msr" | "dmb" | "dsb" | "isb") => 3,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::cycles_on;
    use super::super::{Core, Setting};

    #[test]
    fn instructions_take_the_manuals_cycles_in_every_setting() {
        let cases: &[(&[u16], u64)] = &[
            (&[0x4348], 1),         // muls r0, r1, r0
            (&[0x3801], 1),         // subs r0, #1
            (&[0x6808], 2),         // ldr r0, [r1]
            (&[0x6808, 0x684A], 4), // ldr r0, [r1]; ldr r2, [r1, #4]: not pipelined
            (&[0x6008], 2),         // str r0, [r1]
            (&[0x5088], 2),         // str r0, [r1, r2]
            (&[0xB5F0], 6),         // push {r4-r7, lr}
            (&[0xBCF0], 5),         // pop {r4-r7}
            (&[0xBD10], 5),         // pop {r4, pc}
            (&[0xC90C], 3),         // ldm r1!, {r2, r3}
            (&[0xF7FF, 0xFFFE], 3), // bl
            (&[0x4770], 2),         // bx lr
            (&[0x4687], 2),         // mov pc, r0
            (&[0xD1FE], 1),         // bne, not taken
            (&[0xF3EF, 0x8000], 3), // mrs r0, apsr
            (&[0xF3BF, 0x8F6F], 3), // isb
        ];
        for setting in [Setting::Optimistic, Setting::Typical, Setting::Pessimistic] {
            for (code, expected) in cases {
                let found = cycles_on(Core::CortexM0Plus, setting, code, 1);
                assert_eq!(found, *expected, "{code:04x?}");
            }
            // subs; bne back, three times: taken twice.
            let twice_back = cycles_on(Core::CortexM0Plus, setting, &[0x3801, 0xD1FD], 3);
            assert_eq!(twice_back, 3 + 2 + 2 + 1);
        }
    }
}
