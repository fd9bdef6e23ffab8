//! `vm run`: summary, defaults and pipes.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");
/// One tick with an activation above 1, two with a path beyond the validity range.
const INPUT: &str = "t_s,activation,path_length_m,stim_hz\n0,0,0.16,0\n0.001,1.5,0.16,0\n\
                     0.002,0.5,0.3,0\n0.003,0.5,0.3,0\n0.004,0.5,0.16,0\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.toml"), MUSCLE).expect("a muscle");
    fs::write(folder.path().join("in.csv"), INPUT).expect("inputs");
    folder
}

fn vm(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vm"));
    command.current_dir(folder).args(arguments.split_whitespace());
    command
}

fn done(folder: &Path, arguments: &str) -> Output {
    let output = vm(folder, arguments).output().expect("vm runs");
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

#[test]
fn a_run_prints_peak_force_length_range_and_flagged_ticks_to_standard_error() {
    let folder = folder();
    let output = done(folder.path(), "run --muscle m.toml --input in.csv --output out.csv");
    assert!(output.stdout.is_empty());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let text = fs::read_to_string(folder.path().join("out.csv")).expect("an output");
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let column =
        |index: usize| rows.iter().map(move |row| row[index].parse::<f64>().expect("a number"));
    let peak = column(1).fold(f64::NEG_INFINITY, f64::max);
    let (least, most) = column(2).fold((f64::INFINITY, 0.0_f64), |(a, b), l| (a.min(l), b.max(l)));
    let time = rows.iter().find(|row| row[1].parse() == Ok(peak)).expect("a row")[0];
    for words in [
        "4 ticks, continuous, f32".to_owned(),
        format!("peak force {peak:.3} N at {time} s"),
        format!("fascicle length {least:.4} to {most:.4} L_ce0"),
        "ACTIVATION_CLIPPED 1 of 4 ticks".to_owned(),
        "PATH_LENGTH_CLIPPED 2 of 4 ticks".to_owned(),
        "out.csv".to_owned(),
    ] {
        assert!(said.contains(&words), "no \"{words}\" in: {said}");
    }
    // The summary also states that no tick was flagged, and that the reference has no flags.
    let calm = INPUT.replace("1.5", "1").replace("0.3", "0.16");
    fs::write(folder.path().join("in.csv"), calm).expect("inputs");
    let output = done(folder.path(), "run --muscle m.toml --input in.csv");
    assert!(String::from_utf8_lossy(&output.stderr).contains("no tick flagged"));
    let output = done(folder.path(), "run --muscle m.toml --input in.csv --arithmetic reference");
    assert!(String::from_utf8_lossy(&output.stderr).contains("the reference checks nothing"));
}

/// Outputs and summary of a run of a muscle file with a line more, and with options.
fn run_of(line: &str, options: &str) -> (String, String) {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), format!("{line}\n{MUSCLE}")).expect("a muscle");
    let arguments = format!("run --muscle m.toml --input in.csv --output out.csv {options}");
    let told = done(folder.path(), &arguments).stderr;
    let rows = fs::read_to_string(folder.path().join("out.csv")).expect("an output");
    (rows, String::from_utf8_lossy(&told).into_owned())
}

#[test]
fn the_class_is_the_files_or_the_command_lines() {
    let (standard, told) = run_of("", "");
    assert!(told.contains("f32: peak force"), "{told}");
    let (fine, told) = run_of("class = \"fine\"", "");
    assert!(told.contains("f32, fine class: peak force"), "{told}");
    assert_ne!(standard, fine);
    assert_eq!(run_of("", "--class fine").0, fine);
    assert_eq!(run_of("class = \"fine\"", "--class standard").0, standard);
}

#[test]
fn mode_arithmetic_and_output_have_defaults() {
    let folder = folder();
    done(folder.path(), "run --muscle m.toml --input in.csv");
    let explicit =
        "run --muscle m.toml --input in.csv --mode continuous --arithmetic f32 --output b.csv";
    done(folder.path(), explicit);
    let read = |name: &str| fs::read(folder.path().join(name)).expect(name);
    assert!(read("run.csv") == read("b.csv"));
}

