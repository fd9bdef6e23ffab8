//! The command line `vm`.

mod arm;
mod closed_loop;
mod cycles;
mod emit;
mod fit;
mod hil;
mod measured;
mod muscles;
mod plot;
mod recover;
mod run;
mod stack;
mod sweep;
mod verify;

use crate::engine::Arithmetic;
use crate::figures;
use crate::golden;
use crate::markdown_table::markdown_table;
use crate::output_file::unless_broken;
use crate::readme;
use crate::reference::Mode;
use crate::report;
use crate::trace;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Virtual Muscle on the host: run a muscle, verify every arithmetic, reproduce the paper's
/// figures.
#[derive(Debug, Parser)]
#[command(name = "vm", version)]
struct CommandLine {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a muscle over a file of inputs.
    Run(run::RunArgs),
    /// Compare every arithmetic with the reference, and the reference with the authors' traces (the
    /// default command).
    Verify(verify::VerifyArgs),
    /// Plot a run as SVG.
    Plot(plot::PlotArgs),
    /// Compare the bits of every scenario's state with the golden ones.
    Golden(GoldenArgs),
    /// Estimate cycles per tick on a Cortex-M4F from the instructions that QEMU executes.
    Cycles(cycles::CyclesArgs),
    /// Write a muscle as constant words for firmware that does not build it.
    Emit(emit::EmitArgs),
    /// Compute the stimulator's deepest stack and free memory from its image.
    Stack(stack::StackArgs),
    /// Play a trace of inputs to the firmware, on a board or in QEMU, and compare every bit with
    /// the host's.
    Hil(hil::HilArgs),
    /// Simulate a planar two-joint arm with six muscles at constant activations.
    Arm(arm::ArmArgs),
    /// Compare controllers of stimulation in closed loop on patients that differ from the model.
    Loop(closed_loop::LoopArgs),
    /// Reproduce figures 3 to 7 of the paper as SVG and CSV, and check its claims.
    Figures(FiguresArgs),
    /// Write every measurement to one HTML page that needs no network.
    Report(ReportArgs),
    /// Compare every arithmetic with the reference over a grid or a random sample of muscles and
    /// inputs.
    Sweep(sweep::SweepArgs),
    /// Fit muscle parameters to recordings, with standard errors and correlations.
    Fit(fit::FitArgs),
    /// Write a recording protocol that determines a muscle's parameters, for `vm fit`.
    Protocol(recover::ProtocolArgs),
    /// Fit synthetic patients with known parameters, and compare.
    Recover(recover::RecoverArgs),
    /// Compare the model with published recordings of real muscle.
    Measured(measured::MeasuredArgs),
    /// List the human muscles that `--muscle` takes by name, with their assumptions.
    Muscles,
    /// Compare the generated tables and the picture of the documentation with what is measured.
    Readme(ReadmeArgs),
}

impl Default for Command {
    fn default() -> Self {
        Self::Verify(verify::VerifyArgs::default())
    }
}

#[derive(Debug, Args)]
struct GoldenArgs {
    /// Replace the golden bits by those of this build, in host-sim/data of the checkout that this
    /// program was built in.
    #[arg(long, requires = "reason")]
    bless: bool,
    /// Reason for the change.
    #[arg(long, requires = "bless")]
    reason: Option<String>,
}

#[derive(Debug, Args)]
struct FiguresArgs {
    /// Output folder; created if missing.
    #[arg(long, visible_alias = "out", default_value = "figures")]
    output: PathBuf,
    /// Arithmetic.
    #[arg(long, value_enum, default_value_t = Arithmetic::F32)]
    arithmetic: Arithmetic,
}

