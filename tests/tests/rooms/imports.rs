//! Imports of a crate, file by file, and the circles among them.
//!
//! A name that a module hands on (`pub use`) counts for the file that defines it, however it is
//! imported. Code that is only built for tests is left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module: its path from the crate's root.
type Module = Vec<String>;

/// One file of a crate.
struct File {
    path: PathBuf,
    /// Its code without comments, tests and imports.
    code: String,
    /// Every imported path and the name that it gets, and whether it is handed on.
    imports: Vec<(Module, String, bool)>,
}

/// A crate's files by module.
pub struct Crate(BTreeMap<Module, File>);

impl Crate {
    /// Of sources with their texts, below the folder of the `root` file (`lib.rs` or `main.rs`).
    pub fn new(sources: &[(PathBuf, String)], root: &Path) -> Self {
        let folder = root.parent().expect("a folder");
        let mut found = Self(BTreeMap::new());
        found.add(sources, folder, root, Vec::new());
        found
    }

    fn add(&mut self, sources: &[(PathBuf, String)], folder: &Path, file: &Path, module: Module) {
        let Some((path, text)) = sources.iter().find(|(path, _)| path == file) else { return };
        let code = without_tests(&without_texts(&without_comments(text)));
        let (imports, code) = imports(&code);
        for name in declared(&code) {
            let child: Module = module.iter().cloned().chain([name]).collect();
            let below = folder.join(child.join("/"));
            for file in [below.with_extension("rs"), below.join("mod.rs")] {
                self.add(sources, folder, &file, child.clone());
            }
        }
        self.0.insert(module, File { path: path.clone(), code, imports });
    }

    /// Files that import each other in a loop, each loop once, with the folder left out.
    pub fn circles(&self, folder: &Path) -> Vec<String> {
        let edges = self.edges();
        let reach = |from: &Module| {
            let (mut seen, mut ahead) = (BTreeSet::new(), vec![from.clone()]);
            while let Some(module) = ahead.pop() {
                for next in edges.get(&module).into_iter().flatten() {
                    if seen.insert(next.clone()) {
                        ahead.push(next.clone());
                    }
                }
            }
            seen
        };
        let reached: BTreeMap<_, _> = self.0.keys().map(|module| (module, reach(module))).collect();
        let mut circles = BTreeSet::new();
        for (module, seen) in reached.iter().filter(|(module, seen)| seen.contains(**module)) {
            let tied = seen.iter().filter(|other| reached[other].contains(*module));
            let names = tied.map(|other| {
                let path = &self.0[other].path;
                path.strip_prefix(folder).unwrap_or(path).display().to_string()
            });
            circles.insert(names.collect::<Vec<_>>().join(", "));
        }
        circles.into_iter().collect()
    }

    /// Every import between files, by their paths below a folder.
    pub fn imports(&self, folder: &Path) -> Vec<(String, String)> {
        let name = |module: &Module| {
            let path = &self.0[module].path;
            path.strip_prefix(folder).unwrap_or(path).display().to_string()
        };
        let edges = self.edges();
        let each = |(from, to): (&Module, &BTreeSet<Module>)| {
            let from = name(from);
            to.iter().map(|to| (from.clone(), name(to))).collect::<Vec<_>>()
        };
        edges.iter().flat_map(each).collect()
    }

    fn edges(&self) -> BTreeMap<Module, BTreeSet<Module>> {
        let mut edges = BTreeMap::new();
        for (module, file) in &self.0 {
            let used = file.imports.iter().filter(|(_, name, handed_on)| {
                !handed_on || words(&file.code).any(|word| word == name)
            });
            let paths = used.map(|(path, ..)| path.clone()).chain(paths(&file.code));
            let to = paths.filter_map(|path| self.resolved(module, &path, 0));
            edges.insert(module.clone(), to.filter(|to| to != module).collect());
        }
        edges
    }

