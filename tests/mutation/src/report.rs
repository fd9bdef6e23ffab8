//! What was measured, and whether the sources are still those.

use crate::outcomes::{self, Outcomes, Row};
use crate::{Places, listed};
use std::collections::BTreeMap;

/// Prints the table for these sources. An error: what is not measured or not listed.
pub fn report(places: &Places, files: &[String]) -> Result<(), String> {
    let rows = outcomes::read(&places.table)?;
    let listed = listed(places)?;
    let by_content: BTreeMap<&str, &Row> = rows.iter().map(|row| (&*row.content, row)).collect();
    let by_source: BTreeMap<&str, &Row> = rows.iter().map(|row| (&*row.source, row)).collect();
    println!(
        "{:<44} {:>7} {:>6} {:>7} {:>8} {:>8} {:>10} {:>6}",
        "source", "mutants", "caught", "timeout", "survived", "unviable", "unmeasured", "%"
    );
    let mut wrong = Vec::new();
    let mut sums = [0; 6];
    for file in files {
        let content = outcomes::content(&places.root.join(file))?;
        // A source that has only moved is still what was measured.
        let row = by_content.get(&*content).or_else(|| by_source.get(&**file)).copied();
        let Some(row) = row else {
            println!("{file:<44} not measured");
            wrong.push(format!("{file}: not measured"));
            continue;
        };
        let [mutants, caught, timeout, survived, unviable, unmeasured] = row.counts;
        let note = if row.content == content { "" } else { " stale" };
        println!(
            "{file:<44} {mutants:>7} {caught:>6} {timeout:>7} {survived:>8} {unviable:>8} \
             {unmeasured:>10} {:>6.1}{note}",
            row.percent()
        );
        for (sum, count) in sums.iter_mut().zip(row.counts) {
            *sum += count;
        }
        if row.content != content {
            wrong.push(format!("{file}: changed since {} was measured", row.content));
            continue;
        }
        let reasons = listed.get(&row.source).map_or(&[][..], Vec::as_slice);
        wrong.extend(unlisted(row, reasons, &Outcomes::read(&places.known, &content)));
    }
    let all = Row { source: "all".into(), content: String::new(), counts: sums };
    println!("all: {} mutants, {:.1} % caught", sums[0], all.percent());
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n")) }
}

/// What differs between the survivors of a source and those that are listed with a reason.
fn unlisted(row: &Row, listed: &[String], outcomes: &Outcomes) -> Vec<String> {
    let source = &row.source;
    let mut listed: Vec<&str> = listed.iter().map(String::as_str).collect();
    if outcomes.of.is_empty() {
        // Elsewhere than where it was measured, only the number is known.
        let (known, survived) = (listed.len(), row.counts[3]);
        let differs = known != survived;
        return Vec::from_iter(differs.then(|| format!("{source}: {known} of {survived} listed")));
    }
    let mut wrong = Vec::new();
    for (what, (outcome, _)) in &outcomes.of {
        if matches!(&**outcome, "survived" | "unreached") {
            // Without its place, which moves.
            let what = what.splitn(3, ':').nth(2).unwrap_or(what).trim();
            match listed.iter().position(|listed| *listed == what) {
                Some(place) => drop(listed.remove(place)),
                None => wrong.push(format!("{source}: {what} is not listed")),
            }
        }
    }
    wrong.extend(listed.iter().map(|what| format!("{source}: {what} is not a survivor any more")));
    wrong
}

#[cfg(test)]
mod tests {
    use super::report;
    use crate::outcomes::{self, Outcomes, Row};
    use crate::{Places, listed, places};
    use std::fs;
    use std::path::Path;

    /// A folder as of a clone, with a source and what was measured of it: one mutant caught, one
    /// not, and one not measured.
    fn clone_of(name: &str) -> Places {
        let root = std::env::temp_dir().join(format!("report-{name}-{}", std::process::id()));
        fs::create_dir_all(root.join("tests")).expect("a folder");
        fs::write(root.join("a.rs"), "fn a() {}\n").expect("a source");
        let content = outcomes::content(&root.join("a.rs")).expect("its content");
        let known = places(&root, &root.join("known"));
        fs::create_dir_all(&known.known).expect("a folder");
        let mut of = Outcomes::read(&known.known, &content);
        of.add("1:1: replace a with ()", "caught", "a_test").expect("a file");
        of.add("2:1: replace b with ()", "survived", "").expect("a file");
        outcomes::put(&known.table, Row::of("a.rs", &content, 3, &of)).expect("a table");
        let list = "a.rs: replace b with () -- it is never called\n";
        fs::write(root.join("tests/mutants.survivors"), list).expect("a list");
        // Nothing else is known where it was not measured.
        places(&root, &root.join("elsewhere"))
    }

    #[test]
    fn a_clone_reports_what_was_measured_until_a_source_changes() {
        let clone = clone_of("stale");
        let files = ["a.rs".to_owned()];
        assert_eq!(report(&clone, &files), Ok(()));
        fs::write(clone.root.join("a.rs"), "fn a() { a() }\n").expect("a source");
        let error = report(&clone, &files).expect_err("it is stale");
        assert!(error.starts_with("a.rs: changed since "), "{error}");
        let error = report(&clone, &["b.rs".to_owned()]).expect_err("there is none");
        assert!(error.contains("b.rs"), "{error}");
        fs::remove_dir_all(clone.root).expect("its folder");
    }

    #[test]
    fn a_survivor_without_a_reason_is_reported() {
        let clone = clone_of("unlisted");
        fs::write(clone.root.join("tests/mutants.survivors"), "").expect("a list");
        let files = ["a.rs".to_owned()];
        assert_eq!(report(&clone, &files), Err("a.rs: 0 of 1 listed".to_owned()));
        let measured = places(&clone.root, &clone.root.join("known"));
        let error = report(&measured, &files).expect_err("it is not listed");
        assert_eq!(error, "a.rs: replace b with () is not listed");
        fs::remove_dir_all(clone.root).expect("its folder");
    }

    /// The table of this repository, whatever its sources are now.
    #[test]
    fn every_survivor_of_the_table_is_listed_with_a_reason() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let places = places(&root, &root.join("target/mutants"));
        let rows = outcomes::read(&places.table).expect("a table");
        assert!(!rows.is_empty(), "tests/mutants.measured");
        let mut listed = listed(&places).expect("a list");
        for Row { source, counts: [mutants, counts @ ..], .. } in &rows {
            assert_eq!(*mutants, counts.iter().sum::<usize>(), "{source}");
            let [_, _, survived, ..] = counts;
            let reasons = listed.remove(source).unwrap_or_default();
            assert_eq!(reasons.len(), *survived, "{source}: {reasons:?}");
        }
        assert!(listed.is_empty(), "of sources that were not measured: {listed:?}");
    }
}
