//! `vm sweep`: an interrupted sweep is resumed without lost or duplicate rows, and every case can
//! be replayed.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// Twelve fast cases; fixed point refuses a third of them.
const GRID: [&str; 8] = [
    "--vary",
    "mass_g=10,100",
    "--vary",
    "tendon_ratio=0.2,1,0.011",
    "--vary",
    "tick_ms=2",
    "--worst",
    "2",
];

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vm"));
    command.arg("sweep").args(arguments);
    command
}

fn sweep(arguments: &[&str], output: &Path) -> Output {
    command(arguments).arg("--output").arg(output).output().expect("vm runs")
}

fn swept(arguments: &[&str], output: &Path) -> String {
    let done = sweep(arguments, output);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8_lossy(&done.stdout).into_owned()
}

fn refused(arguments: &[&str], output: &Path, words: &[&str]) {
    let done = sweep(arguments, output);
    let message = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(2), "{message}");
    for word in words {
        assert!(message.contains(word), "no \"{word}\" in: {message}");
    }
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

#[test]
fn a_table_truncated_anywhere_is_completed_to_the_same_bytes() {
    let folder = Folder::new();
    let output = folder.path("whole.csv");
    let listed = swept(&GRID, &output);
    assert!(listed.contains("12 cases") && listed.contains("--case"), "{listed}");
    let whole = fs::read(&output).expect("a table");
    let lines = whole.iter().filter(|&&byte| byte == b'\n').count();
    assert_eq!(lines, 2 + 12);
    // Within the header, at and next to line ends, and within rows.
    let ends: Vec<usize> = (0..whole.len()).filter(|&at| whole[at] == b'\n').collect();
    let mut cuts = vec![0, 1, 20, ends[0], ends[0] + 1, ends[0] + 30, ends[1], ends[1] + 1];
    cuts.extend(ends[2..].iter().step_by(3).flat_map(|&end| [end - 40, end, end + 1, end + 2]));
    let cut = folder.path("cut.csv");
    for at in cuts.into_iter().filter(|&at| at <= whole.len()) {
        fs::write(&cut, &whole[..at]).expect("a cut table");
        swept(&GRID, &cut);
        assert!(fs::read(&cut).expect("a table") == whole, "cut at byte {at} of {}", whole.len());
    }
}

#[test]
fn a_killed_sweep_is_resumed() {
    let folder = Folder::new();
    let (whole, killed) = (folder.path("whole.csv"), folder.path("killed.csv"));
    let arguments = ["--random", "24", "--seed", "7", "--modes", "continuous"];
    swept(&arguments, &whole);
    let rows = || fs::read(&killed).map_or(0, |text| text.iter().filter(|&&b| b == b'\n').count());
    let mut kills = 0;
    for least in [4, 9, 15] {
        let mut child = command(&arguments)
            .arg("--output")
            .arg(&killed)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("vm runs");
        while rows() < least && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        kills += usize::from(child.try_wait().expect("a child").is_none());
        // It may have finished already.
        let _done = child.kill();
        child.wait().expect("a child");
    }
    assert!(kills > 0 && (6..2 + 24).contains(&rows()), "{} lines", rows());
    swept(&arguments, &killed);
    assert!(fs::read(&whole).expect("a table") == fs::read(&killed).expect("a table"));
}

#[test]
fn a_replayed_case_reproduces_the_error_of_its_row() {
    error_of_a_replay("standard");
    error_of_a_replay("economy");
}

fn error_of_a_replay(class: &str) {
    let folder = Folder::new();
    let output = folder.path("sweep.csv");
    let arguments = ["--random", "3", "--seed", "5", "--modes", "fes", "--class", class];
    swept(&arguments, &output);
    let text = fs::read_to_string(&output).expect("a table");
    let header: Vec<&str> = text.lines().nth(1).expect("a header").split(',').collect();
    let of_f32 = header.iter().position(|&column| column == "f32_max_pct_f0").expect("a column");
    let row: Vec<&str> = text.lines().nth(3).expect("a row").split(',').collect();
    assert_eq!(row[0], "1");
    let expected: f64 = row[of_f32].parse().expect("a number");

    let case = folder.path("case");
    let replayed = command(&arguments).args(["--case", "1", "--replay"]).arg(&case).output();
    let replayed = replayed.expect("vm runs");
    assert!(replayed.status.success(), "{}", String::from_utf8_lossy(&replayed.stderr));
    let told = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(told.contains(&format!("f32: max {expected:.6} %")), "{expected} in {told}");
    // `vm run` with the case's files has the same error.
    let forces = |arithmetic: &str| -> Vec<f64> {
        let out = folder.path(arithmetic);
        let run = Command::new(env!("CARGO_BIN_EXE_vm"))
            .arg("run")
            .arg("--muscle")
            .arg(case.join("muscle.toml"))
            .arg("--input")
            .arg(case.join("input.csv"))
            .arg("--output")
            .arg(&out)
            .args(["--mode", "fes", "--arithmetic", arithmetic])
            .output()
            .expect("vm runs");
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let text = fs::read_to_string(&out).expect("an output");
        let force = |line: &str| line.split(',').nth(1).and_then(|cell| cell.parse().ok());
        text.lines().skip(1).filter_map(force).collect()
    };
    let (single, reference) = (forces("f32"), forces("reference"));
    let largest = single.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let mass: f64 = row[2].parse().expect("g");
    let fascicle: f64 = row[3].parse().expect("cm");
    let f0 = 31.8 * mass / (1.06 * fascicle);
    // The error is printed with six decimals, forces with nine digits.
    assert!((100.0 * largest / f0 - expected).abs() < 1e-5, "{largest} N of {f0} N");
}

