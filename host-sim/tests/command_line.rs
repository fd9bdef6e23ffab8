//! The command line `vm`: files, messages and exit codes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");
const HEADER: &str = "t_s,activation,path_length_m,stim_hz\n";

/// A folder with a muscle file, an input file and an output file.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new(muscle: &str, input: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("m.toml"), muscle).expect("a muscle file");
        fs::write(folder.path().join("in.csv"), input).expect("an input file");
        fs::write(folder.path().join("out.csv"), "as it was").expect("an output file");
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, mode: &str, arithmetic: &str) -> Output {
        vm(&[
            "run".as_ref(),
            "--muscle".as_ref(),
            self.path("m.toml").as_ref(),
            "--input".as_ref(),
            self.path("in.csv").as_ref(),
            "--output".as_ref(),
            self.path("out.csv").as_ref(),
            "--mode".as_ref(),
            mode.as_ref(),
            "--arithmetic".as_ref(),
            arithmetic.as_ref(),
        ])
    }

    /// Asserts exit code 2, a message with all of `words`, and that no file changed.
    fn refused(&self, words: &[&str]) {
        let output = self.run("continuous", "f32");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        for word in words {
            assert!(message.contains(word), "no \"{word}\" in: {message}");
        }
        let text = fs::read_to_string(self.path("out.csv")).expect("the output file");
        assert_eq!(text, "as it was", "{message}");
        let left = fs::read_dir(self.folder.path()).expect("the folder").count();
        assert_eq!(left, 3, "a temporary file is left");
    }
}

fn vm(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm")).args(arguments).output().expect("vm runs")
}

/// Input rows: full activation at 40 pps.
fn stimulated(ticks: usize) -> String {
    let row = |tick: usize| format!("{},1,0.16,40\n", tick as f64 * 1e-3);
    rows(&(0..=ticks).map(row).collect::<String>())
}

/// Column `force_n` of an output.
fn forces(bench: &Bench) -> Vec<f64> {
    let text = fs::read_to_string(bench.path("out.csv")).expect("an output file");
    let force = |line: &str| line.split(',').nth(1).and_then(|cell| cell.parse().ok());
    text.lines().skip(1).map(|line| force(line).expect("a force")).collect()
}

/// Against the equation after ten seconds at 40 pps: λ = 0.4 + 0.6 · 0.16 = 0.496.
#[test]
fn a_muscle_with_fatigue_parameters_fatigues() {
    let table = "\n[fatigue]\nT_fat_s = 18\nT_rec_s = 30\nfit_min = 0\nbeta = 0.6\n";
    // N. Forces are printed with nine digits; fixed point has a resolution of 1 mN.
    for (arithmetic, most) in [("reference", 1.5e-6), ("f32", 4e-4), ("fixed", 1.6e-3)] {
        let fresh = Bench::new(MUSCLE, &stimulated(10_000));
        let tired = Bench::new(&format!("{MUSCLE}{table}"), &stimulated(10_000));
        for bench in [&fresh, &tired] {
            assert!(bench.run("fes", arithmetic).status.success());
        }
        let (tiring, recovering) = (0.496 / 18.0, 0.504 / 30.0);
        let (rate, end) = (tiring + recovering, recovering / (tiring + recovering));
        for (tick, (tired, fresh)) in forces(&tired).into_iter().zip(forces(&fresh)).enumerate() {
            let fitness = end + (1.0 - end) * (-rate * tick as f64 * 1e-3).exp();
            assert!((tired - fitness * fresh).abs() < most, "{arithmetic} {tick}: {tired} N");
        }
    }
    let never = table.replace("T_fat_s = 18", "T_fat_s = 0");
    let bench = Bench::new(&format!("{MUSCLE}{never}"), &stimulated(10));
    bench.refused(&["m.toml", "fatigue.T_fat_s = 0", "between 1 and 1000"]);
    let unknown = table.replace("beta", "bete");
    Bench::new(&format!("{MUSCLE}{unknown}"), &stimulated(10)).refused(&["m.toml", "bete"]);
}

