//! Stack of one function: its greatest depth and the depth at each call.

use super::effect::{Goes, OnStack, goes, it_conditions, on_stack, sets_flags};
use crate::cycles::{Core, Decoded, Image};
use std::collections::{BTreeMap, BTreeSet};

/// A call, or a jump to another function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Call {
    /// Address.
    pub at: u32,
    /// Stack depth of the function at the call, bytes.
    pub depth: u32,
    /// Address of the called function; none for an indirect call.
    pub target: Option<u32>,
}

/// Result of walking a function.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Walked {
    /// Greatest depth without callees, bytes.
    pub own: u32,
    /// Calls.
    pub calls: BTreeSet<Call>,
    /// Whether it returns.
    pub returns: bool,
    /// Address at which it writes the stack pointer (MSR).
    pub resets: Option<u32>,
    /// Unknowns, by address.
    pub unknown: BTreeMap<u32, String>,
}

/// Functions walked so far.
pub(super) struct Functions<'a> {
    pub image: &'a Image,
    decoded: Decoded<'a>,
    /// `None` while a function is being walked, to detect recursion.
    walked: BTreeMap<u32, Option<Walked>>,
}

/// Limit of different depths at one instruction; more means that the stack grows in a loop.
const MOST_DEPTHS: usize = 8;

const NOP: [u8; 2] = [0x00, 0xBF];

impl<'a> Functions<'a> {
    pub fn new(image: &'a Image) -> Result<Self, capstone::Error> {
        Ok(Self { image, decoded: Decoded::new(image, Core::CortexM4F)?, walked: BTreeMap::new() })
    }

    /// Name of the function that begins at an address.
    pub fn name(&self, address: u32) -> String {
        match self.image.function_at(address) {
            Some(function) if function.address == address => function.name.clone(),
            Some(function) => format!("{} + {:#x}", function.name, address - function.address),
            None => format!("{address:#010x}"),
        }
    }

    /// The result for a walked function.
    pub fn known(&self, address: u32) -> Option<&Walked> {
        self.walked.get(&address)?.as_ref()
    }

    /// Walks a function and its callees.
    pub fn walk(&mut self, entry: u32) {
        if self.walked.contains_key(&entry) {
            return;
        }
        self.walked.insert(entry, None);
        let walked = self.walk_one(entry);
        let targets: Vec<u32> = walked.calls.iter().filter_map(|call| call.target).collect();
        self.walked.insert(entry, Some(walked));
        targets.into_iter().for_each(|target| self.walk(target));
    }

    /// Whether a function returns; assumed while it is being walked.
    fn returns(&mut self, entry: u32) -> bool {
        self.walk(entry);
        self.known(entry).is_none_or(|walked| walked.returns)
    }

    fn walk_one(&mut self, entry: u32) -> Walked {
        let mut walked = Walked::default();
        let Some(home) = self.image.function_at(entry) else {
            walked.unknown.insert(entry, "no function at this address".to_owned());
            return walked;
        };
        let inside = home.address..home.address + home.size;
        let mut depths: BTreeMap<(u32, Vec<bool>), Vec<u32>> = BTreeMap::new();
        // Address, depth, and the pending IT conditions.
        let mut ahead = vec![(entry, 0_u32, Vec::new())];
        while let Some((at, depth, block)) = ahead.pop() {
            let seen = depths.entry((at, block.clone())).or_default();
            // Visited at this depth already.
            if seen.last().is_some_and(|&before| before >= depth) {
                continue;
            }
            seen.push(depth);
            if seen.len() > MOST_DEPTHS {
                walked.unknown.insert(at, "the stack grows in a loop".to_owned());
                return walked;
            }
            let instruction = match self.decoded.at(at) {
                Ok(instruction) if inside.contains(&at) => instruction.clone(),
                _ => {
                    walked.unknown.insert(at, "runs past the end of the function".to_owned());
                    continue;
                }
            };
            let unknown = &mut walked.unknown;
            let mut unknown = |what: &str| {
                unknown.insert(at, format!("{what}: {}", instruction.text));
            };
            let next = at + instruction.size;
            let inverted = |block: &[bool]| block.iter().map(|executes| !executes).collect();
            if let Some(block) = it_conditions(&instruction) {
                ahead.push((next, depth, inverted(&block)));
                ahead.push((next, depth, block));
                continue;
            }
            let rest = block.get(1..).unwrap_or_default().to_vec();
            if block.first() == Some(&false) {
                ahead.push((next, depth, rest));
                continue;
            }
            let moved = match on_stack(&instruction) {
                OnStack::Moves(bytes) => i64::from(depth) - i64::from(bytes),
                OnStack::Dynamic => {
                    unknown("frame of unknown size");
                    i64::from(depth)
                }
                OnStack::Reset => {
                    walked.resets = Some(at);
                    i64::from(depth)
                }
            };
            let Ok(after) = u32::try_from(moved) else {
                unknown("pops beyond its own frame");
                continue;
            };
            walked.own = walked.own.max(after);
            let call = |target| Call { at, depth: after, target };
            let mut falls_through = None;
            let mut jumps = Vec::new();
            match goes(&instruction) {
                Goes::On => falls_through = Some(after),
                Goes::To(target) => jumps.push(target),
                Goes::ToOrOn(target) => {
                    jumps.push(target);
                    falls_through = Some(after);
                }
                Goes::Call(target) => {
                    walked.calls.insert(call(Some(target)));
                    if self.returns(target) {
                        falls_through = Some(after);
                    }
                }
                Goes::IndirectCall => {
                    walked.calls.insert(call(None));
                    falls_through = Some(after);
                }
                Goes::IndirectJump => {
                    walked.calls.insert(call(None));
                    walked.returns = true;
                }
                Goes::Table(bytes) => match self.table(next, bytes) {
                    Some(targets) => jumps.extend(targets),
                    None => unknown("unreadable branch table"),
                },
                Goes::Return => {
                    walked.returns = true;
                    if after != 0 {
                        unknown("returns without restoring the stack");
                    }
                }
                Goes::Nowhere => (),
            }
            for target in jumps {
                if inside.contains(&target) && (target != entry || after == 0) {
                    ahead.push((target, after, Vec::new()));
                } else {
                    // A tail call.
                    walked.calls.insert(call(Some(target)));
                    walked.returns |= self.returns(target);
                }
            }
            if sets_flags(&instruction) && !rest.is_empty() {
                ahead.extend(falls_through.map(|depth| (next, depth, inverted(&rest))));
            }
            ahead.extend(falls_through.map(|depth| (next, depth, rest)));
        }
        walked
    }

