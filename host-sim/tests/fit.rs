//! `vm fit`: the parameters of a synthetic recording are recovered; an invalid recording is refused
//! with file, line and column, and nothing is written.

use host_sim::engine::{self, Arithmetic};
use host_sim::muscle_file;
use host_sim::reference::{Input, Mode};
use host_sim::trace::InputTrace;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");
const DOCUMENT: &str = include_str!("../docs/trials.md");

/// True parameters of the recording.
const FORCE: f64 = 310.0;
const PATH: f64 = 0.152;

/// The example in the documentation.
fn example() -> &'static str {
    let begin = DOCUMENT.find("```toml\n").expect("an example") + "```toml\n".len();
    let end = DOCUMENT[begin..].find("```").expect("its end");
    &DOCUMENT[begin..begin + end]
}

/// Reproducible uniform noise of standard deviation 1.
fn noise(index: usize) -> f64 {
    let mut bits = index as u64 + 1;
    for _ in 0..3 {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        bits ^= bits >> 29;
    }
    ((bits >> 11) as f64 * 2_f64.powi(-53) - 0.5) * 12_f64.sqrt()
}

/// The recording of the example: force of the reference for a stronger muscle on another path,
/// every 7 ms, with noise of 1 % of F0.
fn recording() -> String {
    // To the end of the window.
    recording_with(0.01, 7) + "1.2,0.5,0\n"
}

/// The same with another noise, a share of F0, and a reading every so many ms. With one every ms
/// the model has the path of the recording; between others it is interpolated.
fn recording_with(share: f64, every: usize) -> String {
    let mut muscle = muscle_file::parse(MUSCLE, Path::new("m.toml")).expect("a muscle").muscle;
    muscle.mass *= FORCE / muscle.f0();
    let change = |time: f64| 0.004 * (12.0 * time).sin();
    // The lead is 100 ticks.
    let input = |tick: usize| {
        let (end, middle) = (tick as f64 * 1e-3 - 0.1, tick as f64 * 1e-3 - 0.1005);
        Input {
            activation: if (0.1..0.8).contains(&middle) { 1.0 } else { 0.0 },
            path_length: PATH + change(end.max(0.0)),
            stimulation_frequency: 40.0,
        }
    };
    let inputs = (0..=1300).map(input).collect();
    let trace = InputTrace { start: -0.1, time_step: 1e-3, inputs };
    let rows = engine::run(&muscle, Mode::Fes, Arithmetic::Reference, &trace).expect("a run");
    let mut text = "t_s,force_n,change_mm\n".to_owned();
    for tick in (0..=1200).step_by(every) {
        let force = rows[100 + tick].0.force + share * FORCE * noise(tick);
        let time = tick as f64 * 1e-3;
        text += &format!("{time},{force:.4},{}\n", 1e3 * change(time));
    }
    text
}

/// A folder with a muscle file, a list of trials and a recording.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(trials: &str, recording: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in
            [("m.toml", MUSCLE), ("trials.toml", trials), ("tetanus.csv", recording)]
        {
            fs::write(folder.path().join(name), text).expect("a file");
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn fit(&self, out: &str, more: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_vm"))
            .current_dir(self.0.path())
            .args(["fit", "--muscle", "m.toml", "--trials", "trials.toml", "--out", out])
            .args(more)
            .output()
            .expect("vm runs")
    }

    fn refused(&self, words: &[&str]) {
        let output = self.fit("fitted.toml", &["--starts", "1"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in words {
            assert!(message.contains(word), "no \"{word}\" in: {message}");
        }
        let left = fs::read_dir(self.0.path()).expect("the folder").count();
        assert_eq!(left, 3, "nothing is written: {message}");
    }
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).expect("a file")
}

/// A value and its interval, from the comments of a fitted file.
fn fitted(file: &str, name: &str) -> (f64, f64, f64) {
    let line = file.lines().find(|line| line.starts_with(&format!("# {name} = "))).expect("a line");
    let numbers: Vec<f64> = line
        .split([' ', ':'])
        .filter_map(|word| word.parse().ok())
        .filter(|&number| number != 95.0)
        .collect();
    (numbers[0], numbers[1], numbers[2])
}

#[test]
fn the_examples_parameters_are_recovered_reproducibly() {
    let bench = Bench::new(example(), &recording());
    let search = ["--starts", "3", "--seed", "7", "--report", "fit.html"];
    let done = bench.fit("fitted.toml", &search);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let file = text(&bench.path("fitted.toml"));
    for (name, truth) in [("max_isometric_force_n", FORCE), ("path_at_rest_m", PATH)] {
        let (value, least, most) = fitted(&file, name);
        assert!((least..=most).contains(&truth), "{name}: {least} to {most}");
        assert!((value / truth - 1.0).abs() < 0.01, "{name}: {value}");
        assert!(most - least < 0.05 * truth, "{name}: {least} to {most}");
    }
    // The fitted file is a valid muscle file, in the firmware's arithmetics as well.
    let muscle = muscle_file::parse(&file, Path::new("fitted.toml")).expect("a muscle").muscle;
    assert!((muscle.f0() / FORCE - 1.0).abs() < 0.01, "{} N", muscle.f0());
    for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
        engine::at_rest(&muscle, Mode::Fes, arithmetic, 1e-3, PATH).expect("it builds");
    }
    let page = text(&bench.path("fit.html"));
    assert!(page.contains("<svg") && page.contains("tetanus, fitted"));
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http"), "no network");

    let again = bench.fit("again.toml", &search[..4]);
    assert!(again.status.success());
    assert_eq!(text(&bench.path("again.toml")), file, "the same bytes");
}