/// A muscle file with a line replaced.
fn muscle(line: &str, other: &str) -> String {
    assert!(MUSCLE.contains(line), "{line}");
    MUSCLE.replacen(line, other, 1)
}

fn rows(text: &str) -> String {
    format!("{HEADER}{text}")
}

const GOOD: &str = "0,0,0.16,0\n0.001,0.5,0.16,0\n0.002,0.5,0.16,0\n";

#[test]
fn an_invalid_muscle_is_refused_with_key_value_and_limit() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("mass_g = 97.5", "mass_g = -97.5", &["line 3: mass_g = -97.5", "between 0.01 and 30000"]),
        ("mass_g = 97.5", "mass_g = 0", &["mass_g = 0", "between 0.01"]),
        ("mass_g = 97.5", "mass_g = nan", &["mass_g = NaN", "between"]),
        ("mass_g = 97.5", "mass_g = inf", &["mass_g = inf", "between"]),
        ("mass_g = 97.5", "mass_g = \"heavy\"", &["line 3", "string", "f64"]),
        ("mass_g = 97.5", "mass_kg = 1", &["unknown field `mass_kg`", "mass_g"]),
        ("mass_g = 97.5", "", &["mass_g = (missing)", "max_isometric_force_n"]),
        ("tendon_length_cm = 2.0", "tendon_length_cm = -1", &["tendon_length_cm = -1", "0.05 and"]),
        ("max_path_length_cm = 18.4", "max_path_length_cm = 99", &["max_path_length_cm = 99"]),
        ("saturation = 0.8", "saturation = 1.5", &["recruitment_saturation = 1.5", "0.01 and 1"]),
        ("\"paper-table-1\"", "\"paper\"", &["coefficients = \"paper\"", "human-vm4"]),
        ("fraction = 0.6", "fraction = 0.7", &["fraction = 1.1", "add to 1"]),
        ("fraction = 0.6", "fraction = -0.6", &["fiber[0].fraction = -0.6", "between"]),
        ("table-1/slow", "table-1/slower", &["fiber[0].preset", "slower", "feline-vm4/fast"]),
        ("fraction = 0.4", "fraction = 0.4\nbeta = -1", &["fiber[1].beta = -1", "0.1 and 5"]),
        ("fraction = 0.4", "fraction = 0.4\nbeta = nan", &["fiber[1].beta = nan", "finite"]),
        ("fraction = 0.4", "fraction = 0.4\nbeta = \"b\"", &["fiber[1].beta", "a number"]),
        ("fraction = 0.4", "fraction = 0.4\nbat = 1", &["fiber[1].bat = 1", "unknown key"]),
        ("fraction = 0.4", "fraction = 0.4\nunits = 0", &["fiber[1].units = 0", "1 to 512"]),
        ("fraction = 0.4", "fraction = 0.4\nunits = 513", &["fiber[1].units = 513", "1 to 512"]),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunits = 40\nunit_sizes = { geometric = 1 }",
            &["fiber[1].unit_sizes = 0.0000000000009", "at least"],
        ),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunits = 2\nunit_sizes = \"odd\"",
            &["fiber[1].unit_sizes = \"odd\"", "equal"],
        ),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunits = 2\nunit_sizes = [1, 2, 3]",
            &["fiber[1].unit_sizes = 3 sizes", "as many"],
        ),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunit_sizes = [1, 0]",
            &["fiber[1].unit_sizes = 0", "1e-6"],
        ),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunits = 2\nunit_sizes = { geometric = 2 }",
            &["fiber[1].unit_sizes.geometric = 2", "-0.5 to 1"],
        ),
        (
            "fraction = 0.4",
            "fraction = 0.4\nunit_sizes = \"equal\"",
            &["fiber[1].units = (missing)", "number of units"],
        ),
        ("fraction = 0.4", "fraction = 0.4\nTL_ms = 99", &["fiber[1].TL_ms = 99", "0.05 and 10"]),
        ("fraction = 0.4", "fraction = 0.4\nTf1_ms = 0", &["fiber[1].Tf1_ms = 0", "5 and 500"]),
        ("fraction = 0.4", "fraction = 0.4\ncV0 = -50", &["fiber[1].cV0", "pole"]),
        ("fraction = 0.4", "fraction = 0.4\nnf0 = 0.5\nnf1 = 20", &["fiber[1].nf1", "n_f"]),
        ("fraction = 0.4", "fraction = 0.4\naV0 = 3", &["aV0 + aV1 L", "-1"]),
        ("fraction = 0.4", "fraction = 0.4\nrank = 2.5", &["fiber[1].rank = 2.5", "whole number"]),
        ("preset = \"paper-table-1/slow\"", "", &["fiber[0].rank", "preset"]),
    ];
    for (line, other, words) in cases {
        let mut expected = vec!["m.toml"];
        expected.extend(*words);
        Bench::new(&muscle(line, other), &rows(GOOD)).refused(&expected);
    }
    let many = MUSCLE.replace("[[fiber]]", "[[fiber]]\nunits = 300");
    Bench::new(&many, &rows(GOOD)).refused(&["m.toml", "fiber.units = 600", "at most 512"]);
}

