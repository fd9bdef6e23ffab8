//! Measures which changes of the libraries their tests notice; `tests/mutants` says how.

mod compile;
mod mutant;
mod outcomes;
mod remembered;
mod report;
mod suite;
mod syntax;
mod weave;

use mutant::Mutant;
use outcomes::{Outcomes, Row};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use suite::Verdict;

/// Where everything is.
struct Places {
    /// The sources as they are.
    root: PathBuf,
    /// A copy of them, of which every test of a package is one program.
    tree: PathBuf,
    /// What is known of each mutant.
    known: PathBuf,
    /// The table.
    table: PathBuf,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let result = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["chosen" | "again" | "rebuilt" | "known", root, work, ..] => {
            let places = places(Path::new(root), Path::new(work));
            measure(&places, &arguments[0], &arguments[3..])
        }
        ["report", root, work, ..] => {
            report::report(&places(Path::new(root), Path::new(work)), &arguments[3..])
        }
        _ => Err("mutation chosen|again|rebuilt|known|report ROOT WORK FILE...".into()),
    };
    if let Err(error) = result {
        eprintln!("{error}");
        std::process::exit(1);
    }
}

impl Places {
    /// Of this process: the mutants that tests reach.
    fn reached(&self) -> PathBuf {
        self.known.join(format!("reached.{}", std::process::id()))
    }
}

fn places(root: &Path, work: &Path) -> Places {
    Places {
        root: root.into(),
        tree: work.join("tree"),
        known: work.join("known"),
        table: root.join("tests/mutants.measured"),
    }
}

/// A source with its mutants.
struct Source {
    file: String,
    content: String,
    /// Their numbers in the list of the package.
    mutants: Vec<usize>,
    outcomes: Outcomes,
}

impl Source {
    fn save(&self, places: &Places) -> Result<(), String> {
        let row = Row::of(&self.file, &self.content, self.mutants.len(), &self.outcomes);
        eprintln!("{}: {:.1} % {:?}", self.file, row.percent(), row.counts);
        outcomes::put(&places.table, row)
    }
}

fn measure(places: &Places, how: &str, files: &[String]) -> Result<(), String> {
    fs::create_dir_all(&places.known).map_err(|error| error.to_string())?;
    for (package, tests) in [("firmware", "stimulator-tests"), ("vm-nostd", "model-tests")] {
        let of_package = |file: &&String| file.starts_with(&format!("{package}/"));
        let files: Vec<String> = files.iter().filter(of_package).cloned().collect();
        if !files.is_empty() {
            let list = mutant::list(&places.root, package, &files)?;
            let sources = sources(places, &files, &list)?;
            match how {
                "known" => sources.iter().try_for_each(|source| source.save(places))?,
                "rebuilt" => rebuilt(places, &[package, tests], &list, sources)?,
                _ => chosen(places, &[package, tests], &list, sources, how == "again")?,
            }
        }
    }
    Ok(())
}

fn sources(places: &Places, files: &[String], list: &[Mutant]) -> Result<Vec<Source>, String> {
    let source = |file: &String| {
        let content = outcomes::content(&places.root.join(file))?;
        let outcomes = Outcomes::read(&places.known, &content);
        let mutants = (0..list.len()).filter(|&number| list[number].file == *file).collect();
        Ok(Source { file: file.clone(), content, mutants, outcomes })
    };
    files.iter().map(source).collect()
}

