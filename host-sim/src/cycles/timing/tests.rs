//! Tests each timing rule on a short sequence.

use super::super::instruction::Decoder;
use super::*;

/// Cycles of a sequence executed `passes` times; for more than one it must end with a branch back.
fn cycles(setting: Setting, halfwords: &[u16], passes: u64) -> u64 {
    cycles_on(Core::CortexM4F, setting, halfwords, passes)
}

/// The same on a core.
pub(super) fn cycles_on(core: Core, setting: Setting, halfwords: &[u16], passes: u64) -> u64 {
    let code: Vec<u8> = halfwords.iter().flat_map(|h| h.to_le_bytes()).collect();
    let decoder = Decoder::new().expect("a decoder");
    let mut instructions = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let one = decoder.decode(&code[at..], 0x1000 + at as u32).expect("an instruction");
        at += one.size as usize;
        instructions.push(one);
    }
    let mut pipeline = Pipeline::default();
    let mut cycles = 0;
    for pass in 0..passes {
        for (index, one) in instructions.iter().enumerate() {
            let back = index + 1 == instructions.len() && pass + 1 < passes;
            cycles += pipeline.execute(core, setting, one, back);
        }
    }
    cycles
}

/// Cycles per pass of a loop, in steady state.
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

/// Cycles of a taken branch.
fn taken(setting: Setting, halfwords: &[u16]) -> u64 {
    let code: Vec<u8> = halfwords.iter().flat_map(|h| h.to_le_bytes()).collect();
    let one = Decoder::new().expect("a decoder").decode(&code, 0x1000).expect("one");
    Pipeline::default().execute(Core::CortexM4F, setting, &one, true)
}

/// Encodes a `bne` back over a number of halfwords.
fn bne_back(halfwords: u16) -> u16 {
    0xD100 | (0xFF & (0_u16.wrapping_sub(halfwords + 2)))
}