#[test]
fn an_invalid_input_file_is_refused_with_line_and_column() {
    let cases: &[(&str, &[&str])] = &[
        ("", &["line 1", "column t_s", "header"]),
        ("t_s,activation,path,stim_hz\n0,0,0.16,0\n", &["line 1", "path_length_m", "\"path\""]),
        (HEADER, &["t_s", "0 rows:"]),
        (&rows("0,0,0.16,0\n"), &["t_s", "1 row:"]),
        (&rows("0,0,0.16,0\n0.001,0,0.16\n"), &["line 3", "stim_hz", "3 cells"]),
        (&rows("0,0,0.16,0\n0.001,0,0.16,0,9\n"), &["line 3", "5 cells"]),
        (&rows("0,0,0.16,0\n0.001,x,0.16,0\n"), &["line 3", "activation", "\"x\""]),
        (&rows("0,0,0.16,0\n0.001,0,nan,0\n"), &["line 3", "path_length_m", "\"nan\""]),
        (&rows("0,0,0.16,0\n0.001,0,0.16,inf\n"), &["line 3", "stim_hz", "\"inf\""]),
        (&rows("0,0,0.16,0\n0.001,1e300,0.16,0\n"), &["line 3", "activation", "beyond"]),
        (&rows("0,0,0.16,0\n0.001,,0.16,0\n"), &["line 3", "activation", "\"\""]),
        (
            &rows("0,0,0.16,0\n0.001,0,0.16,0\n0.001,0,0.16,0\n"),
            &["line 4", "t_s", "is not after 0.001"],
        ),
        (
            &rows("0,0,0.16,0\n0.001,0,0.16,0\n0.003,0,0.16,0\n0.004,0,0.16,0\n"),
            &["line 4", "t_s", "0.002"],
        ),
        (
            &rows("0,0,0.16,0\n0.01,0,0.16,0\n"),
            &["t_s: rows 0.01 s apart: must be 0.0001 to 0.002 s"],
        ),
        (
            &rows("0,0,0.5,0\n0.001,0,0.16,0\n"),
            &["line 2", "path_length_m", "0.5", "to 0.1975", "the longest on which it can rest"],
        ),
    ];
    for (input, words) in cases {
        let mut expected = vec!["in.csv"];
        expected.extend(*words);
        Bench::new(MUSCLE, input).refused(&expected);
    }
}

