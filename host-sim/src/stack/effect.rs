//! What an instruction does to the stack pointer, and where it goes.

use crate::cycles::{Class, Instruction};

/// What an instruction does to the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OnStack {
    /// Adds so many bytes.
    Moves(i32),
    /// The instruction does not say by how much.
    Dynamic,
    /// Begins another one.
    Begins,
}

/// Where an instruction goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goes {
    /// To the next one.
    On,
    /// To an address.
    To(u32),
    /// To an address, or on.
    ToOrOn(u32),
    /// To a function, and on if that returns.
    Call(u32),
    /// By a register or memory, and on.
    IndirectCall,
    /// By a register or memory.
    IndirectJump,
    /// By the table behind it, of entries of so many bytes.
    Table(u32),
    /// To the caller.
    Return,
    /// Nowhere: an instruction that is none.
    Nowhere,
}

const STACK_POINTER: u64 = 1 << 13;

/// What an instruction does to the stack pointer.
pub(super) fn on_stack(instruction: &Instruction) -> OnStack {
    let text = &instruction.text;
    let operands = text.split_once(' ').map_or("", |(_, operands)| operands);
    let name = instruction.mnemonic().split('.').next().unwrap_or("");
    let writes = instruction.writes & STACK_POINTER != 0;
    match name {
        "add" | "addw" | "sub" | "subw" if operands.starts_with("sp,") => {
            let constant = operands.starts_with("sp, #") || operands.starts_with("sp, sp, #");
            if constant { OnStack::Moves(instruction.stack_change) } else { OnStack::Dynamic }
        }
        "msr" if operands.to_lowercase().contains("sp,") => OnStack::Begins,
        _ if instruction.stack_change != 0 => OnStack::Moves(instruction.stack_change),
        _ if writes => OnStack::Dynamic,
        _ => OnStack::Moves(0),
    }
}

/// Where an instruction goes.
pub(super) fn goes(instruction: &Instruction) -> Goes {
    let text = &instruction.text;
    let by = |go: fn(u32) -> Goes| instruction.target().map_or(Goes::IndirectJump, go);
    match (instruction.mnemonic(), instruction.class) {
        ("tbb", _) => Goes::Table(1),
        ("tbh", _) => Goes::Table(2),
        ("udf" | "udf.w", _) => Goes::Nowhere,
        ("b" | "b.w", _) => by(Goes::To),
        (_, Class::Branch) => by(Goes::ToOrOn),
        (_, Class::Call) => instruction.target().map_or(Goes::IndirectCall, Goes::Call),
        ("bx", _) if text.ends_with("lr") => Goes::Return,
        ("bx", _) => Goes::IndirectJump,
        (name, _) if name.starts_with("blx") => Goes::IndirectCall,
        ("mov", _) if text == "mov pc, lr" => Goes::Return,
        // What was pushed as the link register, and nothing else that is loaded.
        (name, Class::LoadMany(_)) if instruction.writes_program_counter() => {
            let from_stack = name.starts_with("pop") || text.contains(" sp!");
            if from_stack { Goes::Return } else { Goes::IndirectJump }
        }
        ("ldr" | "ldr.w", _) if text.contains(" pc, [sp], #") => Goes::Return,
        _ if instruction.writes_program_counter() => Goes::IndirectJump,
        _ => Goes::On,
    }
}

/// Which of the instructions behind an IT execute if its condition holds; all others do if it does not.
pub(super) fn conditional_behind(instruction: &Instruction) -> Option<Vec<bool>> {
    let then_else = instruction.mnemonic().strip_prefix('i')?;
    let is_one = instruction.class == Class::IfThen;
    is_one.then(|| then_else.chars().map(|letter| letter == 't').collect())
}

/// Whether it may change what later conditions are told by.
pub(super) fn sets_flags(instruction: &Instruction) -> bool {
    let name = instruction.mnemonic();
    ["cmp", "cmn", "tst", "teq", "vmrs", "msr"].iter().any(|setter| name.starts_with(setter))
}