/// All mutants that can be chosen at run time.
fn chosen(
    places: &Places,
    packages: &[&str],
    list: &[Mutant],
    sources: Vec<Source>,
    again: bool,
) -> Result<(), String> {
    let built = compile::woven(&places.root, &places.tree, &places.known, packages, list)?;
    let log = places.reached();
    let mut tests = suite::trace(&built.programs, &log)?;
    eprintln!(
        "{} mutants: {} unviable, {} not chosen at run time, {} reached by {} tests",
        list.len(),
        built.unviable.len(),
        built.apart.len(),
        suite::reached_by(&tests).len(),
        tests.len()
    );
    for mut source in sources {
        tests.iter_mut().for_each(|test| test.noticed = 0);
        for &number in &source.mutants {
            let what = list[number].what();
            let known = source.outcomes.of.get(what).map(|(outcome, _)| outcome.as_str());
            let skip = match known {
                None => false,
                Some("survived" | "unreached" | "apart") => !again,
                Some(_) => true,
            };
            if skip {
                continue;
            }
            if let Some(message) = built.unviable.get(&number) {
                source.outcomes.add(what, "unviable", message)?;
                continue;
            }
            if let Some(why) = built.apart.get(&number) {
                // One that was built for itself and survived is not forgotten.
                if known != Some("survived") {
                    source.outcomes.add(what, "apart", why)?;
                }
                continue;
            }
            let (outcome, detail) = match suite::chosen(&mut tests, number, &log)? {
                Verdict::Caught(by) => ("caught", by),
                Verdict::Timeout(of) => ("timeout", of),
                Verdict::Survived => {
                    ("survived", format!("{} ms of tests", suite::cost_ms(&tests, number)))
                }
                Verdict::Unreached => ("unreached", String::new()),
                Verdict::Starved(of) => {
                    eprintln!("no CPU for {of}: {}", list[number].name);
                    continue;
                }
            };
            source.outcomes.add(what, outcome, &detail)?;
            if !matches!(outcome, "caught" | "timeout") {
                eprintln!("{outcome}: {}", list[number].name);
            }
        }
        source.save(places)?;
    }
    Ok(())
}

/// Those that cannot be chosen at run time: a build each.
fn rebuilt(
    places: &Places,
    packages: &[&str],
    list: &[Mutant],
    sources: Vec<Source>,
) -> Result<(), String> {
    let programs = compile::plain(&places.tree, packages)?;
    let mut tests = suite::trace(&programs, &places.reached())?;
    for mut source in sources {
        tests.iter_mut().for_each(|test| test.noticed = 0);
        let path = places.root.join(&source.file);
        let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", source.file))?;
        let changed = places.tree.join(&source.file);
        for &number in &source.mutants {
            let what = list[number].what();
            match source.outcomes.of.get(what).map(|(outcome, _)| outcome.as_str()) {
                Some("apart") => {}
                _ => continue,
            }
            compile::write(&changed, &list[number].alone(&text))?;
            let verdict = built_alone(places, packages, &mut tests);
            compile::write(&changed, &text)?;
            let (outcome, detail) = match verdict? {
                None => ("unviable", String::new()),
                Some(Verdict::Caught(by)) => ("caught", by),
                Some(Verdict::Timeout(of)) => ("timeout", of),
                Some(Verdict::Survived | Verdict::Unreached) => {
                    ("survived", "built for itself".into())
                }
                Some(Verdict::Starved(of)) => {
                    eprintln!("no CPU for {of}: {}", list[number].name);
                    continue;
                }
            };
            eprintln!("{outcome}: {}", list[number].name);
            source.outcomes.add(what, outcome, &detail)?;
        }
        source.save(places)?;
    }
    Ok(())
}

/// What the tests make of the change that is in the tree; none, if it does not compile. First those
/// in the library, which are built and run much sooner.
fn built_alone(
    places: &Places,
    packages: &[&str],
    tests: &mut [suite::Test],
) -> Result<Option<Verdict>, String> {
    let Some(programs) = compile::changed_library(&places.tree, packages[0])? else {
        return Ok(None);
    };
    match suite::rebuilt(&programs, tests)? {
        Verdict::Survived => match compile::changed(&places.tree, packages)? {
            // It compiles, but not for the programs that use it.
            None => Ok(None),
            Some(programs) => suite::rebuilt(&programs, tests).map(Some),
        },
        verdict => Ok(Some(verdict)),
    }
}

/// The mutants of each source that no test notices, as they are listed with a reason.
fn listed(places: &Places) -> Result<BTreeMap<String, Vec<String>>, String> {
    let list = places.root.join("tests/mutants.survivors");
    let text = fs::read_to_string(&list).map_err(|error| format!("{}: {error}", list.display()))?;
    let mut listed: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (name, reason) = line.split_once(" -- ").unwrap_or((line, ""));
        if reason.len() < 10 {
            return Err(format!("{}: no reason: {line}", list.display()));
        }
        let (source, what) =
            name.split_once(": ").ok_or_else(|| format!("not a mutant: {name}"))?;
        listed.entry(source.into()).or_default().push(what.into());
    }
    Ok(listed)
}
