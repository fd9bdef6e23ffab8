//! `vm protocol` and `vm recover`.

use super::fit::SearchArgs;
use super::{CSV, ModeName, check_ending, print};
use crate::fit::Start;
use crate::readme;
use crate::recover::{self, Study, Summary, summaries};
use crate::reference::Mode;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Modes that have a protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordedMode {
    /// Intramuscular FES.
    Fes,
    /// Natural continuous recruitment.
    Continuous,
}

impl From<RecordedMode> for Mode {
    fn from(mode: RecordedMode) -> Self {
        match mode {
            RecordedMode::Fes => ModeName::Fes.into(),
            RecordedMode::Continuous => ModeName::Continuous.into(),
        }
    }
}

#[derive(Debug, Args)]
pub struct ProtocolArgs {
    /// Expected muscle, in TOML, or a name of `vm muscles`. Default: that of `vm recover`.
    #[arg(long)]
    muscle: Option<PathBuf>,
    /// Recruitment mode.
    #[arg(long, value_enum)]
    mode: RecordedMode,
    /// Folder for the inputs and trials.toml; created if missing. Files of the same names are
    /// replaced.
    #[arg(long, visible_alias = "out")]
    output: PathBuf,
}

#[derive(Debug, Args)]
pub struct RecoverArgs {
    /// Mean of the patients, in TOML, or a name of `vm muscles`.
    #[arg(long)]
    muscle: Option<PathBuf>,
    /// Number of patients per mode.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    patients: u16,
    /// Recruitment modes.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["fes", "continuous"])]
    modes: Vec<RecordedMode>,
    /// Output table, in CSV; an incomplete table of the same study is resumed.
    #[arg(long, visible_alias = "out")]
    output: PathBuf,
    /// Print the summary as JSON instead of tables.
    #[arg(long)]
    json: bool,
    /// Write the tables to host-sim/docs/fitting.md of the checkout that this program was built in.
    #[arg(long)]
    write: bool,
    /// Number of starts per fit.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Random seed of patients, noise and starts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The given muscle or the built-in one.
fn muscle(path: Option<&Path>) -> Result<Start, Box<dyn Error>> {
    Ok(match path {
        Some(path) => Start::read(path)?,
        None => Start::parse(recover::MUSCLE, Path::new("recovery_muscle.toml"))?,
    })
}

/// Writes a protocol.
pub fn protocol(args: &ProtocolArgs) -> Result<(), Box<dyn Error>> {
    let start = muscle(args.muscle.as_deref())?;
    let mode = args.mode.into();
    let folder = &args.output;
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let tires = start.named.muscle.fatigue.is_some();
    let replaced = folder.join(recover::LIST).is_file();
    recover::write(&start.named, mode, folder)?;
    let bouts = recover::bouts(mode, tires);
    let all: f64 = bouts.iter().map(|bout| bout.seconds).sum();
    let driven = recover::stimulated(&bouts);
    let how = if replaced { "replaced" } else { "written" };
    print(&format!(
        "{} recordings, {all:.1} s, active for {driven:.1} s; their inputs and {} {how} in {}",
        bouts.len(),
        recover::LIST,
        folder.display(),
    ))?;
    if !tires {
        print(&"left out: the recording \"fatigue\", because the muscle has no table [fatigue]")?;
    }
    Ok(())
}

#[derive(Serialize)]
struct Recovery<'a> {
    patients: u16,
    seed: u64,
    modes: &'a [Summary],
}

/// Recovers patients; true if enough forces are predicted within the limit.
pub fn recover(args: &RecoverArgs) -> Result<bool, Box<dyn Error>> {
    check_ending("--output", &args.output, CSV)?;
    let start = muscle(args.muscle.as_deref())?;
    let twice = |index: &usize| args.modes[..*index].contains(&args.modes[*index]);
    if (1..args.modes.len()).any(|index| twice(&index)) {
        return Err("--modes: a mode is given twice".into());
    }
    let search = SearchArgs { starts: args.starts, seed: args.seed }.search();
    let modes = args.modes.iter().map(|&mode| mode.into()).collect();
    let study = Study { start, patients: args.patients.into(), modes, search };
    let ledger = study.run(&args.output)?;
    let found = summaries(&study, &ledger);
    if args.json {
        let recovery = Recovery { patients: args.patients, seed: args.seed, modes: &found };
        print(&serde_json::to_string_pretty(&recovery)?)?;
    } else {
        print(&recover::text(&found))?;
    }
    if args.write {
        let RecoverArgs { patients, seed, starts, .. } = args;
        let made =
            format!("`cargo vm recover --patients {patients} --seed {seed} --starts {starts}`");
        readme::RECOVERY.write(&format!("Made by {made}.\n\n{}", recover::text(&found)))?;
    }
    Ok(found.iter().all(Summary::predicts))
}
