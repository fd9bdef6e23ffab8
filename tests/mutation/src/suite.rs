//! The tests of a package: which of them reach which mutants, and which of them fail.

use crate::compile::Program;
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Output};

/// Most CPU time for all tests of one mutant.
const BUDGET_MS: u64 = 20_000;
/// Tests that take less together run in one process.
const TOGETHER_MS: u64 = 150;
/// Longest time of a run on the clock, s. Only a machine that is busy with something else, or a
/// test that sleeps for ever, takes that long: nothing is known of the mutant then.
const PATIENCE_S: u64 = 900;

/// One test.
#[derive(Clone, Debug)]
pub struct Test {
    program: Program,
    /// Its name.
    pub name: String,
    cpu_ms: u64,
    reaches: HashSet<usize>,
    /// How many mutants of the source at hand it noticed.
    pub noticed: u64,
}

/// What the tests made of a mutant.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// This test failed.
    Caught(String),
    /// One of these tests did not end.
    Timeout(String),
    /// No test failed that reached it.
    Survived,
    /// No test reached it.
    Unreached,
    /// These tests had no CPU for a verdict.
    Starved(String),
}

/// How a run of tests ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    Passed,
    Failed,
    /// All of its CPU time was taken.
    OutOfCpu,
    /// The clock ran out, not the CPU time.
    OutOfPatience,
    /// They did not run.
    Broken,
}

/// Of a run, by the exit code of `timeout`: 128 and the signal that ended its command, if one did.
/// It may end by that signal, too.
fn end(status: ExitStatus) -> End {
    const XCPU: i32 = 24;
    let code = status.code().or_else(|| status.signal().map(|signal| 128 + signal));
    match code {
        Some(0) => End::Passed,
        // A failed test; instructions and accesses that are not allowed, and aborts.
        Some(101 | 132..=136 | 139) => End::Failed,
        Some(code) if code == 128 + XCPU => End::OutOfCpu,
        // What it says of itself, and of a command that was killed: it needed this, or memory ran
        // out elsewhere.
        Some(124 | 137) => End::OutOfPatience,
        _ => End::Broken,
    }
}

/// CPU time for all tests of one mutant: `VM_BUDGET_MS`, if that is less. What a first look with
/// less leaves as survivors, `again` looks at.
fn budget_ms() -> u64 {
    let less = std::env::var("VM_BUDGET_MS").ok().and_then(|text| text.parse().ok());
    less.unwrap_or(BUDGET_MS).min(BUDGET_MS)
}

/// Everything that children have taken so far.
fn children_ms() -> u64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Behind the name in brackets: the 14th and 15th from there; a tick is 10 ms.
    let behind = stat.rsplit(')').next().unwrap_or_default();
    let fields: Vec<u64> =
        behind.split_whitespace().map(|field| field.parse().unwrap_or(0)).collect();
    10 * fields.get(13..15).map_or(0, |both| both.iter().sum())
}

/// Runs these tests of a program, one after the other.
fn run(
    program: &Program,
    names: &[&str],
    seconds: u64,
    environment: &[(&str, &str)],
) -> Result<Output, String> {
    // What takes all memory is stopped, too. SIGXCPU comes at the soft limit only.
    let limits = format!("ulimit -c 0; ulimit -S -t {seconds}; ulimit -v 4000000; exec \"$@\"");
    Command::new("timeout")
        .args(["--kill-after=1", &PATIENCE_S.to_string()])
        // Beside other work; a build is as quick as any.
        .args(["nice", "-n", "5", "sh", "-c", &limits, "sh"])
        .arg(&program.path)
        .args(names)
        .args(["--exact", "--test-threads=1"])
        // Nobody reads where a test failed.
        .env("RUST_BACKTRACE", "0")
        .envs(environment.iter().copied())
        .current_dir(&program.folder)
        .output()
        .map_err(|error| format!("{}: {error}", program.path.display()))
}

/// CPU time that a test may take to be among them, s: `VM_TEST_S`, or as much as any needs.
fn most_of_a_test_s() -> u64 {
    std::env::var("VM_TEST_S").ok().and_then(|text| text.parse().ok()).unwrap_or(120)
}

