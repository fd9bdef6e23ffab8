//! `vm fit`: a muscle fitted to recordings.

use super::print;
use crate::fit::{CONFIRMED, Fit, FitError, Search, Start, Trials, fit, fitted_file, page};
use crate::markdown_table::markdown_table;
use crate::trace;
use clap::Args;
use comfy_table::Table;
use std::error::Error;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct FitArgs {
    /// Initial muscle, in TOML, or a name of `vm muscles`.
    #[arg(long)]
    muscle: PathBuf,
    /// Recordings and free parameters, in TOML (host-sim/docs/trials.md).
    #[arg(long)]
    trials: PathBuf,
    /// Folder of the recordings, if not that of the list.
    #[arg(long)]
    data: Option<PathBuf>,
    /// Fitted muscle, in TOML.
    #[arg(long, visible_alias = "out", default_value = "fitted.toml")]
    output: PathBuf,
    /// Report of every trial and parameter, in HTML.
    #[arg(long)]
    report: Option<PathBuf>,
    #[command(flatten)]
    search: SearchArgs,
}

/// How to search.
#[derive(Clone, Copy, Debug, Args)]
pub struct SearchArgs {
    /// Number of starts: the first at the muscle's values, the others random.
    #[arg(long, default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// Random seed of the starts; the same seed gives the same bytes.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

impl SearchArgs {
    /// The search.
    pub fn search(self) -> Search {
        Search { starts: self.starts.into(), seed: self.seed }
    }
}

pub fn run(args: &FitArgs) -> Result<(), Box<dyn Error>> {
    // Check the paths before the fit, which takes minutes.
    for (option, output) in [("--output", Some(&args.output)), ("--report", args.report.as_ref())] {
        let Some(output) = output else { continue };
        trace::check_folder(output)?;
        for (read, file) in [("--muscle", &args.muscle), ("--trials", &args.trials)] {
            if trace::same_file(output, file) {
                let output = output.display();
                return Err(format!("{option} {output}: must be another file than {read}'s").into());
            }
        }
    }
    super::check_ending("--output", &args.output, ("TOML", &["toml"]))?;
    if let Some(report) = &args.report {
        super::check_ending("--report", report, super::HTML)?;
    }
    if args.report.as_ref() == Some(&args.output) {
        return Err("--report: must be another file than --output's".into());
    }
    let start = Start::read(&args.muscle)?;
    let own = args.trials.parent().unwrap_or(Path::new("."));
    let folder = args.data.as_deref().unwrap_or(own);
    let trials = Trials::read(&args.trials, folder, &start.named)?;
    let search = args.search.search();
    let stated = trials.stated;
    let fit =
        fit(&start.named, start.keep_force, trials, &search, &CONFIRMED).map_err(|error| {
            // The others name their file.
            match error {
                FitError::Undetermined(_) | FitError::Start { .. } | FitError::NoSolution(..) => {
                    format!("{}: {error}", args.trials.display())
                }
                _ => error.to_string(),
            }
        })?;
    let origin = format!(
        "Fitted by vm fit to {}, from {}, {} starts, seed {}.",
        file_name(&args.trials),
        file_name(&args.muscle),
        search.starts,
        search.seed
    );
    let text = fitted_file(&start.table, &fit, &origin);
    let report = args.report.as_ref().map(|_| page(&fit, &origin)).transpose()?;
    trace::write_atomically(&args.output, text.as_bytes())?;
    if let (Some(path), Some(page)) = (&args.report, report) {
        trace::write_atomically(path, page.as_bytes())?;
    }
    print(&parameters(&fit))?;
    for pair in &fit.pairs {
        let [one, other] = &pair.names;
        print(&format!("{one} and {other} trade off: correlation {:.3}", pair.correlation))?;
    }
    print(&trials_table(&fit))?;
    let (starts, near) = fit.starts;
    print(&format!(
        "residuals {:.2} times the stated noise; {near} of {starts} starts ended at the best",
        fit.noise_ratio
    ))?;
    if fit.is_below_noise() {
        print(&format!(
            "residuals far below {stated}: the intervals are those of the stated noise"
        ))?;
    }
    for confirmed in &fit.confirmed {
        let (max, rms) = confirmed.difference;
        let name = confirmed.arithmetic.name();
        print(&format!("{name}: {max:.3} % of F0 from f64 at most, {rms:.4} % rms"))?;
    }
    Ok(())
}

/// File name without the folder, which would reveal details of the machine.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn parameters(fit: &Fit) -> Table {
    let mut table =
        markdown_table(&["parameter", "value", "standard error", "95 % from", "to", "note"], []);
    for estimate in &fit.estimates {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.5e}"));
        table.add_row([
            estimate.name.clone(),
            number(Some(estimate.value)),
            number(estimate.standard_error),
            number(estimate.interval().map(|interval| interval.0)),
            number(estimate.interval().map(|interval| interval.1)),
            estimate.note().to_owned(),
        ]);
    }
    table
}

fn trials_table(fit: &Fit) -> Table {
    let mut table =
        markdown_table(&["trial", "role", "mae % F0", "rms % F0", "mean % F0", "status"], []);
    for trial in &fit.trials {
        table.add_row([
            trial.name.clone(),
            trial.role.name().to_owned(),
            format!("{:.2}", trial.mae_pct_f0),
            format!("{:.2}", trial.rms_pct_f0),
            format!("{:+.2}", trial.bias_pct_f0),
            trial.status_names(),
        ]);
    }
    table
}