    /// The module that defines what a path in a module names; None outside of the crate.
    fn resolved(&self, module: &Module, path: &[String], depth: usize) -> Option<Module> {
        assert!(depth < 20, "{module:?}: {path:?}");
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Vec::new(),
            "self" => module.clone(),
            "super" => module[..module.len().checked_sub(1)?].to_vec(),
            name => {
                let child: Module = module.iter().cloned().chain([name.to_owned()]).collect();
                self.0.contains_key(&child).then_some(child)?
            }
        };
        while let Some((name, after)) = rest.split_first() {
            if name == "super" {
                at.pop()?;
            } else {
                let child: Module = at.iter().cloned().chain([name.clone()]).collect();
                if self.0.contains_key(&child) {
                    at = child;
                } else {
                    let handed_on =
                        self.0[&at].imports.iter().find(|(_, given, on)| *on && given == name);
                    return match handed_on {
                        Some((path, ..)) => self.resolved(&at, path, depth + 1),
                        None => Some(at),
                    };
                }
            }
            rest = after;
        }
        Some(at)
    }
}

fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// Without what is between quotes, on one line.
fn without_texts(code: &str) -> String {
    let kept = |line: &str| {
        let line = line.replace("\\\"", "").replace("'\"'", "' '");
        line.split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
    };
    code.lines().map(kept).collect::<Vec<_>>().join("\n")
}

/// Without what follows `#[cfg(test)]`: up to its `;`, or its closing brace.
fn without_tests(code: &str) -> String {
    let mut kept = String::new();
    let mut rest = code;
    while let Some((before, after)) = rest.split_once("#[cfg(test)]") {
        kept += before;
        let mut depth = 0_i32;
        let end = after.char_indices().find(|(_, c)| {
            depth += i32::from(*c == '{') - i32::from(*c == '}');
            depth == 0 && matches!(c, ';' | '}')
        });
        rest = end.map_or("", |(at, _)| &after[at + 1..]);
    }
    kept + rest
}

/// Names of `mod name;`.
fn declared(code: &str) -> Vec<String> {
    let statements = code.lines().filter_map(|line| line.trim().strip_suffix(';'));
    let names = statements.filter_map(|line| line.split_once("mod "));
    names
        .filter(|(before, _)| !before.contains('"'))
        .map(|(_, name)| name.trim().to_owned())
        .collect()
}

/// What is imported, and the code without it.
fn imports(code: &str) -> (Vec<(Module, String, bool)>, String) {
    let (mut found, mut kept, mut statement) = (Vec::new(), String::new(), None::<String>);
    for line in code.lines() {
        let start = line.trim_start();
        let begins = ["use ", "pub use ", "pub(crate) use ", "pub(super) use "]
            .iter()
            .any(|word| start.starts_with(word));
        if statement.is_none() && begins {
            statement = Some(String::new());
        }
        let Some(text) = &mut statement else {
            kept += line;
            kept.push('\n');
            continue;
        };
        text.push_str(start);
        if let Some(text) = text.strip_suffix(';') {
            let (visibility, tree) = text.split_once("use ").expect("an import");
            let mut leaves = Vec::new();
            expand(&[], tree, &mut leaves);
            let handed_on = !visibility.is_empty();
            found.extend(leaves.into_iter().map(|(path, name)| (path, name, handed_on)));
            statement = None;
        }
    }
    (found, kept)
}

/// The leaves of an import: each path with the name that it gets.
fn expand(before: &[String], tree: &str, leaves: &mut Vec<(Module, String)>) {
    let tree = tree.trim();
    if let Some((head, group)) = tree.split_once('{') {
        let mut path = before.to_vec();
        path.extend(head.split("::").filter(|name| !name.trim().is_empty()).map(str::to_owned));
        let group = group.trim_end().strip_suffix('}').expect("a group");
        let (mut depth, mut start) = (0, 0);
        for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
            depth += i32::from(c == '{') - i32::from(c == '}');
            if c == ',' && depth == 0 {
                expand(&path, &group[start..at], leaves);
                start = at + 1;
            }
        }
    } else if !tree.is_empty() {
        let (path, given) = tree.split_once(" as ").map_or((tree, None), |(p, n)| (p, Some(n)));
        let mut full = before.to_vec();
        full.extend(path.split("::").map(|name| name.trim().to_owned()));
        if full.last().is_some_and(|name| name == "self") && full.len() > 1 {
            full.pop();
        }
        let name = given.unwrap_or(full.last().expect("a name")).to_owned();
        leaves.push((full, name));
    }
}

fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// Paths from `crate`, `super` or `self` that are written out in code.
fn paths(code: &str) -> impl Iterator<Item = Module> {
    let pieces = code.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':');
    pieces.filter_map(|piece| {
        let names: Module =
            piece.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        let first = names.first()?;
        (names.len() > 1 && ["crate", "super", "self"].contains(&first.as_str())).then_some(names)
    })
}
