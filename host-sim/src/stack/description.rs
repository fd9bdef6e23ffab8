//! Description of what an image does not contain: vectors in use, their priorities, and targets of
//! indirect calls.

use serde::Deserialize;

/// Contents of `firmware/stack.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Description {
    /// The chip's memory.
    pub ram: Ram,
    /// Thread mode: code outside interrupts.
    pub thread: Thread,
    /// Function of all vectors that are not described.
    pub default_handler: String,
    /// Interrupt handlers.
    #[serde(rename = "handler")]
    pub handlers: Vec<Handler>,
    /// Indirect calls.
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
    /// Least share that must be free of statics and stack, %.
    pub least_free_percent: u32,
    /// Bytes below it without memory. A function with a larger frame could skip them.
    pub guard_bytes: u32,
}

/// Thread mode: code outside interrupts.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thread {
    /// Function of vector 1.
    pub entry: String,
    /// Function called at boot that returns before the idle loop.
    pub boot: String,
}

/// An interrupt handler.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Handler {
    /// Function.
    pub function: String,
    /// Index in the vector table.
    pub vector: u32,
    /// Task.
    pub task: String,
    /// It interrupts handlers of lower priority, not of the same.
    pub priority: Priority,
}

/// Priority of a handler.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged)]
pub enum Priority {
    /// Of a task: higher interrupts lower.
    Level(u8),
    /// It ends the program and must not use the stack.
    Ends(Ends),
}

/// See [`Priority::Ends`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ends {
    /// With a reset.
    Reset,
}

/// Targets of a function's indirect calls.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Indirect {
    /// Calling function.
    pub function: String,
    /// All possible targets.
    pub targets: Vec<String>,
    /// Reason why these are all.
    pub reason: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stimulators_description_parses() {
        let text = include_str!("../../../firmware/stack.toml");
        let description: Description = toml::from_str(text).expect("a description");
        assert!(description.indirect.iter().all(|indirect| !indirect.reason.is_empty()));
    }
}
