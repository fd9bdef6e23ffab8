//! `vm protocol` and `vm recover`.

use super::fit::SearchArgs;
use super::{ModeName, print};
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
    /// The muscle that is expected, in TOML, or its name in `vm muscles`; without it, the one of
    /// `vm recover`.
    #[arg(long)]
    muscle: Option<PathBuf>,
    /// How it is recruited.
    #[arg(long, value_enum)]
    mode: RecordedMode,
    /// The folder of the inputs and of trials.toml; made if it is not there.
    #[arg(long)]
    out: PathBuf,
}

#[derive(Debug, Args)]
pub struct RecoverArgs {
    /// The mean of the patients, in TOML, or its name in `vm muscles`.
    #[arg(long)]
    muscle: Option<PathBuf>,
    /// How many patients of each mode.
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    patients: u16,
    /// How they are recruited.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["fes", "continuous"])]
    modes: Vec<RecordedMode>,
    /// Where their rows go, in CSV. If there are some already, of the same patients, it goes on
    /// with the others.
    #[arg(long)]
    output: PathBuf,
    /// Print the summary as JSON instead of tables.
    #[arg(long)]
    json: bool,
    /// Write the tables into docs/fitting.md.
    #[arg(long)]
    write: bool,
    /// How many starts each fit has.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// What patients, noise and starts are drawn from.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The muscle that is named, or the one that is built in.
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
    std::fs::create_dir_all(&args.out).map_err(|e| format!("{}: {e}", args.out.display()))?;
    recover::write(&start.named, mode, &args.out)?;
    let bouts = recover::bouts(mode, start.named.muscle.fatigue.is_some());
    let all: f64 = bouts.iter().map(|bout| bout.seconds).sum();
    let driven = recover::stimulated(&bouts);
    print(&format!("{} recordings, {all:.1} s, driven for {driven:.1} s", bouts.len()))?;
    Ok(())
}

#[derive(Serialize)]
struct Recovery<'a> {
    patients: u16,
    seed: u64,
    modes: &'a [Summary],
}

/// Recovers patients; true if force is predicted as well as it is meant to be.
pub fn recover(args: &RecoverArgs) -> Result<bool, Box<dyn Error>> {
    let start = muscle(args.muscle.as_deref())?;
    let twice = |index: &usize| args.modes[..*index].contains(&args.modes[*index]);
    if (1..args.modes.len()).any(|index| twice(&index)) {
        return Err("--modes: one is given twice".into());
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
        readme::RECOVERY.write(&recover::text(&found))?;
    }
    Ok(found.iter().all(Summary::predicts))
}
