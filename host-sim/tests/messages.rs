//! What `vm` says of wrong input, what it ignores, and what it writes where.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");
const INPUT: &str = "t_s,activation,path_length_m,stim_hz\n0,0,0.16,40\n0.001,0.5,0.16,40\n\
                     0.002,0.5,0.16,40\n";

/// A folder with a muscle `m.toml` and inputs `in.csv`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.toml"), MUSCLE).expect("a muscle");
    fs::write(folder.path().join("in.csv"), INPUT).expect("inputs");
    folder
}

fn vm(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm"))
        .current_dir(folder)
        .args(arguments.split_whitespace())
        .output()
        .expect("vm runs")
}

/// Standard output and standard error of a command that succeeds.
fn done(folder: &Path, arguments: &str) -> (String, String) {
    let output = vm(folder, arguments);
    let [out, err] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{arguments}: {err}");
    (out, err)
}

/// Asserts exit code 2 and a message with all of `words`.
fn refused(folder: &Path, arguments: &str, words: &[&str]) {
    let output = vm(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments}: no \"{word}\" in: {message}");
    }
}

#[test]
fn a_format_other_than_the_ending_says_is_refused() {
    let folder = folder();
    for (command, format) in [
        ("run --muscle m.toml --input in.csv", "CSV"),
        ("hil --muscle m.toml --input in.csv", "CSV"),
        ("sweep --vary tick_ms=2", "CSV"),
        ("arm --duration 0.01", "CSV"),
        ("recover --patients 1", "CSV"),
        ("fit --muscle m.toml --trials t.toml", "TOML"),
        ("report", "HTML"),
        ("plot --run in.csv", "SVG"),
    ] {
        for option in ["--output", "--out"] {
            let arguments = format!("{command} {option} x.png");
            refused(folder.path(), &arguments, &["--output x.png: only", format]);
        }
    }
    assert!(!folder.path().join("x.png").exists());
}

/// Every command that writes a file or folder takes both names.
#[test]
fn output_is_named_alike_everywhere() {
    for command in
        ["run", "plot", "hil", "sweep", "arm", "recover", "fit", "protocol", "report", "figures"]
    {
        let (help, _) = done(folder().path(), &format!("{command} --help"));
        assert!(help.contains("--output <"), "{command}: {help}");
        assert!(help.contains(": --out]"), "{command}: {help}");
    }
    let folder = folder();
    for option in ["--output", "--out"] {
        let file = format!("{}.csv", option.trim_start_matches('-'));
        done(folder.path(), &format!("run --muscle m.toml --input in.csv {option} {file}"));
        assert!(folder.path().join(file).is_file());
        let to = format!("protocol-of{option}");
        done(folder.path(), &format!("protocol --mode fes {option} {to}"));
        assert!(folder.path().join(to).join("trials.toml").is_file());
    }
}

#[test]
fn what_writes_to_the_sources_says_to_which() {
    let folder = folder();
    for command in ["golden", "readme", "cycles", "stack", "recover", "measured"] {
        let (help, _) = done(folder.path(), &format!("{command} --help"));
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains("checkout that this program was built in"), "{command}: {help}");
    }
}

#[test]
fn an_ignored_stimulation_frequency_is_reported() {
    let folder = folder();
    let said = "stim_hz is ignored in mode continuous; --mode fes uses it";
    let (_, err) = done(folder.path(), "run --muscle m.toml --input in.csv");
    assert!(err.contains(said), "{err}");
    let (_, err) = done(folder.path(), "run --muscle m.toml --input in.csv --mode fes");
    assert!(!err.contains("ignored"), "{err}");
    fs::write(folder.path().join("in.csv"), INPUT.replace(",40", ",0")).expect("inputs");
    let (_, err) = done(folder.path(), "run --muscle m.toml --input in.csv");
    assert!(!err.contains("ignored"), "{err}");
}

#[test]
fn a_time_step_is_refused_by_the_name_and_unit_it_was_given_in() {
    let folder = folder();
    refused(folder.path(), "arm --tick 7", &["--tick 7: must be 0.1 to 2 ms"]);
}

#[test]
fn a_plot_and_a_protocol_say_what_they_wrote() {
    let folder = folder();
    done(folder.path(), "run --muscle m.toml --input in.csv");
    let (out, _) = done(folder.path(), "plot");
    assert!(out.contains("run.svg written: 3 rows of run.csv in 3 panels"), "{out}");
    let (out, _) = done(folder.path(), "plot --input in.csv");
    assert!(out.contains("run.svg replaced: 3 rows of run.csv in 6 panels"), "{out}");

    let (out, _) = done(folder.path(), "protocol --mode fes --output p");
    assert!(out.contains("trials.toml written in p") && !out.contains("left out"), "{out}");
    // This muscle has no table [fatigue].
    let (out, _) = done(folder.path(), "protocol --muscle m.toml --mode fes --output p");
    assert!(out.contains("trials.toml replaced in p"), "{out}");
    assert!(out.contains("left out: the recording \"fatigue\""), "{out}");
    assert!(out.contains("the muscle has no table [fatigue]"), "{out}");
}

#[test]
fn folders_of_recordings_that_are_none_are_named_or_skipped() {
    let folder = folder();
    refused(folder.path(), "measured --data nowhere", &["--data nowhere: no such folder"]);
    for set in ["sets/.tmp1", "sets/half"] {
        fs::create_dir_all(folder.path().join(set)).expect("a folder");
        fs::write(folder.path().join(set).join("trials.toml"), "").expect("a list");
    }
    let output = vm(folder.path(), "measured --data sets");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("SKIPPED half: no muscle.toml in sets/half"), "{message}");
    assert!(!message.contains(".tmp1"), "{message}");
    assert!(output.stdout.is_empty(), "no empty tables");
}

/// Each muscle can be run on the paths that the table gives.
#[test]
fn named_muscles_have_their_paths() {
    let folder = folder();
    let (out, _) = done(folder.path(), "muscles");
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let header = cells(out.lines().next().expect("a header"));
    let column = |name: &str| header.iter().position(|cell| cell == name).expect("a column");
    let columns = ["path from m", "neutral path m", "path to m"].map(column);
    let soleus = cells(out.lines().find(|line| line.starts_with("| soleus")).expect("a row"));
    let paths = columns.map(|at| soleus[at].parse::<f64>().expect("a number"));
    assert!(paths.is_sorted(), "{paths:?}");
    let run = |path: f64| {
        let text =
            format!("t_s,activation,path_length_m,stim_hz\n0,0,{path},0\n0.001,0,{path},0\n");
        fs::write(folder.path().join("in.csv"), text).expect("inputs");
        vm(folder.path(), "run --muscle soleus --input in.csv")
    };
    // Printed to 0.1 mm.
    for path in [paths[0] + 1e-4, paths[1], paths[2] - 1e-4] {
        assert!(run(path).status.success(), "{path}");
    }
    for path in [paths[0] - 1e-4, paths[2] + 1e-4] {
        let output = run(path);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{path}");
        assert!(message.contains("the shortest and the longest on which it can rest"), "{message}");
    }
}

#[test]
fn a_table_of_another_sweep_is_refused_with_a_remedy() {
    let folder = folder();
    done(folder.path(), "sweep --vary tick_ms=2 --modes fes");
    let remedy = "give --output another file, or remove sweep.csv";
    refused(folder.path(), "sweep --vary tick_ms=1 --modes fes", &[remedy]);
}