#[test]
fn a_missing_file_is_named() {
    let bench = Bench::new(MUSCLE, &rows(GOOD));
    fs::remove_file(bench.path("in.csv")).expect("a file to remove");
    let output = bench.run("fes", "reference");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("in.csv"));
}

#[test]
fn a_run_writes_one_row_per_input_and_ignores_extra_columns() {
    let vector = include_str!("../data/vectors/fes_steps.csv");
    for arithmetic in ["reference", "f32", "f64"] {
        let bench = Bench::new(MUSCLE, vector);
        let output = bench.run("fes", arithmetic);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = fs::read_to_string(bench.path("out.csv")).expect("the output file");
        let mut lines = text.lines();
        let header = lines.next();
        assert_eq!(
            header,
            Some("t_s,force_n,fascicle_length_l0,fascicle_velocity_l0_per_s,status")
        );
        assert_eq!(text.lines().count(), vector.lines().count());
        // Against the force in the vector's fifth column to 0.1 % of F0. This checks the columns;
        // `verify` checks the accuracy.
        for (line, expected) in lines.zip(vector.lines().skip(1)) {
            let cell = |text: &str, index: usize| {
                text.split(',').nth(index).expect("a cell").parse::<f64>().expect("a number")
            };
            assert_eq!(cell(line, 0), cell(expected, 0));
            assert!((cell(line, 1) - cell(expected, 4)).abs() < 0.266, "{line} {expected}");
            let status = if arithmetic == "reference" { ",unchecked" } else { ",ok" };
            assert!(line.ends_with(status), "{line}");
        }
    }
}

#[test]
fn discrete_modes_give_the_authors_forces_and_need_units() {
    const VECTOR: &str = include_str!("../data/vectors/discrete_3_activation_3hz.csv");
    let three = MUSCLE.replace("[[fiber]]", "[[fiber]]\nunits = 3");
    let force = |line: &str, column: usize| -> f64 {
        line.split(',').nth(column).expect("a cell").parse().expect("a number")
    };
    for arithmetic in ["reference", "f32", "fixed"] {
        let bench = Bench::new(&three, VECTOR);
        let output = bench.run("discrete", arithmetic);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let text = fs::read_to_string(bench.path("out.csv")).expect("the output file");
        for (line, expected) in text.lines().zip(VECTOR.lines()).skip(102) {
            let (found, expected) = (force(line, 1), force(expected, 4));
            assert!((found - expected).abs() < 0.01, "{arithmetic}: {line}, {expected} N");
        }
        for mode in ["discrete", "discrete-leff"] {
            let output = Bench::new(MUSCLE, VECTOR).run(mode, arithmetic);
            assert!(!output.status.success());
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(message.contains("units = (missing), fibre type of rank 2"), "{message}");
        }
    }
}

