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