    /// Targets of the table of a TBB or TBH, with entries of 1 or 2 bytes. The table ends where
    /// code begins, as marked in the image or at its first target.
    fn table(&self, start: u32, bytes: u32) -> Option<BTreeSet<u32>> {
        let mut targets: BTreeSet<u32> = BTreeSet::new();
        let mut at = start;
        let end = self.image.code_behind(start).unwrap_or(u32::MAX);
        loop {
            let end = targets.first().map_or(end, |&first| end.min(first));
            // A NOP may align the code.
            if at >= end || (at + 2 == end && self.image.code_at(at).starts_with(&NOP)) {
                return Some(targets);
            }
            let entry = match (self.image.code_at(at), bytes) {
                ([byte, ..], 1) => u32::from(*byte),
                ([low, high, ..], 2) => u32::from(u16::from_le_bytes([*low, *high])),
                _ => return None,
            };
            // A target inside the table is padding.
            if entry != 0 {
                targets.insert(start + 2 * entry);
            }
            at += bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: u32 = 0x0800_0000;

    /// Walks the first function.
    fn walked(functions: &[(&str, &[u16])]) -> Walked {
        let image = Image::of_code(HERE, functions);
        let mut functions = Functions::new(&image).expect("a decoder");
        functions.walk(HERE);
        functions.known(HERE).expect("walked").clone()
    }

    /// Greatest depth of a function without calls.
    fn own(code: &[u16]) -> u32 {
        let walked = walked(&[("f", code)]);
        assert_eq!(walked.unknown, BTreeMap::new());
        assert!(walked.returns);
        walked.own
    }

    fn only_unknown(code: &[u16]) -> String {
        let walked = walked(&[("f", code), ("g", &[0x4770])]);
        let all: Vec<String> = walked.unknown.into_values().collect();
        assert_eq!(all.len(), 1, "{code:x?}: {all:?}");
        all[0].clone()
    }

    #[test]
    fn all_kinds_of_prologues_are_counted() {
        // bx lr
        assert_eq!(own(&[0x4770]), 0);
        // push {r4-r7, lr}; sub sp, #16; add sp, #16; pop {r4-r7, pc}
        assert_eq!(own(&[0xB5F0, 0xB084, 0xB004, 0xBDF0]), 36);
        // push {r7, lr}; sub.w sp, sp, #8192; add.w sp, sp, #8192; pop {r7, pc}
        assert_eq!(own(&[0xB580, 0xF5AD, 0x5D00, 0xF50D, 0x5D00, 0xBD80]), 8200);
        // stmdb sp!, {r4-r11, lr}; vpush {d8, d9}; vpop {d8, d9}; ldmia sp!, {r4-r11, pc}
        assert_eq!(own(&[0xE92D, 0x4FF0, 0xED2D, 0x8B04, 0xECBD, 0x8B04, 0xE8BD, 0x8FF0]), 36 + 16);
        // str lr, [sp, #-8]!; ldr pc, [sp], #8
        assert_eq!(own(&[0xF84D, 0xED08, 0xF85D, 0xFB08]), 8);
    }

    #[test]
    fn after_a_conditional_return_the_depth_is_unchanged() {
        // push {r4, lr}; cmp r0, #0; it eq; popeq {r4, pc}; sub sp, #8; add sp, #8; pop {r4, pc}
        assert_eq!(own(&[0xB510, 0x2800, 0xBF08, 0xBD10, 0xB082, 0xB002, 0xBD10]), 16);
        // push {r4, lr}; sub sp, #8; itt ne; addne sp, #8; popne {r4, pc}; add sp, #8; pop {r4, pc}
        assert_eq!(own(&[0xB510, 0xB082, 0xBF1C, 0xB002, 0xBD10, 0xB002, 0xBD10]), 16);
        // push {r4, lr}; ite eq; subeq sp, #8; subne sp, #16; add sp, #8; pop {r4, pc}: the depth
        // depends on the condition
        let depends = &[0xB510, 0xBF0C, 0xB082, 0xB084, 0xB002, 0xBD10];
        assert!(only_unknown(depends).contains("returns without restoring"));
    }

    #[test]
    fn a_comparison_in_an_it_block_may_change_the_condition() {
        // push {r4, lr}; itt eq; cmpeq r0, #0; popeq {r4, pc}; pop {r4, pc}
        assert_eq!(own(&[0xB510, 0xBF04, 0x2800, 0xBD10, 0xBD10]), 8);
        // The same without an unconditional return at the end.
        let walked = walked(&[("f", &[0xB510, 0xBF04, 0x2800, 0xBD10])]);
        assert_eq!(
            walked.unknown.values().collect::<Vec<_>>(),
            ["runs past the end of the function"]
        );
    }

    #[test]
    fn calls_and_tail_calls_have_the_depth_at_the_call() {
        // push {r7, lr}; bl g; pop.w {r7, lr}; b.w h
        let f = [0xB580, 0xF000, 0xF804, 0xE8BD, 0x4080, 0xF000, 0xB801];
        let walked = walked(&[("f", &f), ("g", &[0x4770]), ("h", &[0x4770])]);
        let calls: Vec<_> = walked.calls.iter().map(|call| (call.depth, call.target)).collect();
        assert_eq!(calls, [(8, Some(HERE + 14)), (0, Some(HERE + 16))]);
        assert_eq!((walked.own, walked.returns, walked.unknown.len()), (8, true, 0));
    }

    #[test]
    fn code_after_a_call_that_never_returns_is_not_walked() {
        // push {r7, lr}; bl g, the last instruction of f. g: b .
        let f: &[u16] = &[0xB580, 0xF000, 0xF800];
        let never = walked(&[("f", f), ("g", &[0xE7FE])]);
        assert_eq!((never.unknown.len(), never.returns), (0, false));
        let returns = walked(&[("f", f), ("g", &[0x4770])]);
        assert_eq!(
            returns.unknown.values().collect::<Vec<_>>(),
            ["runs past the end of the function"]
        );
    }

    #[test]
    fn an_undefined_instruction_ends_the_path() {
        // cbz r0, past the next; bx lr; udf #254, and the same with udf #0
        for undefined in [0xDEFE, 0xDE00] {
            let walked = walked(&[("f", &[0xB100, 0x4770, undefined])]);
            assert_eq!((walked.unknown.len(), walked.returns), (0, true), "{undefined:x}");
        }
    }

    #[test]
    fn all_targets_of_a_branch_table_are_walked() {
        // tbb [pc, r0]; .byte 2, 3, 5, 0; A: bx lr; B: push {r4, lr}; pop {r4, pc}; C: push {r4-r7,
        // lr}; pop {r4-r7, pc}
        let code = [0xE8DF, 0xF000, 0x0302, 0x0005, 0x4770, 0xB510, 0xBD10, 0xB5F0, 0xBDF0];
        assert_eq!(own(&code), 20);
        // The same with a NOP before A.
        let code = [0xE8DF, 0xF000, 0x0403, 0x0006, 0xBF00, 0x4770, 0xB510, 0xBD10, 0xB5F0, 0xBDF0];
        assert_eq!(own(&code), 20);
    }

    #[test]
    fn unknown_depths_are_reported() {
        // sub sp, r0; bx lr
        assert!(only_unknown(&[0xEBAD, 0x0D00, 0x4770]).contains("sub.w sp, sp, r0"));
        // mov sp, r7; bx lr
        assert!(only_unknown(&[0x46BD, 0x4770]).contains("mov sp, r7"));
        // msr msp, r0; bx lr
        assert_eq!(walked(&[("f", &[0xF380, 0x8808, 0x4770])]).resets, Some(HERE));
        // nop; push {r0}; b to the push
        assert_eq!(only_unknown(&[0xBF00, 0xB401, 0xE7FD]), "the stack grows in a loop");
        // push {r4}; bx lr
        assert!(only_unknown(&[0xB410, 0x4770]).contains("returns without restoring"));
        // pop {r4, pc} without a push
        assert!(only_unknown(&[0xBD10]).contains("beyond its own frame"));
    }

    #[test]
    fn indirect_calls_and_jumps_have_no_target() {
        // blx r0; bx lr. bx r1. mov pc, r0. ldr.w pc, [r0]
        for code in [&[0x4780, 0x4770][..], &[0x4708], &[0x4687], &[0xF8D0, 0xF000]] {
            let walked = walked(&[("f", code)]);
            let targets: Vec<_> = walked.calls.iter().map(|call| call.target).collect();
            assert_eq!(targets, [None], "{code:x?}");
        }
    }
}