#[test]
fn a_dash_means_standard_input_or_output() {
    let folder = folder();
    done(folder.path(), "run --muscle m.toml --input in.csv --output out.csv");
    let mut child = vm(folder.path(), "run --muscle m.toml --input - --output -")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("vm runs");
    child.stdin.take().expect("a pipe").write_all(INPUT.as_bytes()).expect("inputs");
    let output = child.wait_with_output().expect("vm ends");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout == fs::read(folder.path().join("out.csv")).expect("an output"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("peak force"));
    assert!(!folder.path().join("-").exists());
    // Error messages call it standard input.
    let mut child = vm(folder.path(), "run --muscle m.toml --input - --output -")
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("vm runs");
    child.stdin.take().expect("a pipe").write_all(b"t_s\n0\n").expect("inputs");
    let output = child.wait_with_output().expect("vm ends");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("standard input, line 1, column activation"), "{message}");
    // A plot can be piped as well.
    let plot = done(folder.path(), "plot --run out.csv --input in.csv --output -");
    assert!(String::from_utf8_lossy(&plot.stdout).starts_with("<svg"));
}

/// As `vm ... | head -1`: a closed pipe is no error.
#[cfg(unix)]
#[test]
fn a_broken_pipe_is_silent() {
    let folder = folder();
    // More than the capacity of a pipe.
    let row = |tick: usize| format!("{},0.5,0.16,0\n", tick as f64 * 1e-3);
    let long: String = (0..20_000).map(row).collect();
    let header = "t_s,activation,path_length_m,stim_hz\n";
    fs::write(folder.path().join("in.csv"), format!("{header}{long}")).expect("inputs");
    for arguments in [
        "run --muscle m.toml --input in.csv --output -",
        "run --muscle m.toml --input in.csv --output /dev/stdout",
        "muscles",
        "sweep --vary tick_ms=2 --output sweep.csv",
    ] {
        let mut child = vm(folder.path(), arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("vm runs");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("vm ends");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments}: {message}");
        assert!(!message.contains("pipe") && !message.contains("panic"), "{arguments}: {message}");
    }
}

#[test]
fn pictures_other_than_svg_and_pages_other_than_html_are_refused() {
    let folder = folder();
    done(folder.path(), "run --muscle m.toml --input in.csv");
    for (arguments, words) in [
        ("plot --run run.csv --output run.png", ["--output run.png", "SVG", ".svg"]),
        ("plot --run run.csv --output run.PDF", ["--output run.PDF", "SVG", ".svg"]),
        ("report --out report.pdf", ["--output report.pdf", "HTML", ".html"]),
    ] {
        let output = vm(folder.path(), arguments).output().expect("vm runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        for word in words {
            assert!(message.contains(word), "no \"{word}\" in: {message}");
        }
    }
    // The default output has the name of the plotted file.
    done(folder.path(), "plot --run run.csv");
    assert!(folder.path().join("run.svg").exists());
    assert!(!folder.path().join("run.png").exists());
}

/// If no temporary file can be created, the error names the folder and no random name.
#[cfg(unix)]
#[test]
fn errors_do_not_name_temporary_files() {
    let folder = folder();
    for arguments in [
        "cycles --case continuous-f32 --tick 0",
        "cycles --elf m.toml --symbol main",
        "run --muscle m.toml --input in.csv --output nowhere/out.csv",
    ] {
        let output =
            vm(folder.path(), arguments).env("TMPDIR", "/nowhere").output().expect("vm runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(!message.contains(".tmp"), "{arguments}: {message}");
    }
}

/// Default output files of all commands are ignored by git.
#[test]
fn default_outputs_are_ignored_by_git() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let ignored = fs::read_to_string(root.join(".gitignore")).expect("a list");
    for (command, default) in [
        ("run", "run.csv"),
        ("plot", "run.svg"),
        ("hil", "hil.csv"),
        ("sweep", "sweep.csv"),
        ("report", "report.html"),
        ("figures", "figures"),
        ("fit", "fitted.toml"),
    ] {
        let output = vm(&root, &format!("{command} --help")).output().expect("vm runs");
        let help = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(help.contains(&format!("[default: {default}]")), "{command}: {help}");
        let line = |line: &str| line.trim_end_matches('/') == format!("/{default}");
        assert!(ignored.lines().any(line), "{default} is not in .gitignore");
    }
}

#[test]
fn help_lists_the_keys_of_sweep_and_the_modes_of_hil() {
    let folder = folder();
    let help = |command: &str| {
        let output = done(folder.path(), &format!("{command} --help"));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let sweep = help("sweep");
    for key in host_sim::sweep::KEYS {
        let line = sweep.lines().find(|line| line.trim_start().starts_with(key.name));
        let line = line.unwrap_or_else(|| panic!("no {} in: {sweep}", key.name));
        let (least, most) = key.limits;
        assert!(line.contains(&format!("{least} to {most}")), "{line}");
    }
    let hil = help("hil");
    assert!(hil.contains("continuous") && hil.contains("fes"), "{hil}");
    assert!(!hil.contains("discrete"), "{hil}");
    let run = help("run");
    assert!(run.contains("discrete-leff") && run.contains("[default: continuous]"), "{run}");
}
