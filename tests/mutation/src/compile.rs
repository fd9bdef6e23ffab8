//! Builds a package's tests with all mutants in them, leaving out those that do not compile.

use crate::mutant::Mutant;
use crate::remembered::Remembered;
use crate::weave::{Woven, weave};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The most builds until the rest compiles.
const MOST_BUILDS: usize = 25;

/// What the compiler does not refuse in a mutant.
const LINTS: &str = "#![allow(warnings, arithmetic_overflow, unconditional_panic)]\n";

/// A program of tests.
#[derive(Clone, Debug)]
pub struct Program {
    /// The executable.
    pub path: PathBuf,
    /// The folder of its package, where it runs.
    pub folder: PathBuf,
}

impl Program {
    /// Its folder and name, without what tells builds apart.
    pub fn name(&self) -> (&Path, &str) {
        let name = self.path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        (&self.folder, name.rsplit_once('-').map_or(name, |(name, _)| name))
    }
}

/// What was built.
#[derive(Debug, Default)]
pub struct Built {
    /// All programs of tests.
    pub programs: Vec<Program>,
    /// Mutants that the compiler refuses, with what it says.
    pub unviable: BTreeMap<usize, String>,
    /// Mutants that cannot be chosen at run time, and why.
    pub apart: BTreeMap<usize, String>,
}

/// One error of the compiler.
struct Complaint {
    message: String,
    code: String,
    /// File from the root, bytes, and whether this is where it complains.
    spans: Vec<(String, usize, usize, bool)>,
}

/// All tests of a package: those in its library, and the one program of all others.
const ALL: [&str; 3] = ["--lib", "--test", "together"];

/// Builds these tests of these packages in the tree.
fn build(
    tree: &Path,
    packages: &[&str],
    tests: &[&str],
) -> Result<(Vec<Program>, Vec<Complaint>, String), String> {
    let mut command = Command::new("cargo");
    command.args(["test", "--no-run", "--release", "--message-format", "json"]);
    command.args(tests).current_dir(tree).stderr(Stdio::piped());
    for package in packages {
        command.args(["--package", package]);
    }
    // As they are tested elsewhere, but built sooner.
    for package in ["firmware", "stimulator-tests", "model-tests", "vm-nostd"] {
        for setting in ["opt-level=1", "debug=0"] {
            command.args(["--config", &format!("profile.release.package.{package}.{setting}")]);
        }
    }
    let output = command.output().map_err(|error| format!("cargo test: {error}"))?;
    let (mut programs, mut complaints) = (Vec::new(), Vec::new());
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(value) = serde_json::from_str::<Value>(line) else { continue };
        if let Some(path) =
            value["executable"].as_str().filter(|_| value["profile"]["test"] == true)
        {
            let manifest = value["manifest_path"].as_str().unwrap_or_default();
            let folder = Path::new(manifest).parent().unwrap_or(tree).to_owned();
            programs.push(Program { path: path.into(), folder });
        }
        let message = &value["message"];
        if value["reason"] == "compiler-message" && message["level"] == "error" {
            complaints.push(complaint(message));
        }
    }
    if output.status.success() {
        complaints.clear();
    }
    Ok((programs, complaints, String::from_utf8_lossy(&output.stderr).into_owned()))
}

fn complaint(message: &Value) -> Complaint {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let number = |value: &Value| value.as_u64().unwrap_or_default() as usize;
    let spans = message["spans"].as_array().into_iter().flatten().map(|span| {
        let (start, end) = (number(&span["byte_start"]), number(&span["byte_end"]));
        (text(&span["file_name"]), start, end, span["is_primary"] == true)
    });
    Complaint {
        spans: spans.collect(),
        message: text(&message["message"]),
        code: text(&message["code"]["code"]),
    }
}

/// The function that the compiler has to evaluate and may not.
fn evaluated(complaint: &Complaint) -> Option<String> {
    let named = complaint.message.split('`').nth(1).filter(|_| complaint.code == "E0015")?;
    // Without what it is generic over.
    let (mut depth, mut plain) = (0, String::new());
    for c in named.chars() {
        match c {
            '<' => depth += 1,
            '>' => depth -= 1,
            c if depth == 0 => plain.push(c),
            _ => {}
        }
    }
    plain.rsplit("::").find(|part| !part.is_empty()).map(str::to_owned)
}

/// Writes a file, unless it is there already: what is older than its program is not built again.
pub fn write(path: &Path, text: &str) -> Result<(), String> {
    if fs::read_to_string(path).is_ok_and(|there| there == text) {
        return Ok(());
    }
    fs::write(path, text).map_err(|error| format!("{}: {error}", path.display()))
}

/// The tests without a change.
pub fn plain(tree: &Path, packages: &[&str]) -> Result<Vec<Program>, String> {
    let (programs, complaints, log) = build(tree, packages, &ALL)?;
    if !complaints.is_empty() || programs.is_empty() {
        return Err(format!("does not build without a change:\n{log}"));
    }
    Ok(programs)
}

/// The tests in the library of a package, or none if it does not build.
pub fn changed_library(tree: &Path, package: &str) -> Result<Option<Vec<Program>>, String> {
    viable(build(tree, &[package], &["--lib"])?)
}

