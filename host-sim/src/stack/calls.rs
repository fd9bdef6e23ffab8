//! Deepest call path of a function.

use super::description::Indirect;
use super::function::{Call, Functions};
use std::collections::{BTreeMap, BTreeSet};

/// A function on a call path.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Step {
    /// Name.
    pub function: String,
    /// Its stack depth at the call of the next function; for the last function its greatest depth.
    pub bytes: u32,
}

/// A deepest call path.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Deepest {
    /// Depth, bytes.
    pub bytes: u32,
    /// Functions, from the entry.
    pub path: Vec<Step>,
}

/// Call paths through an image.
pub(super) struct Calls<'f, 'a> {
    functions: &'f mut Functions<'a>,
    indirect: &'f [Indirect],
    known: BTreeMap<u32, Deepest>,
    /// From the entry to the current function.
    path: Vec<u32>,
    /// A function whose calls are ignored.
    ignored: Option<u32>,
    /// The function that may reset the stack pointer, because it never returns.
    pub may_reset: Option<u32>,
    /// Reasons why the depth is unknown.
    pub unknown: BTreeSet<String>,
    /// Indices of the described indirect calls that were found.
    pub used: BTreeSet<usize>,
}

impl<'f, 'a> Calls<'f, 'a> {
    pub fn new(functions: &'f mut Functions<'a>, indirect: &'f [Indirect]) -> Self {
        let (unknown, used) = Default::default();
        let (known, path) = Default::default();
        let (ignored, may_reset) = (None, None);
        Self { functions, indirect, known, path, ignored, may_reset, unknown, used }
    }

    /// Deepest path of a function, ignoring calls of another.
    pub fn deepest_without(&mut self, entry: u32, ignored: u32) -> Deepest {
        self.known.clear();
        self.ignored = Some(ignored);
        let deepest = self.deepest(entry);
        self.ignored = None;
        self.known.clear();
        deepest
    }

    /// Deepest path from `entry` that leads through a call of `via`.
    pub fn deepest_through(&mut self, entry: u32, via: u32) -> Option<Deepest> {
        self.functions.walk(entry);
        let walked = self.functions.known(entry)?.clone();
        let calls = walked.calls.iter().filter_map(|call| Some((call.target?, call.depth)));
        let calls: Vec<(u32, u32)> = calls.collect();
        let mut found: Option<Deepest> = None;
        for (target, depth) in calls {
            let below = if target == via {
                Some(self.deepest(target))
            } else {
                self.deepest_through(target, via)
            };
            let Some(below) = below else { continue };
            let here = self.prepend(entry, depth, below);
            if found.as_ref().is_none_or(|found| found.bytes < here.bytes) {
                found = Some(here);
            }
        }
        found
    }

    /// Deepest path of a function.
    pub fn deepest(&mut self, entry: u32) -> Deepest {
        if let Some(known) = self.known.get(&entry) {
            return known.clone();
        }
        if let Some(from) = self.path.iter().position(|&before| before == entry) {
            let names: Vec<String> =
                self.path[from..].iter().map(|&address| self.functions.name(address)).collect();
            self.unknown.insert(format!("recursion: {}, then again", names.join(", ")));
            return Deepest::default();
        }
        self.functions.walk(entry);
        let Some(walked) = self.functions.known(entry).cloned() else { return Deepest::default() };
        let name = self.functions.name(entry);
        for (at, what) in &walked.unknown {
            self.unknown.insert(format!("{name}, {at:#010x}: {what}"));
        }
        if let Some(at) = walked.resets.filter(|_| self.may_reset != Some(entry) || walked.returns)
        {
            self.unknown.insert(format!("{name}, {at:#010x}: writes the stack pointer"));
        }
        self.path.push(entry);
        let step = Step { function: name.clone(), bytes: walked.own };
        let mut deepest = Deepest { bytes: walked.own, path: vec![step] };
        for call in &walked.calls {
            for target in self.targets(&name, call) {
                if self.ignored == Some(target) {
                    continue;
                }
                let below = self.deepest(target);
                if call.depth + below.bytes > deepest.bytes {
                    deepest = self.prepend(entry, call.depth, below);
                }
            }
        }
        self.path.pop();
        self.known.insert(entry, deepest.clone());
        deepest
    }

    fn prepend(&self, entry: u32, depth: u32, below: Deepest) -> Deepest {
        let mut path = vec![Step { function: self.functions.name(entry), bytes: depth }];
        path.extend(below.path);
        Deepest { bytes: depth + below.bytes, path }
    }

