//! `vm sweep`.

use super::{CSV, ModeName, check_ending, print};
use crate::engine::{Arithmetic, Class, mode_name, status_names};
use crate::ledger::Ledger;
use crate::markdown_table::markdown_table;
use crate::sweep::{KEYS, Promise, Space, Sweep, Variation};
use crate::trace::write_atomically;
use clap::{Args, ValueEnum};
use std::error::Error;
use std::path::{Path, PathBuf};

/// `vm sweep`: every arithmetic against the reference, over a grid or a random sample.
#[derive(Debug, Args)]
#[command(after_help = keys())]
pub struct SweepArgs {
    /// Output table, in CSV; an incomplete table of the same sweep is resumed.
    #[arg(long, visible_alias = "out", default_value = "sweep.csv")]
    output: PathBuf,
    /// Number of random cases per mode, instead of a grid.
    #[arg(long, value_name = "COUNT")]
    random: Option<usize>,
    /// Random seed.
    #[arg(long, default_value_t = 1, requires = "random")]
    seed: u64,
    /// Values of a key (listed below): key=value,value,... or, with --random, key=from:to.
    #[arg(long, value_name = "KEY=VALUES")]
    vary: Vec<String>,
    /// Recruitment modes.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["continuous", "fes"])]
    modes: Vec<ModeName>,
    /// Arithmetics to compare with the reference.
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["f32", "fixed"])]
    arithmetics: Vec<Arithmetic>,
    /// Accuracy class.
    #[arg(long, value_enum, default_value_t)]
    class: Class,
    /// Worst cases to list per arithmetic, with and without flags.
    #[arg(long, default_value_t = 5)]
    worst: usize,
    /// Write this case's muscle and inputs to the folder of --replay, instead of sweeping.
    #[arg(long, requires = "replay", conflicts_with = "output")]
    case: Option<usize>,
    /// Folder for muscle.toml and input.csv of --case; created if missing.
    #[arg(long, requires = "case", value_name = "FOLDER")]
    replay: Option<PathBuf>,
}

/// The keys of `--vary`: limits, default value in a grid, and default range of random values.
fn keys() -> String {
    let mut text = String::from("Keys of --vary (limits; in a grid; at random):\n");
    for key in KEYS {
        let ((least, most), (from, to)) = (key.limits, key.range);
        text.push_str(&format!(
            "  {:<22} {:<20} {:<5} {:<12} {}\n",
            key.name,
            format!("{least} to {most};"),
            format!("{};", key.nominal),
            format!("{from} to {to}"),
            key.meaning,
        ));
    }
    text
}

impl SweepArgs {
    fn sweep(&self) -> Result<Sweep, Box<dyn Error>> {
        if self.arithmetics.contains(&Arithmetic::Reference) {
            return Err("--arithmetics reference: the others are compared with it".into());
        }
        let variations: Vec<Variation> =
            self.vary.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
        let twice = |index: &usize| self.arithmetics[..*index].contains(&self.arithmetics[*index]);
        if let Some(twice) = (1..self.arithmetics.len()).find(twice) {
            let name = self.arithmetics[twice].name();
            return Err(format!("--arithmetics {name}: given twice").into());
        }
        let modes = self.modes.iter().map(|&mode| mode.into()).collect();
        let random = self.random.map(|count| (count, self.seed));
        Ok(Sweep {
            space: Space::new(&variations, modes, random)?,
            arithmetics: self.arithmetics.clone(),
            class: self.class,
            arguments: self.arguments(&variations),
        })
    }

    /// Arguments that identify the sweep.
    fn arguments(&self, variations: &[Variation]) -> String {
        let mut arguments = Vec::new();
        if let Some(count) = self.random {
            arguments.push(format!("--random {count} --seed {}", self.seed));
        }
        arguments.extend(variations.iter().map(|variation| format!("--vary {variation}")));
        arguments.push(format!("--modes {}", names(&self.modes)));
        arguments.push(format!("--arithmetics {}", names(&self.arithmetics)));
        if self.class != Class::Standard {
            arguments.push(format!("--class {}", names(&[self.class])));
        }
        arguments.join(" ")
    }
}

/// The names of values on the command line.
fn names<T: ValueEnum>(values: &[T]) -> String {
    let names = values.iter().filter_map(T::to_possible_value);
    names.map(|value| value.get_name().to_owned()).collect::<Vec<_>>().join(",")
}

