//! `vm protocol` and `vm recover`: the protocol is valid and short, and the parameters of synthetic
//! patients are recovered.

use host_sim::engine::{self, Arithmetic};
use host_sim::fit::{Role, Search, Start};
use host_sim::recover::{self, Bout, Study, summaries};
use host_sim::reference::Mode;
use host_sim::trace;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Limit of stimulation time per patient, s.
const LONGEST: f64 = 180.0;

fn start() -> Start {
    Start::parse(recover::MUSCLE, Path::new("recovery_muscle.toml")).expect("a muscle")
}

fn vm(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("vm runs")
}

#[test]
fn a_protocol_can_be_run_and_takes_less_than_three_minutes() {
    let folder = tempfile::tempdir().expect("a folder");
    for (mode, name) in [(Mode::Fes, "fes"), (Mode::Continuous, "continuous")] {
        let done = vm(&["protocol", "--mode", name, "--output", name], folder.path());
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let (start, bouts) = (start(), recover::bouts(mode, true));
        let driven = recover::stimulated(&bouts);
        assert!(driven <= LONGEST, "{name}: {driven} s");
        assert_eq!(bouts.iter().filter(|bout| bout.role == Role::Predict).count(), 1);
        for bout in &bouts {
            let file = folder.path().join(name).join(format!("{}.csv", bout.name));
            let trace = trace::read_inputs(&file).expect("inputs as vm run takes them");
            for arithmetic in [Arithmetic::F32, Arithmetic::Fixed] {
                let rows =
                    engine::run(&start.named.muscle, mode, arithmetic, &trace).expect("a run");
                let flags = rows.iter().fold(vm_nostd::Status::empty(), |all, row| all | row.1);
                assert_eq!(engine::status_names(flags), "ok", "{name} {}", bout.name);
            }
        }
        // The list lacks only the recordings.
        fs::write(folder.path().join("m.toml"), recover::MUSCLE).expect("a file");
        let trials = format!("{name}/trials.toml");
        let fit = ["fit", "--muscle", "m.toml", "--trials", &trials, "--output", "fitted.toml"];
        let refused = vm(&fit, folder.path());
        assert_eq!(refused.status.code(), Some(2));
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(message.contains("recorded"), "{message}");
    }
}

#[test]
fn the_fes_protocol_covers_5_to_80_pps_and_three_lengths() {
    let bouts = recover::bouts(Mode::Fes, true);
    let fitted = || bouts.iter().filter(|bout| bout.role == Role::Fit);
    let extreme = |of: &dyn Fn(&Bout) -> Vec<f64>| {
        let all: Vec<f64> = fitted().flat_map(of).collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        (least, all.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    assert_eq!(extreme(&|bout| bout.pps.iter().map(|step| step.1).collect()), (5.0, 80.0));
    let held = |bout: &&Bout| bout.path.len() == 1;
    let mut lengths: Vec<f64> = fitted().filter(held).map(|bout| bout.path[0].1).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.dedup();
    assert_eq!(lengths.len(), 3);
    assert!(fitted().any(|bout| bout.name == "fatigue"));
    assert!(!recover::bouts(Mode::Fes, false).iter().any(|bout| bout.name == "fatigue"));
}

/// The requirements on a hundred patients (docs/fitting.md), for two per mode.
#[test]
fn parameters_are_recovered_and_unseen_force_is_predicted() {
    let modes = vec![Mode::Fes, Mode::Continuous];
    let study = Study { start: start(), patients: 2, modes, search: Search { starts: 1, seed: 1 } };
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("patients.csv");
    let ledger = study.run(&table).expect("a table");
    let found = summaries(&study, &ledger);
    for summary in &found {
        assert_eq!(summary.failed, 0, "{summary:?}");
        // 95 of 100 means all of two.
        assert!(summary.predicts(), "{summary:?}");
    }
    let (covered, intervals) = found
        .iter()
        .flat_map(|summary| &summary.parameters)
        .fold((0, 0), |(covered, intervals), p| (covered + p.covered, intervals + p.intervals));
    // Of 56 independent 95 % intervals 3 miss on average, and 10 or more with a probability of
    // 1/2,000.
    assert!(intervals >= 50 && covered + 9 >= intervals, "{covered} of {intervals}");

    // Interrupted before the last patient and resumed: the same bytes.
    let whole = fs::read_to_string(&table).expect("the table");
    let cut: String = whole.split_inclusive('\n').take(5).collect();
    assert!(whole.starts_with(&cut) && whole.lines().count() == 6);
    fs::write(&table, &cut).expect("a shorter table");
    study.run(&table).expect("gone on with");
    assert_eq!(fs::read_to_string(&table).expect("the table"), whole);
    // Another study does not resume it.
    let other = Study { search: Search { starts: 1, seed: 2 }, ..study };
    let refused = other.run(&table).expect_err("other patients").to_string();
    assert!(refused.contains("not a table of this run"), "{refused}");
}
