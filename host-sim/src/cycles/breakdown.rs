//! Where cycles go: by function, by class of instruction, by address.

use super::estimator::Cost;
use super::image::{Image, ImageError};
use super::instruction::{Class, Instruction};
use super::source::Source;
use std::collections::BTreeMap;

/// A part of the cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is the cost of.
    pub name: String,
    /// Its cost.
    pub cost: Cost,
}

/// Executed instructions with how often each was executed, and its cost in all.
type Executions = [(Instruction, u64, Cost)];

/// The cost of each function, the most expensive first.
pub fn by_function(image: &Image, executions: &Executions) -> Vec<Part> {
    sums(executions, |instruction| {
        image
            .function_at(instruction.address)
            .map_or("outside of any function", |function| &function.name)
            .to_owned()
    })
}

/// The cost of what is in each file of the model, the most expensive first.
pub fn by_file(image: &Image, executions: &Executions) -> Result<Vec<Part>, ImageError> {
    let source = Source::of(image)?;
    Ok(sums(executions, |instruction| source.file(instruction.address)))
}

/// The cost of each class of instruction, the most expensive first.
pub fn by_class(executions: &Executions) -> Vec<Part> {
    sums(executions, |instruction| class_name(instruction.class).to_owned())
}

/// The addresses that cost most, at most `count` of them.
pub fn hottest(executions: &Executions, count: usize) -> Vec<&(Instruction, u64, Cost)> {
    let mut all: Vec<_> = executions.iter().collect();
    all.sort_by_key(|(instruction, _, cost)| {
        (std::cmp::Reverse(cost.cycles[1]), instruction.address)
    });
    all.truncate(count);
    all
}

fn sums(executions: &Executions, name: impl Fn(&Instruction) -> String) -> Vec<Part> {
    let mut parts: BTreeMap<String, Cost> = BTreeMap::new();
    for (instruction, _, cost) in executions {
        parts.entry(name(instruction)).or_default().add(cost);
    }
    let mut parts: Vec<Part> = parts.into_iter().map(|(name, cost)| Part { name, cost }).collect();
    parts.sort_by_key(|part| std::cmp::Reverse(part.cost.cycles[1]));
    parts
}

fn class_name(class: Class) -> &'static str {
    match class {
        Class::Integer => "integer",
        Class::LongMultiply => "long multiply",
        Class::LongMultiplyAccumulate => "long multiply-accumulate",
        Class::MultiplyAccumulate => "integer multiply-accumulate",
        Class::IntegerDivide => "integer divide",
        Class::Load => "load",
        Class::Store => "store",
        Class::StoreByRegister => "store, register offset",
        Class::LoadMany(_) => "load of several words",
        Class::StoreMany(_) => "store of several words",
        Class::Branch => "branch",
        Class::Call => "call",
        Class::BranchToRegister => "branch to a register",
        Class::IfThen => "if-then",
        Class::Float => "float add, multiply, convert",
        Class::FloatMove => "float move, compare",
        Class::FloatMoveTwo => "float move of two registers",
        Class::FloatMultiplyAccumulate => "float multiply-accumulate",
        Class::FloatDivide => "float divide, root",
    }
}

#[cfg(test)]
mod tests {
    use super::super::instruction::Decoder;
    use super::*;

    #[test]
    fn costs_are_added_up_by_class_and_sorted() {
        let decoder = Decoder::new().expect("a decoder");
        let one = |code: &[u8], address, times, cycles| {
            let instruction = decoder.decode(code, address).expect("an instruction");
            (instruction, times, Cost { instructions: times, cycles: [cycles; 3] })
        };
        let executions = [
            one(&[0x08, 0x68], 0x100, 4, 8), // ldr r0, [r1]
            one(&[0x01, 0x38], 0x102, 5, 5), // subs r0, #1
            one(&[0x4A, 0x68], 0x104, 1, 2), // ldr r2, [r1, #4]
        ];
        let parts = by_class(&executions);
        let named: Vec<(&str, u64)> =
            parts.iter().map(|part| (part.name.as_str(), part.cost.cycles[1])).collect();
        assert_eq!(named, [("load", 10), ("integer", 5)]);
        assert_eq!(hottest(&executions, 1)[0].0.address, 0x100);
    }
}
