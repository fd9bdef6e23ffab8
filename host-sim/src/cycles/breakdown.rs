//! Cycles by function, by source file, by class of instruction and by address.

use super::estimator::Cost;
use super::image::{Image, ImageError};
use super::instruction::{Class, Instruction};
use super::source::Source;
use std::collections::BTreeMap;

/// A share of the total cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name of the function, file or class.
    pub name: String,
    /// Its cost.
    pub cost: Cost,
}

/// Each executed instruction, its execution count and its total cost.
type Executions = [(Instruction, u64, Cost)];

/// Cost of each function, most expensive first.
pub fn by_function(image: &Image, executions: &Executions) -> Vec<Part> {
    sums(executions, |instruction| {
        image
            .function_at(instruction.address)
            .map_or("outside any function", |function| &function.name)
            .to_owned()
    })
}

/// Cost of each source file of the model, most expensive first.
pub fn by_file(image: &Image, executions: &Executions) -> Result<Vec<Part>, ImageError> {
    let source = Source::of(image)?;
    Ok(sums(executions, |instruction| source.file(instruction.address)))
}

/// Cost of each class of instruction, most expensive first.
pub fn by_class(executions: &Executions) -> Vec<Part> {
    sums(executions, |instruction| class_name(instruction.class).to_owned())
}

/// The `count` most expensive instructions.
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
