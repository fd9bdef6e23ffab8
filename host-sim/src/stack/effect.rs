//! Effect of an instruction on stack pointer and control flow.

use crate::cycles::{Class, Instruction};

/// Effect of an instruction on the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum OnStack {
    /// Adds this many bytes.
    Moves(i32),
    /// Changes it by an unknown amount.
    Dynamic,
    /// Writes it with an unrelated value (MSR).
    Reset,
}

/// Control flow of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goes {
    /// To the next instruction.
    On,
    /// To an address.
    To(u32),
    /// To an address, or to the next instruction.
    ToOrOn(u32),
    /// Calls a function; continues if that returns.
    Call(u32),
    /// Calls through a register or memory, then continues.
    IndirectCall,
    /// Jumps through a register or memory.
    IndirectJump,
    /// Jumps through the table that follows, with entries of this many bytes.
    Table(u32),
    /// To the caller.
    Return,
    /// An undefined instruction.
    Nowhere,
}

const STACK_POINTER: u64 = 1 << 13;

/// Effect of an instruction on the stack pointer.
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
        "msr" if operands.to_lowercase().contains("sp,") => OnStack::Reset,
        _ if instruction.stack_change != 0 => OnStack::Moves(instruction.stack_change),
        _ if writes => OnStack::Dynamic,
        _ => OnStack::Moves(0),
    }
}

/// Control flow of an instruction.
pub(super) fn goes(instruction: &Instruction) -> Goes {
    let text = &instruction.text;
    let by = |go: fn(u32) -> Goes| instruction.target().map_or(Goes::IndirectJump, go);
    match (instruction.mnemonic(), instruction.class) {
        ("tbb", _) => Goes::Table(1),
        ("tbh", _) => Goes::Table(2),
        // The disassembler's name of UDF #254, which the compiler emits for unreachable code.
        ("udf" | "udf.w" | "trap", _) => Goes::Nowhere,
        ("b" | "b.w", _) => by(Goes::To),
        (_, Class::Branch) => by(Goes::ToOrOn),
        (_, Class::Call) => instruction.target().map_or(Goes::IndirectCall, Goes::Call),
        ("bx", _) if text.ends_with("lr") => Goes::Return,
        ("bx", _) => Goes::IndirectJump,
        (name, _) if name.starts_with("blx") => Goes::IndirectCall,
        ("mov", _) if text == "mov pc, lr" => Goes::Return,
        // The popped word is the pushed link register.
        (name, Class::LoadMany(_)) if instruction.writes_program_counter() => {
            let from_stack = name.starts_with("pop") || text.contains(" sp!");
            if from_stack { Goes::Return } else { Goes::IndirectJump }
        }
        ("ldr" | "ldr.w", _) if text.contains(" pc, [sp], #") => Goes::Return,
        _ if instruction.writes_program_counter() => Goes::IndirectJump,
        _ => Goes::On,
    }
}

/// For each instruction of an IT block whether it executes if the condition holds; the others
/// execute if it does not.
pub(super) fn it_conditions(instruction: &Instruction) -> Option<Vec<bool>> {
    let then_else = instruction.mnemonic().strip_prefix('i')?;
    let is_it = instruction.class == Class::IfThen;
    is_it.then(|| then_else.chars().map(|letter| letter == 't').collect())
}

/// Whether it may change the condition flags.
pub(super) fn sets_flags(instruction: &Instruction) -> bool {
    let name = instruction.mnemonic();
    ["cmp", "cmn", "tst", "teq", "vmrs", "msr"].iter().any(|setter| name.starts_with(setter))
}