/// Runs a sweep, or writes one of its cases to files.
pub fn run(args: &SweepArgs) -> Result<(), Box<dyn Error>> {
    let sweep = args.sweep()?;
    if let (Some(case), Some(folder)) = (args.case, &args.replay) {
        return replay(&sweep, case, folder);
    }
    let output = &args.output;
    check_ending("--output", output, CSV)?;
    let ledger = sweep.run(output)?;
    let header = ["arithmetic", "max % F0", "status", "replay: cargo vm sweep ..."];
    let mut table = markdown_table(&header, []);
    for worst in sweep.worst(&ledger, args.worst) {
        let case = worst.case;
        table.add_row([
            worst.arithmetic.name().to_owned(),
            format!("{:.4}", worst.max_pct_f0),
            worst.status,
            format!("{} --case {case} --replay case-{case}", sweep.arguments),
        ]);
    }
    print(&table)?;
    let is_promised =
        args.vary.is_empty() && args.random.is_some_and(|n| n >= Promise::LEAST_CASES);
    let (summary, broken) = summary(&sweep, &ledger, is_promised);
    print(&summary)?;
    let refused = ledger.rows().filter(|(_, row)| row.last().is_some_and(|p| !p.is_empty()));
    let (count, refused) = (sweep.space.count(), refused.count());
    print(&format!("{count} cases in {}, {refused} with a refusal", output.display()))?;
    match broken.as_slice() {
        [] => Ok(()),
        broken => Err(format!("promise broken: {}", broken.join(", ")).into()),
    }
}

/// The table of what unflagged cases exceed, and the arithmetics that break the promise, if there
/// is one: classes promise it of random muscles in the default ranges only.
fn summary(sweep: &Sweep, ledger: &Ledger, is_promised: bool) -> (String, Vec<&'static str>) {
    let promise = Promise::of(sweep.class);
    let beyond = format!("beyond {} % F0, %", promise.common_pct_f0);
    let header = ["class", "arithmetic", "cases", "flagged, %", &beyond, "worst, % F0", "promised"];
    let mut table = markdown_table(&header, []);
    let mut broken = Vec::new();
    for summary in sweep.summaries(ledger) {
        let keeps = summary.keeps(promise);
        let kept = if keeps { "kept" } else { "BROKEN" };
        if is_promised && !keeps {
            broken.push(summary.arithmetic.name());
        }
        let (share, worst) = (promise.beyond_pct, promise.worst_pct_f0);
        table.add_row([
            sweep.class.name().to_owned(),
            summary.arithmetic.name().to_owned(),
            summary.cases.to_string(),
            format!("{:.2}", summary.flagged_pct),
            format!("{:.2}", summary.beyond_pct),
            format!("{:.3}", summary.worst_pct_f0),
            if is_promised { format!("{share} %, {worst}: {kept}") } else { "-".to_owned() },
        ]);
    }
    let note = format!(
        "Unflagged cases; a promise is that of --random from {} on without --vary.",
        Promise::LEAST_CASES
    );
    (format!("{table}\n{note}"), broken)
}

/// Writes a case to files, and prints its errors.
fn replay(sweep: &Sweep, number: usize, folder: &Path) -> Result<(), Box<dyn Error>> {
    let count = sweep.space.count();
    if number >= count {
        return Err(format!("--case {number}: must be below {count}, the number of cases").into());
    }
    let case = sweep.space.case(number);
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let (muscle, input) = (folder.join("muscle.toml"), folder.join("input.csv"));
    // So that `vm run` takes the class that was swept.
    let text = format!("class = \"{}\"\n{}", sweep.class.name(), case.muscle_file());
    write_atomically(&muscle, text.as_bytes())?;
    write_atomically(&input, case.input_file().as_bytes())?;
    let mode = mode_name(case.mode);
    match case.errors(&sweep.arithmetics, sweep.class) {
        Ok(errors) => {
            for (arithmetic, measured) in sweep.arithmetics.iter().zip(errors) {
                let name = arithmetic.name();
                print(&match measured {
                    Ok((error, status)) => {
                        format!("{name}: max {:.6} % of F0, {}", error.max, status_names(status))
                    }
                    Err(refusal) => refusal,
                })?;
            }
        }
        Err(problem) => print(&problem)?,
    }
    for arithmetic in sweep.arithmetics.iter().chain([&Arithmetic::Reference]) {
        print(&format!(
            "cargo vm run --muscle '{}' --input '{}' --output '{}' --mode {mode} \
             --arithmetic {name}",
            muscle.display(),
            input.display(),
            folder.join(arithmetic.name()).with_extension("csv").display(),
            name = arithmetic.name(),
        ))?;
    }
    Ok(())
}