/// All tests of these packages, or none if they do not build.
pub fn changed(tree: &Path, packages: &[&str]) -> Result<Option<Vec<Program>>, String> {
    viable(build(tree, packages, &ALL)?)
}

/// Only what the compiler refuses is no Rust.
fn viable(
    (programs, complaints, log): (Vec<Program>, Vec<Complaint>, String),
) -> Result<Option<Vec<Program>>, String> {
    match (programs.is_empty(), complaints.is_empty()) {
        (_, false) => Ok(None),
        (false, true) => Ok(Some(programs)),
        (true, true) => Err(format!("no programs:\n{log}")),
    }
}

/// The tests with all mutants. `root` has the sources as they are, `tree` is a copy; in `known` is
/// what builds before have found out.
pub fn woven(
    root: &Path,
    tree: &Path,
    known: &Path,
    packages: &[&str],
    mutants: &[Mutant],
) -> Result<Built, String> {
    let read = |file: &str| {
        fs::read_to_string(root.join(file)).map_err(|error| format!("{file}: {error}"))
    };
    let library = format!("{}/src", packages[0]);
    write(&tree.join(&library).join("woven.rs"), include_str!("woven.rs"))?;
    let mut files: BTreeSet<String> = mutants.iter().map(|mutant| mutant.file.clone()).collect();
    // Functions that lose their `const` are called from anywhere in the package.
    files.insert(format!("{library}/lib.rs"));
    let texts = files.iter().map(|file| read(file)).collect::<Result<Vec<_>, _>>()?;
    let memory = Remembered::file(known, mutants, &texts)?;
    let Remembered { mut unviable, mut apart, mut constant } = Remembered::read(&memory);
    for count in 1..=MOST_BUILDS {
        let mut texts: BTreeMap<&str, Woven> = BTreeMap::new();
        let left_out: HashSet<usize> = unviable.keys().chain(apart.keys()).copied().collect();
        for file in &files {
            let of_file = mutants.iter().enumerate().filter(|(_, mutant)| mutant.file == *file);
            let of_file: Vec<_> = of_file.collect();
            let mut text = weave(&read(file)?, &of_file, &left_out, &constant)
                .map_err(|error| format!("{file}: {error}"))?;
            if file.ends_with("/lib.rs") {
                // What a mutant leaves unused or lets overflow is no error.
                text.text.insert_str(0, LINTS);
                text.places.iter_mut().for_each(|place| {
                    place.bytes.start += LINTS.len();
                    place.bytes.end += LINTS.len();
                });
                text.text.push_str("\nmod woven;\n");
            }
            write(&tree.join(file), &text.text)?;
            texts.insert(file, text);
        }
        let (programs, complaints, log) = build(tree, packages, &ALL)?;
        if complaints.is_empty() {
            if programs.is_empty() {
                return Err(format!("no programs:\n{log}"));
            }
            for woven in texts.into_values() {
                apart.extend(woven.apart);
                unviable.extend(woven.unviable);
            }
            return Ok(Built { programs, unviable, apart });
        }
        let before = (left_out.len(), constant.len());
        for complaint in &complaints {
            if let Some(function) = evaluated(complaint) {
                constant.insert(function);
                continue;
            }
            let Some((mutants, is_replacement)) = blamed(complaint, &texts) else { continue };
            for mutant in mutants {
                if is_replacement {
                    unviable.insert(mutant, complaint.message.clone());
                } else {
                    apart.insert(mutant, format!("does not weave: {}", complaint.message));
                }
            }
        }
        let now =
            (unviable.keys().chain(apart.keys()).collect::<HashSet<_>>().len(), constant.len());
        eprintln!(
            "build {count}: {} errors; {} mutants left out, {} functions evaluated",
            complaints.len(),
            now.0,
            now.1
        );
        if before == now {
            let all = complaints.iter().map(|c| format!("{} {:?}", c.message, c.spans));
            let all: Vec<String> = all.collect();
            return Err(format!("no mutant is to blame for:\n{}\n{log}", all.join("\n")));
        }
        let remembered = Remembered { unviable, apart, constant };
        remembered.write(&memory)?;
        Remembered { unviable, apart, constant } = remembered;
    }
    Err(format!("does not compile after {MOST_BUILDS} builds"))
}

/// The mutants that an error is about; and whether it is about what one puts in place.
fn blamed(complaint: &Complaint, texts: &BTreeMap<&str, Woven>) -> Option<(Vec<usize>, bool)> {
    let mut spans: Vec<_> = complaint.spans.iter().collect();
    spans.sort_by_key(|(.., is_primary)| !is_primary);
    let innermost = |replacements: bool| {
        spans.iter().find_map(|(file, start, end, _)| {
            let places = &texts.get(&**file)?.places;
            let within = places.iter().filter(|place| {
                place.is_replacement == replacements
                    && place.bytes.start <= *start
                    && *end <= place.bytes.end
            });
            let place = within.min_by_key(|place| place.bytes.len())?;
            Some((place.mutants.clone(), replacements))
        })
    };
    innermost(true).or_else(|| innermost(false))
}