#[test]
fn the_input_is_not_overwritten_and_links_and_devices_are_not_replaced() {
    let bench = Bench::new(MUSCLE, &rows(GOOD));
    let run_to = |output: &Path| {
        let (muscle, input) = (bench.path("m.toml"), bench.path("in.csv"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_vm"));
        command.arg("run").arg("--muscle").arg(muscle).arg("--input").arg(input);
        command.args(["--mode", "fes", "--arithmetic", "f32", "--output"]).arg(output);
        command.output().expect("vm runs").status.code()
    };
    assert_eq!(run_to(&bench.path("in.csv")), Some(2));
    assert_eq!(fs::read_to_string(bench.path("in.csv")).expect("the input"), rows(GOOD));
    assert_eq!(run_to(&bench.path("nowhere/out.csv")), Some(2));
    #[cfg(unix)]
    {
        use std::os::unix::fs::{FileTypeExt, MetadataExt, symlink};
        symlink(bench.path("out.csv"), bench.path("link.csv")).expect("a link");
        let before = fs::metadata(bench.path("out.csv")).expect("the output").ino();
        assert_eq!(run_to(&bench.path("link.csv")), Some(0));
        assert!(fs::symlink_metadata(bench.path("link.csv")).expect("the link").is_symlink());
        let after = fs::metadata(bench.path("out.csv")).expect("the output");
        // Replaced atomically: a reader of the old file reads it to its end.
        assert_ne!(before, after.ino());
        assert_eq!(run_to(Path::new("/dev/null")), Some(0));
        assert!(fs::metadata("/dev/null").expect("/dev/null").file_type().is_char_device());
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_output_is_an_error_and_not_a_panic() {
    let full = || fs::File::options().write(true).open("/dev/full").expect("/dev/full");
    let status = Command::new(env!("CARGO_BIN_EXE_vm"))
        .arg("golden")
        .stdout(full())
        .stderr(full())
        .status()
        .expect("vm runs");
    assert_eq!(status.code(), Some(2));
}

#[test]
fn large_times_are_written_as_read() {
    let input = rows("1700000000,0,0.16,0\n1700000000.001,0,0.16,0\n1700000000.002,0,0.16,0\n");
    let bench = Bench::new(MUSCLE, &input);
    assert!(bench.run("continuous", "f32").status.success());
    let text = fs::read_to_string(bench.path("out.csv")).expect("the output file");
    let times: Vec<&str> = text.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(times, ["1700000000", "1700000000.001", "1700000000.002"]);
}

#[test]
fn the_status_names_what_was_clipped() {
    let input = rows("0,0,0.16,0\n0.001,1.5,0.16,0\n0.002,0.5,0.3,-4\n");
    let bench = Bench::new(MUSCLE, &input);
    assert!(bench.run("fes", "f32").status.success());
    let text = fs::read_to_string(bench.path("out.csv")).expect("the output file");
    let statuses: Vec<&str> = text.lines().filter_map(|line| line.rsplit(',').next()).collect();
    assert_eq!(statuses[1..3], ["ok", "ACTIVATION_CLIPPED"]);
    assert!(statuses[3].starts_with("FREQUENCY_CLIPPED|PATH_LENGTH_CLIPPED"), "{}", statuses[3]);
}

#[test]
fn types_may_be_listed_in_any_order_and_overridden_by_name() {
    let run = |muscle: &str| {
        let bench = Bench::new(muscle, &rows(GOOD));
        let output = bench.run("continuous", "f32");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read_to_string(bench.path("out.csv")).expect("the output file")
    };
    let (head, fibers) = MUSCLE.split_once("[[fiber]]").expect("fibre tables");
    let (slow, fast) = fibers.split_once("[[fiber]]").expect("two fibre tables");
    let swapped = format!("{head}[[fiber]]{fast}\n[[fiber]]{slow}");
    assert_eq!(run(MUSCLE), run(&swapped));
    let same = muscle("fraction = 0.4", "fraction = 0.4\nunits = 30\nomega = 0.75\nTf1_ms = 20.6");
    assert_eq!(run(MUSCLE), run(&same));
    let other = muscle("fraction = 0.6", "fraction = 0.6\nTf1_ms = 10");
    assert_ne!(run(MUSCLE), run(&other));
}

#[test]
fn a_custom_fibre_type_needs_no_preset() {
    // The coefficients of the paper's slow type.
    let own = "rank = 2\nf05_pps = 12\nfmin = 0.5\nfmax = 2\nomega = 1.12\nbeta = 2.3\nrho = 1.62\n\
               Vmax = -7.88\ncV0 = 5.88\ncV1 = 0\naV0 = -4.7\naV1 = 8.41\naV2 = -5.34\nbV = 0.35\n\
               af = 0.56\nnf0 = 2.1\nnf1 = 5\nTf1_ms = 34.3\nTf2_ms = 22.7\nTf3_ms = 47.0\n\
               Tf4_ms = 25.2\ncY = 0.35\nVY = 0.1\nTY_ms = 200";
    let forces = |muscle: &str| {
        let bench = Bench::new(muscle, &rows(GOOD));
        let output = bench.run("fes", "f64");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read_to_string(bench.path("out.csv")).expect("the output file")
    };
    assert_eq!(forces(MUSCLE), forces(&muscle("preset = \"paper-table-1/slow\"", own)));
    let half_a_yield = own.replace("\nVY = 0.1", "");
    Bench::new(&muscle("preset = \"paper-table-1/slow\"", &half_a_yield), &rows(GOOD))
        .refused(&["fiber[0].VY", "preset"]);
}

#[test]
fn a_plot_shows_force_length_velocity_and_inputs() {
    let bench = Bench::new(MUSCLE, &rows(GOOD));
    assert!(bench.run("continuous", "f32").status.success());
    let (out, input, svg) = (bench.path("out.csv"), bench.path("in.csv"), bench.path("out.svg"));
    let arguments: [&Path; 7] = [
        "plot".as_ref(),
        "--run".as_ref(),
        &out,
        "--input".as_ref(),
        &input,
        "--output".as_ref(),
        &svg,
    ];
    let output = vm(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(&svg).expect("a picture");
    assert!(text.starts_with("<svg"));
    for label in ["force (N)", "length (L0)", "velocity (L0/s)", "activation", "path (m)", "pps"] {
        assert!(text.contains(label), "{label}");
    }
}

#[test]
fn verify_as_json_has_the_agreed_keys_and_passes() {
    let output = vm(&["verify".as_ref(), "--json".as_ref()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = rows.as_array().expect("an array");
    assert!(rows.len() > 100, "{} rows", rows.len());
    for row in rows {
        let keys: Vec<&str> = row.as_object().expect("an object").keys().map(|k| &**k).collect();
        let mut agreed = [
            "scenario",
            "mode",
            "arithmetic",
            "against",
            "max_pct_f0",
            "rms_pct_f0",
            "bias_pct_f0",
            "tolerance_pct_f0",
            "pass",
        ];
        agreed.sort_unstable();
        assert_eq!(keys, agreed);
        assert_eq!(row["pass"], true, "{row}");
    }
}

#[test]
fn a_built_in_muscle_is_found_by_name_unless_a_file_has_it() {
    let input = rows("0,0,0.34,0\n0.001,1,0.34,0\n0.002,1,0.34,0\n");
    let bench = Bench::new(MUSCLE, &input);
    let run = |muscle: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vm"));
        command.current_dir(bench.folder.path()).args(["run", "--muscle", muscle]);
        command.args(["--input", "in.csv", "--output", "out.csv", "--mode", "fes"]);
        command.args(["--arithmetic", "f32"]).output().expect("vm runs")
    };
    assert!(run("tibialis_anterior").status.success());
    assert!(forces(&bench)[0] > 0.0);

    let unknown = run("tibialis_posteriorr");
    let message = String::from_utf8_lossy(&unknown.stderr).into_owned();
    assert_eq!(unknown.status.code(), Some(2), "{message}");
    assert!(message.contains("tibialis_posteriorr: no such file"), "{message}");
    assert!(message.contains("vm muscles"), "{message}");

    // A file takes precedence; here the path is outside the validity range of its muscle.
    fs::write(bench.path("tibialis_anterior"), MUSCLE).expect("a muscle file");
    let file = run("tibialis_anterior");
    assert_eq!(file.status.code(), Some(2), "the file is taken");
}

#[test]
fn built_in_muscles_are_listed_with_their_assumptions() {
    let output = vm(&["muscles".as_ref()]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success());
    let rows = text.lines().filter(|line| line.starts_with("| ")).count();
    assert_eq!(rows, 21, "a header and twenty muscles: {text}");
    for word in ["guess", "Edgerton", "CC BY 3.0", "L_mt_max", "pennation"] {
        assert!(text.contains(word), "no \"{word}\" in: {text}");
    }
}