#[derive(Debug, Args)]
struct ReportArgs {
    /// Output page, in HTML.
    #[arg(long, visible_alias = "out", default_value = "report.html")]
    output: PathBuf,
    /// Output of `vm cycles --json`, if cycles were measured.
    #[arg(long, value_name = "FILE")]
    cycles: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct ReadmeArgs {
    /// Write the tables and the picture, in the checkout that this program was built in.
    #[arg(long)]
    write: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ModeName {
    /// Natural continuous recruitment.
    Continuous,
    /// Intramuscular FES.
    Fes,
    /// Natural discrete recruitment of motor units; the muscle file gives `units`.
    Discrete,
    /// The same with the effective length of each unit (VM 3.x).
    DiscreteLeff,
}

impl From<ModeName> for Mode {
    fn from(name: ModeName) -> Self {
        match name {
            ModeName::Continuous => Self::Continuous,
            ModeName::Fes => Self::Fes,
            ModeName::Discrete => Self::Discrete,
            ModeName::DiscreteLeff => Self::DiscreteEffectiveLength,
        }
    }
}

/// Exit code when input is refused.
const REFUSED: u8 = 2;

/// Runs the command line: 0 if all is well, 1 if `verify` found a failure, 2 if the input was
/// refused.
pub fn main() -> ExitCode {
    let command = CommandLine::parse().command.unwrap_or_default();
    let done = match command {
        Command::Run(args) => run::run(&args).map(|()| true),
        Command::Verify(args) => verify::run(&args),
        Command::Plot(args) => plot::run(&args).map(|()| true),
        Command::Golden(args) => compare_bits(&args),
        Command::Cycles(args) => cycles::run(&args),
        Command::Emit(args) => emit::run(&args).map(|()| true),
        Command::Stack(args) => stack::run(&args),
        Command::Hil(args) => hil::run(&args).map(|()| true),
        Command::Arm(args) => arm::run(&args).map(|()| true),
        Command::Loop(args) => closed_loop::run(&args).map(|()| true),
        Command::Figures(args) => make_figures(&args).map(|()| true),
        Command::Report(args) => write_report(&args).map(|()| true),
        Command::Sweep(args) => sweep::run(&args).map(|()| true),
        Command::Fit(args) => fit::run(&args).map(|()| true),
        Command::Protocol(args) => recover::protocol(&args).map(|()| true),
        Command::Recover(args) => recover::recover(&args),
        Command::Measured(args) => measured::run(&args),
        Command::Muscles => muscles::run().map(|()| true),
        Command::Readme(args) => compare_readme(&args),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            complain(&error.to_string());
            ExitCode::from(REFUSED)
        }
    }
}

/// Prints a message on standard error, ignoring errors.
fn complain(message: &str) {
    let _nobody_listens = writeln!(std::io::stderr(), "vm: {message}");
}

/// Prints on standard output; an error if that fails, except for a closed pipe.
fn print(text: &dyn std::fmt::Display) -> std::io::Result<()> {
    unless_broken(writeln!(std::io::stdout(), "{text}"))
}

/// A file format: its name, and the endings of its files, the usual one first.
type Format = (&'static str, &'static [&'static str]);

const CSV: Format = ("CSV", &["csv", "txt"]);
const HTML: Format = ("HTML", &["html", "htm"]);

/// Refuses a file name with the ending of another format; a name without an ending is accepted.
fn check_ending(
    option: &str,
    path: &Path,
    (format, endings): Format,
) -> Result<(), Box<dyn Error>> {
    let Some(ending) = path.extension() else { return Ok(()) };
    if endings.iter().any(|known| ending.eq_ignore_ascii_case(known)) {
        return Ok(());
    }
    let (path, ending) = (path.display(), endings[0]);
    Err(format!("{option} {path}: only {format} is written, under a name that ends in .{ending}")
        .into())
}

fn compare_bits(args: &GoldenArgs) -> Result<bool, Box<dyn Error>> {
    if let Some(reason) = &args.reason {
        golden::bless(reason)?;
        return Ok(true);
    }
    let differences = golden::differences()?;
    for difference in &differences {
        complain(difference);
    }
    if differences.is_empty() {
        print(&"all bits are golden")?;
    }
    Ok(differences.is_empty())
}

fn make_figures(args: &FiguresArgs) -> Result<(), Box<dyn Error>> {
    let claims = figures::make(&args.output, args.arithmetic)?;
    let header = ["figure", "claim", "claimed", "held to", "measured", "agrees", "why not"];
    let mut table = markdown_table(&header, []);
    for claim in &claims {
        let (agrees, why) = if claim.agrees { ("yes", "") } else { ("no", claim.why) };
        let (figure, limit, measured) = (claim.figure, &claim.limit, &claim.measured);
        table.add_row([figure, claim.claim, claim.claimed, limit, measured, agrees, why]);
    }
    print(&table)?;
    Ok(())
}

fn write_report(args: &ReportArgs) -> Result<(), Box<dyn Error>> {
    // Check the paths before the measurements, which take minutes.
    check_ending("--output", &args.output, HTML)?;
    trace::check_folder(&args.output)?;
    if let Some(cycles) = &args.cycles
        && trace::same_file(&args.output, cycles)
    {
        let output = args.output.display();
        return Err(format!("--output {output}: must be another file than --cycles's").into());
    }
    let page = report::page(args.cycles.as_deref())?;
    trace::write_atomically(&args.output, page.as_bytes())?;
    Ok(())
}

fn compare_readme(args: &ReadmeArgs) -> Result<bool, Box<dyn Error>> {
    let mut all_current = true;
    let tables = readme::tables(&crate::verify::verify()?)?;
    for (place, generated) in tables.into_iter().chain([(readme::PICTURE, readme::picture()?)]) {
        if args.write {
            place.write(&generated)?;
        } else if !place.is_current(&generated)? {
            complain(&format!("{} has drifted: cargo vm readme --write", place.file()));
            all_current = false;
        }
    }
    Ok(all_current)
}
