//! What an image does not say of its stack: which vectors are used, at which priorities, and where indirect calls lead.

use serde::Deserialize;

/// What `firmware/stack.toml` holds.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The chip's memory.
    pub ram: Ram,
    /// What runs while no interrupt does.
    pub thread: Thread,
    /// What all vectors lead to that are not described.
    pub default_handler: String,
    /// Everything that interrupts.
    #[serde(rename = "handler")]
    pub handlers: Vec<Handler>,
    /// Calls by a register.
    #[serde(default)]
    pub indirect: Vec<Indirect>,
}

/// The chip's memory.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ram {
    /// First address.
    pub start: u32,
    /// Bytes.
    pub bytes: u32,
    /// What has to be free of statics and of the deepest stack, % of it.
    pub least_free_percent: u32,
    /// Bytes below it that are no memory: a function that takes more may step over them.
    pub guard_bytes: u32,
}

/// What runs while no interrupt does.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thread {
    /// The function of vector 1.
    pub entry: String,
    /// The part of it that is over before the rest begins.
    pub boot: String,
}

/// What interrupts.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Handler {
    /// Its function.
    pub function: String,
    /// Its place in the vector table.
    pub vector: u32,
    /// What it does.
    pub task: String,
    /// Handlers of a lower one are interrupted by it, those of the same are not.
    pub priority: Priority,
}

/// Which handlers interrupt which.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged)]
pub enum Priority {
    /// A task's: the higher the more urgent.
    Level(u8),
    /// It ends everything: it must not need the stack at all.
    Ends(Ends),
}

/// See [`Priority::Ends`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ends {
    /// By a reset.
    Reset,
}

/// Where a function's calls by a register lead.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Indirect {
    /// The function that calls.
    pub function: String,
    /// All that it can call.
    pub targets: Vec<String>,
    /// How that is known.
    pub reason: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stimulators_description_is_one() {
        let text = include_str!("../../../firmware/stack.toml");
        let description: Description = toml::from_str(text).expect("a description");
        assert!(description.indirect.iter().all(|indirect| !indirect.reason.is_empty()));
    }
}
