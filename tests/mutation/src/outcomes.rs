//! What is known of the mutants of a source, by its content.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The columns of the table of what was measured.
pub const COLUMNS: &str = "source,content,mutants,caught,timeout,survived,unviable,unmeasured";

/// The content of a file, as git names it.
pub fn content(file: &Path) -> Result<String, String> {
    let output = Command::new("git")
        .arg("hash-object")
        .arg(file)
        .output()
        .map_err(|error| format!("git hash-object: {error}"))?;
    let hash = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    if hash.len() < 12 {
        Err(format!("{}: no content", file.display()))
    } else {
        Ok(hash[..12].into())
    }
}

/// The outcomes of the mutants of one source: a word each, and what there is to say of it.
#[derive(Debug)]
pub struct Outcomes {
    file: PathBuf,
    /// By the mutant's name without its source.
    pub of: BTreeMap<String, (String, String)>,
}

impl Outcomes {
    /// Those that are known of a content.
    pub fn read(folder: &Path, content: &str) -> Self {
        let file = folder.join(format!("{content}.outcomes"));
        let text = fs::read_to_string(&file).unwrap_or_default();
        let of = text.lines().filter_map(|line| {
            let mut parts = line.splitn(3, '\t').map(str::to_owned);
            Some((parts.next()?, (parts.next()?, parts.next()?)))
        });
        Self { of: of.collect(), file }
    }

    /// One more, at once: what is interrupted goes on from here.
    pub fn add(&mut self, what: &str, outcome: &str, detail: &str) -> Result<(), String> {
        let detail = detail.lines().next().unwrap_or_default();
        let say = |error| format!("{}: {error}", self.file.display());
        let mut file =
            fs::OpenOptions::new().append(true).create(true).open(&self.file).map_err(say)?;
        writeln!(file, "{what}\t{outcome}\t{detail}").map_err(say)?;
        self.of.insert(what.into(), (outcome.into(), detail.into()));
        Ok(())
    }

    /// How many have this outcome.
    pub fn count(&self, outcome: &str) -> usize {
        self.of.values().filter(|(of, _)| of == outcome).count()
    }
}

/// A row of the table of what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The source, from the root.
    pub source: String,
    /// Its content when it was measured.
    pub content: String,
    /// All mutants; those caught, those whose tests did not end, those that no test noticed, those
    /// that do not compile, and those that were not measured.
    pub counts: [usize; 6],
}

impl Row {
    /// What is known of a source.
    pub fn of(source: &str, content: &str, mutants: usize, outcomes: &Outcomes) -> Self {
        let [caught, timeout, unviable] =
            ["caught", "timeout", "unviable"].map(|outcome| outcomes.count(outcome));
        let survived = outcomes.count("survived") + outcomes.count("unreached");
        let unmeasured = mutants - caught - timeout - unviable - survived;
        let counts = [mutants, caught, timeout, survived, unviable, unmeasured];
        Self { source: source.into(), content: content.into(), counts }
    }

    fn parse(line: &str) -> Option<Self> {
        let mut parts = line.split(',');
        let (source, content) = (parts.next()?.into(), parts.next()?.into());
        let mut counts = [0; 6];
        for count in &mut counts {
            *count = parts.next()?.parse().ok()?;
        }
        Some(Self { source, content, counts })
    }

    /// Caught of those that compile, in %; what was not measured counts as not caught. All of none.
    pub fn percent(&self) -> f64 {
        let [mutants, caught, timeout, _, unviable, _] = self.counts;
        match mutants - unviable {
            0 => 100.0,
            all => 100.0 * (caught + timeout) as f64 / all as f64,
        }
    }
}

/// Reads the table.
pub fn read(table: &Path) -> Result<Vec<Row>, String> {
    let text = fs::read_to_string(table).unwrap_or_else(|_| format!("{COLUMNS}\n"));
    let mut lines = text.lines();
    if lines.next() != Some(COLUMNS) {
        return Err(format!("{}: the columns are not {COLUMNS}", table.display()));
    }
    lines.map(|line| Row::parse(line).ok_or_else(|| format!("not a row: {line}"))).collect()
}

/// Puts a row into the table, in place of what was known of that source.
pub fn put(table: &Path, row: Row) -> Result<(), String> {
    let mut rows = read(table)?;
    rows.retain(|old| old.source != row.source);
    rows.push(row);
    rows.sort_by(|a, b| a.source.cmp(&b.source));
    let mut text = format!("{COLUMNS}\n");
    for Row { source, content, counts } in rows {
        let counts = counts.map(|count| count.to_string()).join(",");
        text.push_str(&format!("{source},{content},{counts}\n"));
    }
    fs::write(table, text).map_err(|error| format!("{}: {error}", table.display()))
}
