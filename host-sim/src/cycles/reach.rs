//! What a function can execute: its own instructions and those of all that it calls.

use super::core::Core;
use super::estimator::Decoded;
use super::follow::FollowError;
use super::image::Image;
use super::instruction::Class;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What can be reached from a function.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// Names of the functions.
    pub functions: BTreeSet<String>,
    /// Instructions of a floating-point unit, as text by address.
    pub floating_point: BTreeMap<u32, String>,
    /// Branches whose target is not in the instruction: what is behind them is not known.
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
        // Conditional branches, and those that an IT block makes conditional, may also go on: a
        // step too many is harmless, one too few is not.
        let (goes_on, target) = match instruction.class {
            // A branch by a table (TBB, TBH), which follows.
            _ if instruction.mnemonic().starts_with("tb") => {
                reached.indirect.insert(address, text.clone());
                (false, None)
            }
            // A Cortex-M0 reaches far within a function by BL, and does not come back.
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
            // A return, unless it is conditional.
            Class::LoadMany(_) => (!instruction.writes_program_counter(), None),
            _ if instruction.writes_program_counter() => {
                reached.indirect.insert(address, text.clone());
                (true, None)
            }
            _ => (true, None),
        };
        ahead.extend(target);
        ahead.extend(goes_on.then_some(next));
    }
    Ok(reached)
}