/// Whether a test is not among them: its name begins with a word of `VM_SKIP`.
fn is_skipped(name: &str) -> bool {
    let skip = std::env::var("VM_SKIP").unwrap_or_default();
    skip.split_whitespace().any(|word| name.starts_with(word))
}

/// Finds all tests and what they reach; all of them have to pass. One that takes too long is left
/// out, and notices nothing.
pub fn trace(programs: &[Program], log: &Path) -> Result<Vec<Test>, String> {
    let mut tests = Vec::new();
    for program in programs {
        let output = Command::new(&program.path)
            .args(["--list", "--format", "terse"])
            .current_dir(&program.folder)
            .output()
            .map_err(|error| format!("{}: {error}", program.path.display()))?;
        for line in String::from_utf8_lossy(&output.stdout).lines() {
            let Some(name) = line.strip_suffix(": test").filter(|name| !is_skipped(name)) else {
                continue;
            };
            let _ = fs::remove_file(log);
            let before = children_ms();
            let environment =
                [("VM_MUTANT", "trace"), ("VM_MUTANT_LOG", log.to_str().unwrap_or_default())];
            let output = run(program, &[name], most_of_a_test_s(), &environment)?;
            if end(output.status) == End::OutOfCpu {
                eprintln!("{name}: left out, takes more than {} s", most_of_a_test_s());
                continue;
            }
            if end(output.status) != End::Passed {
                let text = String::from_utf8_lossy(&output.stdout);
                return Err(format!("{name} without a mutant: {}\n{text}", output.status));
            }
            let cpu_ms = (children_ms() - before).max(1);
            if cpu_ms > 1_000 {
                eprintln!("{name}: {cpu_ms} ms");
            }
            let reaches = reached(log);
            let (program, name) = (program.clone(), name.to_owned());
            tests.push(Test { program, name, cpu_ms, reaches, noticed: 0 });
        }
    }
    if tests.is_empty() {
        return Err("no tests".into());
    }
    Ok(tests)
}

/// The mutants that a log names.
fn reached(log: &Path) -> HashSet<usize> {
    let text = fs::read_to_string(log).unwrap_or_default();
    text.lines().filter_map(|line| line.parse().ok()).collect()
}

/// All mutants that any test reaches.
pub fn reached_by(tests: &[Test]) -> HashSet<usize> {
    tests.iter().flat_map(|test| test.reaches.iter().copied()).collect()
}

/// Sum of the time of all tests that reach a mutant.
pub fn cost_ms(tests: &[Test], mutant: usize) -> u64 {
    tests.iter().filter(|test| test.reaches.contains(&mutant)).map(|test| test.cpu_ms).sum()
}

/// Runs the tests of a mutant that is chosen at run time.
pub fn chosen(tests: &mut [Test], mutant: usize, log: &Path) -> Result<Verdict, String> {
    let reaching: Vec<usize> =
        (0..tests.len()).filter(|&test| tests[test].reaches.contains(&mutant)).collect();
    if reaching.is_empty() {
        return Ok(Verdict::Unreached);
    }
    let _ = fs::remove_file(log);
    let number = mutant.to_string();
    let log_name = log.to_str().unwrap_or_default();
    let verdict =
        first_failure(tests, reaching, &[("VM_MUTANT", &number), ("VM_MUTANT_LOG", log_name)])?;
    // A verdict about nothing is none.
    if !reached(log).contains(&mutant) {
        return match verdict {
            Verdict::Starved(_) => Ok(verdict),
            Verdict::Survived => Ok(Verdict::Unreached),
            other => Err(format!("{other:?}, but mutant {mutant} was not reached")),
        };
    }
    Ok(verdict)
}