/// The recording with one line replaced, counted from 1.
fn broken(line: usize, by: &str) -> String {
    let recording = recording();
    let mut lines: Vec<&str> = recording.lines().collect();
    lines[line - 1] = by;
    lines.join("\n") + "\n"
}

#[test]
fn an_invalid_recording_is_refused_with_file_line_and_column() {
    let cases: &[(String, &[&str])] = &[
        (broken(9, "0.049,,0.1"), &["tetanus.csv, line 9, column force_n: missing"]),
        (broken(9, "0.049,inf,0.1"), &["line 9, column force_n", "\"inf\" is not a finite"]),
        (broken(9, "0.049"), &["line 9, column force_n: missing"]),
        (broken(9, "0.042,1,0.1"), &["line 9, column t_s: 0.042 repeats 0.042"]),
        (broken(9, "0.01,1,0.1"), &["line 9, column t_s: 0.01 goes back from 0.042"]),
        (broken(1, "t_s,f,change_mm"), &["line 1, column force_n: the header has only t_s, f"]),
        ("t_s,force_n,change_mm\n".to_owned(), &["0 rows: at least 2"]),
    ];
    for (recording, words) in cases {
        Bench::new(example(), recording).refused(words);
    }
    let rows = |force: &dyn Fn(usize) -> f64| {
        let row = |tick: usize| format!("{},{},0\n", tick as f64 * 1e-3, force(tick));
        "t_s,force_n,change_mm\n".to_owned() + &(0..=1300).step_by(10).map(row).collect::<String>()
    };
    Bench::new(example(), &rows(&|_| 1.5)).refused(&["column force_n: 1.5 in every row", "dead"]);
    let clipped = rows(&|tick| (tick as f64).min(700.0));
    Bench::new(example(), &clipped).refused(&["line 72, column force_n: 700", "saturated"]);
    let few = rows(&|tick| tick as f64)
        .lines()
        .take(4)
        .fold(String::new(), |all, line| all + line + "\n");
    let window = example().replace("window_s = [0.05, 1.2]", "window_s = [0, 0.02]");
    Bench::new(&window, &few).refused(&["3 readings in the window: at least 8"]);
}

/// The example with something replaced.
fn changed(from: &str, to: &str) -> String {
    assert!(example().contains(from), "{from}");
    example().replacen(from, to, 1)
}