#[test]
fn loops_of_multiplications_agree_with_published_hardware_counts() {
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
fn a_float_result_stalls_only_the_next_instruction() {
    let apart = [VMUL_CHAINED, VMUL_APART, VMUL_CHAINED].concat();
    assert_eq!(cycles(Setting::Typical, &apart, 1), 3);
    let chained = VMUL_CHAINED.repeat(3);
    assert_eq!(cycles(Setting::Typical, &chained, 1), 5);
}

#[test]
fn consecutive_accesses_are_pipelined_unless_the_address_was_just_loaded() {
    assert_eq!(cycles(Setting::Typical, &[LDR], 1), 2);
    assert_eq!(cycles(Setting::Typical, &[LDR, LDR_NEXT], 1), 3);
    assert_eq!(cycles(Setting::Typical, &[LDR_NEXT, STR], 1), 3);
    assert_eq!(cycles(Setting::Typical, &[LDR, LDR_THROUGH], 1), 4);
    assert_eq!(cycles(Setting::Pessimistic, &[LDR, LDR_NEXT], 1), 4);
    // One stall cycle if the previous instruction computed the address.
    assert_eq!(cycles(Setting::Typical, &[ADDS_ADDRESS, LDR], 1), 4);
    assert_eq!(cycles(Setting::Optimistic, &[ADDS_ADDRESS, LDR], 1), 3);
}

#[test]
fn a_division_overlaps_with_independent_instructions() {
    assert_eq!(cycles(Setting::Pessimistic, &VDIV, 1), 14);
    let overlapping = [VDIV[0], VDIV[1], SUBS, SUBS, LDR, VADD[0], VADD[1]];
    assert_eq!(cycles(Setting::Typical, &overlapping, 1), 15);
    assert_eq!(cycles(Setting::Pessimistic, &overlapping, 1), 14 + 2 + 2 + 1);
}

#[test]
fn multiple_loads_and_stores_take_one_cycle_more_than_words() {
    assert_eq!(cycles(Setting::Typical, &[0xB5F0], 1), 6); // push {r4-r7, lr}
    assert_eq!(cycles(Setting::Typical, &[0xED2D, 0x8B04], 1), 5); // vpush {d8, d9}
}

#[test]
fn only_a_taken_branch_refills_the_pipeline() {
    let back = [SUBS, bne_back(1)];
    assert_eq!(per_pass(Setting::Optimistic, &back), 3);
    assert_eq!(per_pass(Setting::Typical, &back), 4);
    assert_eq!(per_pass(Setting::Pessimistic, &back), 5);
    assert_eq!(cycles(Setting::Typical, &back, 1), 2);
}

#[test]
fn if_then_is_folded_into_a_preceding_narrow_instruction() {
    let folded = [SUBS, 0xBF08, 0x2001]; // subs; it eq; moveq r0, #1
    assert_eq!(cycles(Setting::Optimistic, &folded, 1), 2);
    assert_eq!(cycles(Setting::Typical, &folded, 1), 2);
    assert_eq!(cycles(Setting::Pessimistic, &folded, 1), 3);
    let alone = [VADD[0], VADD[1], 0xBF08, 0x2001];
    assert_eq!(cycles(Setting::Typical, &alone, 1), 3);
}

#[test]
fn settings_span_the_cycles_of_integer_division() {
    let udiv = [0xFBB0, 0xF0F1];
    assert_eq!(cycles(Setting::Optimistic, &udiv, 1), 2);
    assert_eq!(cycles(Setting::Pessimistic, &udiv, 1), 12);
}

#[test]
fn long_multiplications_on_an_m3_take_the_manuals_cycles() {
    let (umull, smlal) = ([0xFBA2, 0x0103], [0xFBC2, 0x0103]);
    let on = |core, setting, code: &[u16]| cycles_on(core, setting, code, 1);
    use Setting::{Optimistic, Pessimistic, Typical};
    for (setting, multiply, accumulate) in
        [(Optimistic, 3, 4), (Typical, 4, 6), (Pessimistic, 5, 7)]
    {
        assert_eq!(on(Core::CortexM3, setting, &umull), multiply);
        assert_eq!(on(Core::CortexM3, setting, &smlal), accumulate);
        assert_eq!(on(Core::CortexM4F, setting, &umull), 1);
        // MUL, a load after a load, a taken branch: as on an M4.
        for code in [&[0xFB02_u16, 0xF003][..], &[LDR, LDR_NEXT], &[SUBS, bne_back(1)]] {
            let of = |core| cycles_on(core, setting, code, 3);
            assert_eq!(of(Core::CortexM3), of(Core::CortexM4F));
        }
    }
}

#[test]
fn multiply_accumulates_take_the_manuals_cycles() {
    assert_eq!(cycles(Setting::Typical, &[0xFB00, 0x2001], 1), 2); // mla
    assert_eq!(cycles(Setting::Typical, &[0xFBC2, 0x0103], 1), 1); // smlal
    assert_eq!(cycles(Setting::Typical, &[0xEEA0, 0x0A81], 1), 3); // vfma.f32
    assert_eq!(cycles(Setting::Typical, &[0xEE00, 0x0A81], 1), 3); // vmla.f32
}

#[test]
fn float_moves_and_comparisons_do_not_stall_the_next_instruction() {
    let absolute = [0xEEB0, 0x0AC0]; // vabs.f32 s0, s0
    assert_eq!(cycles(Setting::Typical, &[absolute, absolute].concat(), 1), 2);
    let two = [0xEC41, 0x0B10]; // vmov d0, r0, r1
    assert_eq!(cycles(Setting::Typical, &two, 1), 2);
    // But they stall on the result of the instruction before.
    assert_eq!(cycles(Setting::Typical, &[VMUL_CHAINED, absolute].concat(), 1), 3);
}

#[test]
fn register_offset_and_pair_accesses_take_longer_than_a_store() {
    assert_eq!(cycles(Setting::Typical, &[STR], 1), 1);
    assert_eq!(cycles(Setting::Typical, &[0x5088], 1), 2); // str r0, [r1, r2]
    assert_eq!(cycles(Setting::Typical, &[0xE9D1, 0x0200], 1), 3); // ldrd r0, r2, [r1]
    assert_eq!(cycles(Setting::Typical, &[0xE9C1, 0x0200], 1), 3); // strd r0, r2, [r1]
    // A pair is not pipelined with a load before it.
    assert_eq!(cycles(Setting::Typical, &[LDR_NEXT, 0xE9D1, 0x0300], 1), 5);
}

#[test]
fn float_loads_are_pipelined() {
    let load = [0xED91, 0x0A00]; // vldr s0, [r1]
    let next = [0xEDD1, 0x0A01]; // vldr s1, [r1, #4]
    assert_eq!(cycles(Setting::Typical, &load, 1), 2);
    assert_eq!(cycles(Setting::Typical, &[load, next].concat(), 1), 3);
    assert_eq!(cycles(Setting::Pessimistic, &[load, next].concat(), 1), 4);
}

#[test]
fn a_load_from_the_address_just_stored_stalls() {
    let again = 0x680A; // ldr r2, [r1]
    assert_eq!(cycles(Setting::Typical, &[STR, again], 1), 1 + 1 + 1);
    assert_eq!(cycles(Setting::Optimistic, &[STR, again], 1), 1 + 1);
    assert_eq!(cycles(Setting::Typical, &[STR, LDR_NEXT], 1), 1 + 1);
}

#[test]
fn calls_and_returns_refill_the_pipeline() {
    let call = [0xF7FF, 0xFFFE];
    for (setting, refill) in
        [(Setting::Optimistic, 1), (Setting::Typical, 2), (Setting::Pessimistic, 3)]
    {
        assert_eq!(taken(setting, &call), 1 + refill);
        assert_eq!(taken(setting, &[0x4770]), 1 + refill); // bx lr
        assert_eq!(taken(setting, &[0xBD10]), 3 + refill); // pop {r4, pc}
    }
}

#[test]
fn an_unaligned_wide_instruction_after_a_taken_branch_stalls() {
    let wide_first = [VMUL_CHAINED[0], VMUL_CHAINED[1], SUBS, bne_back(3)];
    let aligned = per_pass(Setting::Typical, &wide_first);
    // The same loop two bytes further on.
    let code: Vec<u8> = wide_first.iter().flat_map(|h| h.to_le_bytes()).collect();
    let decoder = Decoder::new().expect("a decoder");
    let wide = decoder.decode(&code, 0x1002).expect("an instruction");
    let branch = decoder.decode(&code[6..], 0x1008).expect("an instruction");
    let mut pipeline = Pipeline::default();
    let first = pipeline.execute(Core::CortexM4F, Setting::Typical, &wide, false);
    pipeline.execute(Core::CortexM4F, Setting::Typical, &branch, true);
    let after_jump = pipeline.execute(Core::CortexM4F, Setting::Typical, &wide, false);
    assert_eq!((first, after_jump, aligned), (1, 2, 5));
}