#[test]
fn a_file_that_is_not_this_sweeps_table_is_left_unchanged() {
    let folder = Folder::new();
    let output = folder.path("sweep.csv");
    for (text, words) in [
        ("t_s,force_n\n0,1\n", &["sweep.csv: begins with \"t_s,force_n\""][..]),
        ("no line", &["begins with"]),
    ] {
        fs::write(&output, text).expect("a file");
        refused(&GRID, &output, words);
        assert_eq!(fs::read_to_string(&output).expect("a file"), text);
    }
    fs::remove_file(&output).expect("a file");
    let grid = ["--vary", "tick_ms=2", "--modes", "fes"];
    swept(&grid, &output);
    let text = fs::read_to_string(&output).expect("a table");
    refused(&["--vary", "tick_ms=1", "--modes", "fes"], &output, &["tick_ms=2", "tick_ms=1"]);
    let row = text.lines().last().expect("a row");
    for (line, words) in [
        (row.to_owned(), &["line 4, column case: 0 occurs twice"][..]),
        (row.replacen('0', "1", 1), &["\"1\": must be a whole number below 1"]),
        (row.replacen("97.5", "97", 1), &["column mass_g: \"97\": case 0 has 97.5"]),
        (row.replacen("fes", "continuous", 1), &["column mode: \"continuous\": case 0 has fes"]),
        ("0,fes".to_owned(), &["2 cells"]),
    ] {
        let spoilt = format!("{text}{line}\n");
        fs::write(&output, &spoilt).expect("a file");
        refused(&grid, &output, words);
        assert_eq!(fs::read_to_string(&output).expect("a file"), spoilt);
    }
    fs::write(&output, &text).expect("a file");
    // Equal numbers in another notation are accepted.
    fs::write(&output, &text).expect("a file");
    swept(&["--vary", "tick_ms= 2.0", "--modes", "fes"], &output);
    assert_eq!(fs::read_to_string(&output).expect("a file"), text);
    // A table of another version of the model.
    let other = text.replacen("golden bits ", "golden bits 0", 1);
    fs::write(&output, other).expect("a file");
    refused(&grid, &output, &["not a table of this run"]);
    fs::write(&output, &text).expect("a file");
    let other = File::open(&output).expect("a file");
    other.lock().expect("a lock");
    refused(&grid, &output, &["another run is writing it"]);
}

#[test]
fn invalid_variations_are_refused() {
    let folder = Folder::new();
    let output = folder.path("sweep.csv");
    for (arguments, words) in [
        (&["--vary", "weight=3"][..], &["\"weight=3\"", "mass_g"][..]),
        (&["--vary", "mass_g=0"], &["mass_g = 0", "from 0.01 to 30000"]),
        (&["--vary", "mass_g=1,x"], &["mass_g = x"]),
        (&["--vary", "mass_g=1:5"], &["mass_g: a grid needs values"]),
        (&["--random", "5", "--vary", "mass_g=5:1"], &["mass_g = 5:1: the end is below the start"]),
        (&["--vary", "mass_g=1", "--vary", "mass_g=2"], &["mass_g: given twice"]),
        (&["--random", "0"], &["0 cases: must be 1 to 1000000"]),
        (&["--arithmetics", "reference"], &["--arithmetics reference"]),
        (&["--seed", "3"], &["--random"]),
        (&["--modes", "fes,fes"], &["--modes fes: given twice"]),
        (&["--arithmetics", "f32,f32"], &["--arithmetics f32: given twice"]),
    ] {
        refused(arguments, &output, words);
    }
    assert!(!output.exists());
    let done = command(&["--vary", "tick_ms=2", "--case", "2", "--replay", "nowhere"]).output();
    let message = String::from_utf8_lossy(&done.expect("vm runs").stderr).into_owned();
    assert!(message.contains("--case 2: must be below 2"), "{message}");
}

/// A complete table of a random sweep whose cases all have this error, % of F0.
fn table(output: &Path, error: &str) {
    use host_sim::sweep::{KEYS, Space};
    let space = Space::new(&[], vec![host_sim::reference::Mode::Fes], Some((1000, 1)));
    let space = space.expect("a space");
    let names = KEYS.map(|key| key.name).join(",");
    let measured = ["max_pct_f0", "rms_pct_f0", "bias_pct_f0", "status"];
    let columns = measured.map(|column| format!("f32_{column}")).join(",");
    let mut text = format!(
        "# vm sweep --random 1000 --seed 1 --modes fes --arithmetics f32 # {}\n\
         case,mode,{names},{columns},problem\n",
        host_sim::golden::model()
    );
    for number in 0..space.count() {
        let values = space.case(number).values.map(|value| value.to_string()).join(",");
        text.push_str(&format!("{number},fes,{values},{error},0,0,ok,\n"));
    }
    fs::write(output, text).expect("a table");
}

#[test]
fn a_broken_promise_fails_the_command() {
    let folder = Folder::new();
    let arguments = ["--random", "1000", "--modes", "fes", "--arithmetics", "f32"];
    let (kept, broken) = (folder.path("kept.csv"), folder.path("broken.csv"));
    table(&kept, "0.09");
    assert!(swept(&arguments, &kept).contains("kept"));
    table(&broken, "0.11");
    refused(&arguments, &broken, &["promise broken: f32"]);
}
