//! The main job, `vm` without a command, ends with six lines: the worst scenario of each mode and
//! arithmetic.

use std::process::Command;

#[test]
fn the_main_job_ends_with_six_lines_of_worst_scenarios() {
    let output = Command::new(env!("CARGO_BIN_EXE_vm")).output().expect("vm runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let lines: Vec<&str> = text.lines().collect();
    // A heading, and the six lines.
    assert_eq!(lines.len(), 7, "{text}");
    let table = include_str!("../data/tolerances.csv");
    let count = format!("{} comparisons in ", table.lines().count() - 1);
    assert!(lines[0].starts_with(&count) && lines[0].contains("--all"), "{text}");
    let mut pairs = Vec::new();
    for line in &lines[1..] {
        assert!(line.chars().count() <= 80, "{line}");
        let words: Vec<&str> = line.split_whitespace().collect();
        let [mode, arithmetic, scenario, error, "of", limit, "%", "pass", seconds, "s"] = words[..]
        else {
            panic!("{line}")
        };
        pairs.push((mode, arithmetic));
        let number = |text: &str| text.parse::<f64>().expect(line);
        let (error, limit) = (number(error), number(limit));
        assert!(error <= limit && number(seconds) > 0.0, "{line}");
        // The limit is that of the table of tolerances.
        let of_pair = |row: &&str| {
            let cells: Vec<&str> = row.split(',').collect();
            cells[1].starts_with(mode) && cells[2] == arithmetic && cells[3] == "reference"
        };
        let named = |row: &&str| row.starts_with(&format!("{scenario},"));
        let row = table.lines().filter(of_pair).find(named).expect("a row of the table");
        assert_eq!(number(row.split(',').nth(4).expect("a limit")), limit, "{line}");
        // A limit is at most twice the error, so the largest error is at least half of the largest
        // limit.
        let largest = table
            .lines()
            .filter(of_pair)
            .filter(|row| !row.contains('@'))
            .map(|row| number(row.split(',').nth(4).expect("a limit")))
            .fold(0.0, f64::max);
        assert!(error >= largest / 2.0, "{line}: another scenario's error is at least {largest}/2");
    }
    let expected = ["continuous", "fes", "discrete"].map(|mode| [(mode, "f32"), (mode, "fixed")]);
    assert_eq!(pairs, expected.concat());
}
