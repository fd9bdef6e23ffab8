//! The mutants of a package, as cargo-mutants lists them.

use serde::Deserialize;
use std::ops::Range;
use std::path::Path;
use std::process::Command;

/// One change of a source.
#[derive(Clone, Debug, Deserialize)]
pub struct Mutant {
    /// `file:line:column: what is changed`.
    pub name: String,
    /// Its source, from the root.
    pub file: String,
    /// What kind of change it is.
    pub genre: Genre,
    /// What stands in place of `span`.
    pub replacement: String,
    /// What is replaced.
    pub span: Span,
}

/// Kinds of changes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Genre {
    /// A function returns a constant.
    FnValue,
    /// Another binary operator.
    BinaryOperator,
    /// Without a unary operator.
    UnaryOperator,
    /// Without an arm of a `match`.
    MatchArm,
    /// Another guard of an arm.
    MatchArmGuard,
    /// A field is taken from the base of a struct expression.
    StructField,
}

/// Where a mutant begins and ends.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Span {
    /// The first character.
    pub start: Place,
    /// Behind the last one.
    pub end: Place,
}

/// A place in a source; both count from 1.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Place {
    /// Its line.
    pub line: usize,
    /// Its column, in characters.
    pub column: usize,
}

impl Mutant {
    /// Its name without its source, which may move.
    pub fn what(&self) -> &str {
        self.name.strip_prefix(&self.file).map_or(&*self.name, |what| &what[1..])
    }

    /// The bytes that it replaces.
    pub fn bytes(&self, source: &str) -> Range<usize> {
        let Span { start, end } = self.span;
        offset(source, start.line, start.column - 1)..offset(source, end.line, end.column - 1)
    }

    /// The source with this change alone.
    pub fn alone(&self, source: &str) -> String {
        let Range { start, end } = self.bytes(source);
        // As cargo-mutants does: a deleted operator leaves its neighbours apart.
        format!("{} {} {}", &source[..start], self.replacement, &source[end..])
    }
}

/// The byte at a line, from 1, and a column in characters, from 0.
pub fn offset(source: &str, line: usize, column: usize) -> usize {
    let before: usize = source.split_inclusive('\n').take(line - 1).map(str::len).sum();
    let rest = &source[before..];
    before + rest.char_indices().nth(column).map_or(rest.len(), |(byte, _)| byte)
}

/// All mutants of these sources of a package in a tree.
pub fn list(tree: &Path, package: &str, files: &[String]) -> Result<Vec<Mutant>, String> {
    let mut command = Command::new("cargo");
    command.args(["mutants", "--list", "--json", "--package", package]).current_dir(tree);
    for file in files {
        command.args(["--file", file]);
    }
    let output = command.output().map_err(|error| format!("cargo mutants: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("cargo mutants: {error}"))
}