#[test]
fn an_invalid_list_of_trials_is_refused_with_its_key() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("weight = 1 ", "weights = 1 ", &["trials.toml", "weights"]),
        ("role = \"fit\"", "role = \"fitted\"", &["fitted"]),
        ("role = \"fit\"", "role = \"predict\"", &["0 readings in trials of role fit"]),
        ("mode = \"fes\"", "mode = \"natural\"", &["tetanus", "mode = \"natural\"", "continuous"]),
        ("[0.05, 1.2]", "[0.05, 9]", &["window_s = [0.05, 9]", "from 0 to 1.2 s"]),
        (
            "bounds = [100, 600]",
            "bounds = [1, 20]",
            &["max_isometric_force_n", "within its bounds"],
        ),
        ("start = 0.155\n", "", &["path_at_rest_m", "start = (missing)"]),
        (
            "offset = \"path_at_rest_m\"",
            "offset = \"path\"",
            &["length", "no [[free]] of that name"],
        ),
        ("name = \"path_at_rest_m\"", "name = \"fascicles\"", &["no [[free]] of that name"]),
        ("[0.1, 1]", "[0.1, nan]", &["steps", "increasing"]),
        ("noise_pct_f0 = 1 ", "", &["noise_n", "noise_pct_f0"]),
        (
            "name = \"path_at_rest_m\"",
            "name = \"path_at_rest_m\"\nprior = \"published\"",
            &["no published spread", "f05_pps"],
        ),
        ("tetanus.csv", "nowhere.csv", &["nowhere.csv"]),
        ("[0.1, 1]", "[0.1, 3]", &["trial \"tetanus\": activation = 3: must be 0 to 1"]),
        (
            "time_step_ms = 1 ",
            "time_step_ms = 7 ",
            &["trials.toml: time_step_ms = 7: must be 0.1 to 2"],
        ),
    ];
    let recording = recording();
    for (from, to, words) in cases {
        Bench::new(&changed(from, to), &recording).refused(words);
    }
}

#[test]
fn inputs_that_no_muscle_takes_are_refused_with_their_place() {
    let pps = |signal: &str| {
        let line = example().lines().find(|line| line.starts_with("stimulation_pps")).expect("it");
        changed(line, &format!("stimulation_pps = {signal}"))
    };
    let constant = pps("{ constant = 4000 }");
    Bench::new(&constant, &recording())
        .refused(&["trials.toml", "trial \"tetanus\": stimulation_pps = 4000: must be 0 to 500"]);
    let column = pps("{ file = \"tetanus.csv\", time = \"t_s\", value = \"force_n\", scale = -1 }");
    let negative =
        ["tetanus.csv, line ", "column force_n: stimulation_pps = -", "must be 0 to 500"];
    Bench::new(&column, &recording()).refused(&negative);
}

/// Forces without noise: the residuals do not narrow the intervals below the stated noise, or they
/// would exclude the truth.
#[test]
fn a_noiseless_recording_has_the_intervals_of_the_stated_noise() {
    let noiseless = recording_with(0.0, 1);
    let bench = Bench::new(example(), &noiseless);
    let done = bench.fit("fitted.toml", &["--starts", "1"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(said.contains("residuals far below noise_pct_f0"), "{said}");
    let file = text(&bench.path("fitted.toml"));
    let half = Bench::new(&changed("noise_pct_f0 = 1 ", "noise_pct_f0 = 0.5 "), &noiseless);
    assert!(half.fit("fitted.toml", &["--starts", "1"]).status.success());
    let halved = text(&half.path("fitted.toml"));
    for (name, truth) in [("max_isometric_force_n", FORCE), ("path_at_rest_m", PATH)] {
        let (_, least, most) = fitted(&file, name);
        assert!((least..=most).contains(&truth), "{name}: {least} to {most}");
        let (_, from, to) = fitted(&halved, name);
        // Printed with six digits.
        assert!(((most - least) / (to - from) - 2.0).abs() < 0.01, "{name}: {from} to {to}");
    }
    let noisy = Bench::new(example(), &recording());
    let done = noisy.fit("fitted.toml", &["--starts", "1"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success() && !said.contains("far below"), "{said}");
}

#[test]
fn an_undetermined_parameter_is_refused_by_name() {
    // FES recruits all types in proportion.
    let free = "[[free]]\nname = \"recruitment_saturation\"\nPRIOR\n[[free]]";
    let without = changed("[[free]]", &free.replace("PRIOR", ""));
    Bench::new(&without, &recording())
        .refused(&["trials.toml: not determined", "recruitment_saturation"]);

    let prior = free.replace("PRIOR", "prior = { mean = 0.8, spread = 0.05 }");
    let bench = Bench::new(&changed("[[free]]", &prior), &recording());
    let done = bench.fit("fitted.toml", &["--starts", "1"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let file = text(&bench.path("fitted.toml"));
    assert!(file.contains("# recruitment_saturation = 0.8: left at its prior"), "{file}");
}