    /// Possible targets of a call.
    fn targets(&mut self, name: &str, call: &Call) -> Vec<u32> {
        if let Some(target) = call.target {
            return vec![target];
        }
        let described = self.indirect.iter().position(|indirect| indirect.function == name);
        let Some(index) = described else {
            self.unknown.insert(format!("{name}, {:#010x}: indirect call", call.at));
            return Vec::new();
        };
        self.used.insert(index);
        let mut targets = Vec::new();
        for target in &self.indirect[index].targets {
            match self.functions.image.function(target) {
                Ok(function) => targets.push(function.address),
                Err(error) => {
                    self.unknown.insert(format!("{name}, described as calling {target}: {error}"));
                }
            }
        }
        targets
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycles::Image;

    const HERE: u32 = 0x0800_0000;

    fn deepest(functions: &[(&str, &[u16])], indirect: &[Indirect]) -> (Deepest, Vec<String>) {
        let image = Image::of_code(HERE, functions);
        let mut functions = Functions::new(&image).expect("a decoder");
        let mut calls = Calls::new(&mut functions, indirect);
        let deepest = calls.deepest(HERE);
        (deepest, calls.unknown.into_iter().collect())
    }

    fn names(deepest: &Deepest) -> Vec<(&str, u32)> {
        deepest.path.iter().map(|step| (step.function.as_str(), step.bytes)).collect()
    }

    /// push {r7, lr}; bl to a function this many halfwords after the end; pop {r7, pc}
    const fn calls_ahead(halfwords: u16) -> [u16; 4] {
        [0xB580, 0xF000, 0xF800 + halfwords, 0xBD80]
    }

    #[test]
    fn the_deeper_callee_adds_to_the_depth_at_its_call() {
        // push {r7, lr}; bl g; sub sp, #32; bl h; add sp, #32; pop {r7, pc}
        let f: &[u16] = &[0xB580, 0xF000, 0xF805, 0xB088, 0xF000, 0xF804, 0xB008, 0xBD80];
        // push {r4-r7, lr}; pop {r4-r7, pc}
        let g: &[u16] = &[0xB5F0, 0xBDF0];
        let (found, unknown) = deepest(&[("f", f), ("g", g), ("h", &[0xB510, 0xBD10])], &[]);
        assert_eq!((found.bytes, names(&found)), (48, vec![("f", 40), ("h", 8)]));
        assert_eq!(unknown, Vec::<String>::new());
    }

    #[test]
    fn recursion_is_reported_with_its_cycle() {
        // f calls g, which calls f.
        let g: &[u16] = &[0xB580, 0xF7FF, 0xFFF9, 0xBD80];
        let (_, unknown) = deepest(&[("f", &calls_ahead(1)), ("g", g)], &[]);
        assert_eq!(unknown, ["recursion: f, g, then again"]);
    }

    #[test]
    fn only_a_function_that_never_returns_may_reset_the_stack_pointer() {
        // msr msp, r0; b .
        let ends: [(&str, &[u16]); 1] = [("f", &[0xF380, 0x8808, 0xE7FE])];
        let returns: [(&str, &[u16]); 1] = [("f", &[0xF380, 0x8808, 0x4770])];
        for (functions, may, unknown) in [(ends, true, 0), (ends, false, 1), (returns, true, 1)] {
            let image = Image::of_code(HERE, &functions);
            let mut functions = Functions::new(&image).expect("a decoder");
            let mut calls = Calls::new(&mut functions, &[]);
            calls.may_reset = may.then_some(HERE);
            calls.deepest(HERE);
            assert_eq!(calls.unknown.len(), unknown, "{:?}", calls.unknown);
        }
    }

    #[test]
    fn an_indirect_call_is_reported_unless_the_description_lists_its_targets() {
        // push {r7, lr}; blx r0; pop {r7, pc}
        let functions: [(&str, &[u16]); 2] =
            [("f", &[0xB580, 0x4780, 0xBD80]), ("g", &[0xB5F0, 0xBDF0])];
        let (_, unknown) = deepest(&functions, &[]);
        assert_eq!(unknown, ["f, 0x08000002: indirect call"]);
        let described = |target: &str| Indirect {
            function: "f".to_owned(),
            targets: vec![target.to_owned()],
            reason: "a test".to_owned(),
        };
        let (found, unknown) = deepest(&functions, &[described("g")]);
        assert_eq!((found.bytes, unknown.len()), (28, 0));
        let (_, unknown) = deepest(&functions, &[described("h")]);
        assert!(unknown[0].contains("described as calling h"), "{unknown:?}");
    }

    #[test]
    fn paths_with_and_without_a_function_are_found() {
        let image = Image::of_code(
            HERE,
            &[
                // push {r7, lr}; bl boot; bl rest; pop {r7, pc}
                ("f", &[0xB580, 0xF000, 0xF803, 0xF000, 0xF803, 0xBD80]),
                ("boot", &[0xB5F0, 0xBDF0]),
                ("rest", &[0xB510, 0xBD10]),
            ],
        );
        let mut functions = Functions::new(&image).expect("a decoder");
        let mut calls = Calls::new(&mut functions, &[]);
        let boot = HERE + 12;
        assert_eq!(calls.deepest(HERE).bytes, 28);
        assert_eq!(calls.deepest_without(HERE, boot).bytes, 16);
        let through = calls.deepest_through(HERE, boot).expect("a path");
        assert_eq!(names(&through), [("f", 8), ("boot", 20)]);
    }
}
