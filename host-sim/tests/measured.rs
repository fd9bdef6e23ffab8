//! `vm measured`: a synthetic set of recordings with its own definition, missing sets and, if their
//! folder is given, recordings of real muscle.

use host_sim::engine::{self, Arithmetic};
use host_sim::fit::{Role, Search};
use host_sim::measured::{LeftOut, Row, mean, measure};
use host_sim::muscle_file;
use host_sim::reference::{Input, Mode};
use host_sim::trace::InputTrace;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const MUSCLE: &str = include_str!("../data/muscles/deltoid_posterior.toml");

/// Definition of the set: one frequency is fitted, another predicted.
const TRIALS: &str = "
noise_n = 1
[[trial]]
name = \"40 pps\"
role = \"fit\"
mode = \"fes\"
force = { file = \"forces.csv\", time = \"t_s\", value = \"at_40\" }
length = { constant = 0.155 }
activation = { constant = 1 }
stimulation_pps = { constant = 40 }
[[trial]]
name = \"15 pps\"
role = \"predict\"
mode = \"fes\"
force = { file = \"forces.csv\", time = \"t_s\", value = \"at_15\" }
length = { constant = 0.155 }
activation = { constant = 1 }
stimulation_pps = { constant = 15 }
[[free]]
name = \"max_isometric_force_n\"
bounds = [100, 600]
";

/// A folder with synthetic recordings of a muscle of 300 N, computed by the reference.
fn synthetic() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut muscle = muscle_file::parse(MUSCLE, Path::new("m.toml")).expect("a muscle").muscle;
    muscle.mass *= 300.0 / muscle.f0();
    let run = |frequency: f64| {
        let input = Input { activation: 1.0, path_length: 0.155, stimulation_frequency: frequency };
        let trace = InputTrace { start: 0.0, time_step: 1e-3, inputs: vec![input; 501] };
        let rows = engine::run(&muscle, Mode::Fes, Arithmetic::Reference, &trace).expect("a run");
        rows.into_iter().map(|row| row.0.force).collect::<Vec<f64>>()
    };
    let (at_40, at_15) = (run(40.0), run(15.0));
    let mut text = "t_s,at_40,at_15\n".to_owned();
    for tick in (0..=500).step_by(5) {
        let time = tick as f64 * 1e-3;
        text += &format!("{time},{:.6},{:.6}\n", at_40[tick], at_15[tick]);
    }
    let set = folder.path().join("synthetic");
    fs::create_dir(&set).expect("a folder");
    for (name, text) in [("muscle.toml", MUSCLE), ("trials.toml", TRIALS), ("forces.csv", &text)] {
        fs::write(set.join(name), text).expect("a file");
    }
    folder
}

fn vm(folder: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_vm"))
        .args(["measured", "--starts", "1", "--data"])
        .arg(folder)
        .args(more)
        .output()
        .expect("vm runs")
}

#[test]
fn a_new_set_is_read_and_missing_sets_are_reported() {
    let folder = synthetic();
    let done = vm(folder.path(), &["--json", "--allow-missing"]);
    let message = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success(), "{message}");
    let rows: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
    let rows = rows.as_array().expect("an array");
    assert_eq!(rows.len(), 8, "two trials, four models");
    let of = |trial: &str, left_out: &str| {
        rows.iter()
            .find(|row| row["trial"] == trial && row["left_out"] == left_out)
            .unwrap_or_else(|| panic!("{trial}, {left_out}"))
    };
    for (trial, role) in [("40 pps", "fit"), ("15 pps", "predict")] {
        let row = of(trial, "nothing");
        assert_eq!((&row["dataset"], &row["role"]), (&"synthetic".into(), &role.into()));
        assert!(row["published_mae_pct_f0"].is_null());
        for error in ["mae_pct_f0", "rms_pct_f0"] {
            let error = row[error].as_f64().expect("a number");
            assert!(error < 0.05, "the model that made it: {row}");
        }
    }
    // 1/L - 1 is not 0 here, so that n_f matters at 15 pps.
    let without = of("15 pps", "length dependence of Af")["mae_pct_f0"].as_f64();
    assert!(without.is_some_and(|error| error > 0.1), "{without:?}");

    let done = vm(folder.path(), &[]);
    let message = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(1), "{message}");
    for set in ["krylow_sandercock_1997", "herzog_leonard_2002"] {
        assert!(message.contains(&format!("SKIPPED {set}")), "{message}");
    }
}

/// The folder of real recordings; it is not in the repository.
const FOLDER: &str = "VM_MEASURED";

/// With one start; the scoreboard of docs/fitting.md is made with two, by its own command.
#[test]
fn real_muscle_is_predicted_as_well_as_by_published_models() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        use std::io::Write;
        // Directly to standard error: the harness captures the output of passing tests.
        let said = writeln!(std::io::stderr(), "SKIPPED: {FOLDER} does not name the recordings");
        return said.expect("standard error is open");
    };
    let search = Search { starts: 1, seed: 1 };
    let board = measure(Path::new(&folder), &[LeftOut::Nothing], &search).expect("a scoreboard");
    assert!(board.skipped.is_empty(), "{:?}", board.skipped);
    // Three published models have 3.3 to 8.9 % (Millard et al. 2013) over amplitudes that include
    // these three. The fit must not be worse than the worst of them; the mean must be within 5 %.
    let krylow: Vec<&Row> =
        board.rows.iter().filter(|row| row.dataset == "krylow_sandercock_1997").collect();
    assert_eq!(krylow.len(), 3);
    for row in krylow {
        assert!(row.mae_pct_f0 <= 8.9, "{row:?}");
    }
    let mean = mean(&board, "krylow_sandercock_1997", None, LeftOut::Nothing);
    assert!(mean <= 5.0, "Krylow & Sandercock: {mean} % of F0");
    // This model with three numbers fitted, none of them to a stretch, has at most 8 % for a
    // stretch of 3 mm and at most 19 % for 9 mm (shared/measured). With a stretch fitted as well it
    // must not be worse; 6 mm is in between. The goal of 8 % is missed because of residual force
    // enhancement, below.
    for (trial, most) in [("61", 8.0), ("45", 8.0), ("63", 13.5), ("47", 13.5), ("50", 19.0)] {
        let row = board.rows.iter().find(|row| row.trial == trial).expect("a trial");
        assert_eq!(row.role, Role::Predict.name());
        assert!(row.mae_pct_f0 <= most, "{row:?}");
    }
    // Residual force enhancement after a stretch, which the model lacks: less than a tenth of it is
    // left of the transient that the model does have.
    let of_9_mm: Vec<_> = board
        .enhancements
        .iter()
        .filter(|left| ["65", "50"].contains(&left.trial.as_str()))
        .collect();
    assert_eq!(of_9_mm.len(), 2);
    for left in of_9_mm {
        assert!(left.measured_pct_f0 > 5.0, "{left:?}");
        assert!(left.model_pct_f0.abs() < 0.1 * left.measured_pct_f0, "{left:?}");
    }
}