/// Runs the tests of programs with one change built into them; `timed` knows how long they take.
pub fn rebuilt(programs: &[Program], timed: &mut [Test]) -> Result<Verdict, String> {
    let by_name: BTreeMap<_, _> =
        programs.iter().map(|program| (program.name(), program)).collect();
    let mut built = Vec::new();
    for (index, test) in timed.iter_mut().enumerate() {
        if let Some(&program) = by_name.get(&test.program.name()) {
            test.program = program.clone();
            built.push(index);
        }
    }
    if built.is_empty() {
        return Err("no program has these tests".into());
    }
    first_failure(timed, built, &[])
}

fn first_failure(
    tests: &mut [Test],
    mut reaching: Vec<usize>,
    environment: &[(&str, &str)],
) -> Result<Verdict, String> {
    // Those that noticed mutants of this source first, then the quickest.
    reaching.sort_by_key(|&test| tests[test].cpu_ms * 100 / (1 + tests[test].noticed));
    let (begin, budget_ms) = (children_ms(), budget_ms());
    let mut rest = &reaching[..];
    while let Some(&first) = rest.first() {
        let spent = children_ms() - begin;
        if spent >= budget_ms {
            break;
        }
        let (mut sum, mut count) = (0, 0);
        for &test in rest {
            sum += tests[test].cpu_ms;
            let fits = sum <= TOGETHER_MS || count == 0;
            if tests[test].program.path != tests[first].program.path || !fits {
                break;
            }
            count += 1;
        }
        let (now, later) = rest.split_at(count);
        rest = later;
        let expected: u64 = now.iter().map(|&test| tests[test].cpu_ms).sum();
        // A test takes as long as it did, or some times that where a mutant makes it busy.
        let (most_ms, left_ms) = (5 * expected + 2_000, BUDGET_MS - spent);
        let names: Vec<&str> = now.iter().map(|&test| &*tests[test].name).collect();
        let seconds = most_ms.min(left_ms).div_ceil(1000);
        let output = run(&tests[first].program, &names, seconds, environment)?;
        let text = String::from_utf8_lossy(&output.stdout);
        let failed = text.lines().find_map(|line| {
            line.strip_prefix("test ")?.strip_suffix(" ... FAILED").map(str::to_owned)
        });
        let all = names.join(" ");
        match (failed, end(output.status)) {
            (_, End::Passed) => {}
            (Some(name), _) => {
                if let Some(test) = tests.iter_mut().find(|test| test.name == name) {
                    test.noticed += 1;
                }
                return Ok(Verdict::Caught(name));
            }
            (None, End::Failed) => return Ok(Verdict::Caught(all)),
            (None, End::OutOfPatience) => return Ok(Verdict::Starved(all)),
            (None, End::Broken) => {
                let text = String::from_utf8_lossy(&output.stderr);
                return Err(format!("{all}: {}\n{text}", output.status));
            }
            // What the tests before have left of the budget was too little to blame the mutant.
            (None, End::OutOfCpu) if left_ms < most_ms && spent > 0 => break,
            (None, End::OutOfCpu) => return Ok(Verdict::Timeout(all)),
        }
    }
    Ok(Verdict::Survived)
}

#[cfg(test)]
mod tests {
    use super::{End, Program, end, run};
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn only_a_failed_test_and_its_own_cpu_time_are_held_against_a_mutant() {
        let folder = std::env::temp_dir().join(format!("suite-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        for (does, ends) in [
            ("exit 0", End::Passed),
            ("exit 101", End::Failed),
            ("kill -ABRT $$", End::Failed),
            ("while :; do :; done", End::OutOfCpu),
            // By whom, nobody knows: where memory has run out, by the kernel.
            ("kill -KILL $$", End::OutOfPatience),
            ("exit 124", End::OutOfPatience),
            ("no-such-command", End::Broken),
        ] {
            let path = folder.join("program");
            fs::write(&path, format!("#!/bin/sh\n{does}\n")).expect("a script");
            fs::set_permissions(&path, fs::Permissions::from_mode(0o700)).expect("its owner");
            let program = Program { path, folder: folder.clone() };
            let output = run(&program, &["a_test"], 1, &[]).expect("it runs");
            assert_eq!(end(output.status), ends, "{does}: {}", output.status);
        }
        fs::remove_dir_all(folder).expect("its folder");
    }
}
