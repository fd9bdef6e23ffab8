//! Static call graph: all instructions that a function can reach.

use super::core::Core;
use super::estimator::Decoded;
use super::follow::FollowError;
use super::image::Image;
use super::instruction::Class;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The instructions reachable from a function.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// Names of the functions.
    pub functions: BTreeSet<String>,
    /// Instructions of a floating-point unit, as text by address.
    pub floating_point: BTreeMap<u32, String>,
    /// Indirect branches, whose targets are unknown.
    pub indirect: BTreeMap<u32, String>,
}

/// Follows every branch and call from a function of an image.
pub fn reachable(path: &Path, function: &str) -> Result<Reached, FollowError> {
    let image = Image::read(path)?;
    let mut decoded = Decoded::new(&image, Core::CortexM4F)?;
    let mut reached = Reached::default();
    let mut seen = BTreeSet::new();
    let mut ahead = vec![image.function(function)?.address];
    while let Some(address) = ahead.pop() {
        if !seen.insert(address) {
            continue;
        }
        let instruction = decoded
            .at(address)
            .map_err(|address| FollowError::Decode { address, core: Core::CortexM4F })?;
        if let Some(function) = image.function_at(address) {
            reached.functions.insert(function.name.clone());
        }
        let text = &instruction.text;
        if text.starts_with('v') {
            reached.floating_point.insert(address, text.clone());
        }
        let next = address + instruction.size;
        // Conditional branches, also those in an IT block, may fall through. Following too many
        // paths is harmless, missing one is not.
        let (falls_through, target) = match instruction.class {
            // Table branch (TBB, TBH); the table follows the instruction.
            _ if instruction.mnemonic().starts_with("tb") => {
                reached.indirect.insert(address, text.clone());
                (false, None)
            }
            // On a Cortex-M0 BL is also the long jump within a function; it does not return.
            Class::Call => {
                let target = instruction.target();
                let home = image.function_at(address);
                let jumps = target.is_some_and(|to| {
                    image.function_at(to) == home && home.is_some_and(|home| home.address != to)
                });
                (!jumps, target)
            }
            Class::Branch => (!matches!(instruction.mnemonic(), "b" | "b.w"), instruction.target()),
            Class::BranchToRegister if instruction.mnemonic() == "bx" && text.ends_with("lr") => {
                (false, None)
            }
            Class::BranchToRegister => {
                reached.indirect.insert(address, text.clone());
                (true, None)
            }
            // A POP of the program counter returns.
            Class::LoadMany(_) => (!instruction.writes_program_counter(), None),
            _ if instruction.writes_program_counter() => {
                reached.indirect.insert(address, text.clone());
                (true, None)
            }
            _ => (true, None),
        };
        ahead.extend(target);
        ahead.extend(falls_through.then_some(next));
    }
    Ok(reached)
}
