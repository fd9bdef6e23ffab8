//! Output files: an existing file keeps its permissions, links are followed, and no temporary file
//! is left.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const INPUT: &str = "t_s,activation,path_length_m,stim_hz\n0,0.5,0.16,0\n0.001,0.5,0.16,0\n";

/// A folder with the input files of the commands.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder"));
        fs::write(bench.path("m.toml"), include_str!("../data/muscles/deltoid_posterior.toml"))
            .expect("a muscle");
        fs::write(bench.path("in.csv"), INPUT).expect("inputs");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs a command of `vm` in this folder with an umask.
    fn vm(&self, umask: &str, command: &str) -> Output {
        let script = format!("umask {umask} && exec \"$0\" {command}");
        Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_vm")])
            .current_dir(self.0.path())
            .output()
            .expect("a shell")
    }

    fn done(&self, umask: &str, command: &str) {
        let output = self.vm(umask, command);
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }

    fn is_new(&self, name: &str) -> bool {
        fs::read(self.path(name)).expect(name) != b"as it was"
    }

    fn files(&self) -> usize {
        fs::read_dir(self.0.path()).expect("a folder").count()
    }
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).expect("a file").permissions().mode() & 0o777
}

fn give(path: &Path, mode: u32) {
    fs::set_permissions(path, Permissions::from_mode(mode)).expect("permissions");
}

const RUN: &str = "run --muscle m.toml --input in.csv --mode continuous --arithmetic f32 --output";
const SWEEP: &str = "sweep --vary mass_g=100 --vary tick_ms=2 --output";

/// The commands that write files; `report` and `figures` have their own tests.
#[test]
fn a_replaced_file_keeps_its_permissions() {
    let bench = Bench::new();
    bench.done("022", &format!("{RUN} run.csv"));
    for (command, name) in [
        (RUN, "out.csv"),
        ("arm --duration 0.1 --output", "arm.csv"),
        ("plot --run run.csv --output", "plot.svg"),
        (SWEEP, "sweep.csv"),
    ] {
        // A new file has the permissions that the umask leaves.
        bench.done("027", &format!("{command} {name}"));
        assert_eq!(mode(&bench.path(name)), 0o640, "{command}");
        for kept in [0o664, 0o600, 0o604, 0o755] {
            // The table of a sweep is resumed; all other files are replaced.
            if command != SWEEP {
                fs::write(bench.path(name), "as it was").expect("a file");
            }
            give(&bench.path(name), kept);
            let files = bench.files();
            for umask in ["022", "077", "000"] {
                bench.done(umask, &format!("{command} {name}"));
                assert_eq!(mode(&bench.path(name)), kept, "{command}, umask {umask}");
            }
            assert!(bench.is_new(name), "{command}");
            assert_eq!(bench.files(), files, "{command}: a temporary file is left");
        }
    }
}

#[test]
fn links_to_existing_and_new_files_are_followed() {
    let bench = Bench::new();
    fs::create_dir(bench.path("far")).expect("a folder");
    fs::write(bench.path("far/there.csv"), "as it was").expect("a file");
    give(&bench.path("far/there.csv"), 0o664);
    // A relative link, a link to a link, and a dangling one.
    symlink("far/there.csv", bench.path("link.csv")).expect("a link");
    symlink("link.csv", bench.path("second.csv")).expect("a link");
    symlink("far/new.csv", bench.path("dangling.csv")).expect("a link");
    symlink("round.csv", bench.path("round.csv")).expect("a link");
    let is_link = |name: &str| {
        fs::symlink_metadata(bench.path(name)).expect("a link").file_type().is_symlink()
    };
    for (name, target, expected) in [
        ("second.csv", "far/there.csv", 0o664),
        ("dangling.csv", "far/new.csv", 0o644),
        ("dangling.csv", "far/new.csv", 0o644),
    ] {
        bench.done("022", &format!("{RUN} {name}"));
        assert!(is_link(name), "{name} was replaced by a file");
        assert!(bench.is_new(target), "{target}");
        assert_eq!(mode(&bench.path(target)), expected, "{target}");
    }
    assert!(is_link("link.csv"));
    // A circular link is named.
    let output = bench.vm("022", &format!("{RUN} round.csv"));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("round.csv: "), "{message}");
    assert!(is_link("round.csv"));
}

/// Pipes and devices are written directly.
#[test]
fn pipes_and_devices_are_written_directly() {
    let bench = Bench::new();
    bench.done("022", &format!("{RUN} /dev/stdout > piped.csv"));
    let output = bench.vm("022", &format!("{RUN} /dev/stdout"));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("t_s,force_n") && output.status.success(), "{text}");
    let output = bench.vm("022", &format!("{RUN} /dev/full"));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("/dev/full: "), "{message}");
}

/// If the temporary file cannot be created, the error names the requested file.
#[cfg(target_os = "linux")]
#[test]
fn an_error_names_the_requested_file() {
    let bench = Bench::new();
    let output = bench.vm("022", &format!("{RUN} /proc/out.csv"));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("/proc/out.csv: "), "{message}");
    assert!(!message.contains(".tmp"), "{message}");
}

/// All output goes through one function, except files for programs that are started (in temporary
/// folders) and the table of a sweep, which grows row by row.
#[test]
fn all_output_goes_through_one_function() {
    fn look(folder: &Path, found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                look(&path, found);
                continue;
            }
            let text = fs::read_to_string(&path).expect("a source");
            let writes = ["fs::write(", "File::create", "OpenOptions", ".persist(", "fs::rename("];
            if writes.iter().any(|one| text.contains(one)) {
                let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
                found.push(path.strip_prefix(root).expect("inside").display().to_string());
            }
        }
    }
    let mut found = Vec::new();
    look(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut found);
    found.sort();
    assert_eq!(found, ["cycles/bench.rs", "cycles/boot.rs", "ledger.rs", "output_file.rs"]);
}
