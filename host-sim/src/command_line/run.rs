//! `vm run`: a muscle over a file of inputs.

use super::{CSV, ModeName, check_ending, complain};
use crate::engine::{self, Arithmetic, Class};
use crate::model_muscle;
use crate::muscle_file::NamedMuscle;
use crate::muscles::find;
use crate::reference::{Mode, Muscle};
use crate::trace::{self, InputTrace, OutputRow};
use clap::{Args, ValueEnum};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use vm_nostd::Status;

#[derive(Debug, Args)]
pub struct RunArgs {
    /// Muscle, in TOML, or a name of `vm muscles`.
    #[arg(long)]
    muscle: PathBuf,
    /// Inputs, in CSV: t_s,activation,path_length_m,stim_hz, one row per tick; `-` is standard
    /// input.
    #[arg(long)]
    input: PathBuf,
    /// Outputs, in CSV; `-` is standard output.
    #[arg(long, visible_alias = "out", default_value = "run.csv")]
    output: PathBuf,
    /// Recruitment mode.
    #[arg(long, value_enum, default_value = "continuous")]
    mode: ModeName,
    /// Arithmetic.
    #[arg(long, value_enum, default_value_t = Arithmetic::F32)]
    arithmetic: Arithmetic,
    /// Accuracy class. Default: that of the muscle file, which is standard if it names none.
    #[arg(long, value_enum)]
    class: Option<Class>,
}

/// Runs the muscle, writes its outputs, and prints a summary on standard error.
pub fn run(args: &RunArgs) -> Result<(), Box<dyn Error>> {
    let NamedMuscle { muscle, class, .. } = find(&args.muscle)?;
    let class = args.class.unwrap_or(class);
    let trace = trace::read_inputs(&args.input)?;
    check_run(&args.output, &args.input, &args.muscle, &muscle, &trace)?;
    let mode: Mode = args.mode.into();
    if mode != Mode::Fes && trace.inputs.iter().any(|input| input.stimulation_frequency != 0.0) {
        let name = engine::mode_name(mode);
        complain(&format!("stim_hz is ignored in mode {name}; --mode fes uses it"));
    }
    let computed = engine::run_in_class(&muscle, mode, args.arithmetic, class, &trace)?;
    let rows: Vec<OutputRow> = computed
        .iter()
        .enumerate()
        .map(|(row, &(sample, status))| OutputRow {
            time: trace.time(row),
            sample,
            // The reference clips activation only, and raises no flags.
            status: match args.arithmetic {
                Arithmetic::Reference => "unchecked".to_owned(),
                _ => engine::status_names(status),
            },
        })
        .collect();
    trace::write_outputs(&args.output, &rows)?;
    let text = summary(args, class, &trace, &computed);
    // A closed standard error is no failure: the outputs are written.
    let _nobody_listens = writeln!(std::io::stderr(), "{text}");
    Ok(())
}

/// Peak force, range of length and flagged ticks.
fn summary(args: &RunArgs, class: Class, trace: &InputTrace, rows: &[engine::Row]) -> String {
    let ticks = rows.len() - 1;
    let mode = args.mode.to_possible_value().map_or(String::new(), |m| m.get_name().to_owned());
    let force = |row: &usize| rows[*row].0.force;
    let peak = (0..rows.len()).max_by(|a, b| force(a).total_cmp(&force(b))).unwrap_or(0);
    let lengths = rows.iter().map(|row| row.0.fascicle_length);
    let (least, most) =
        lengths.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), l| (a.min(l), b.max(l)));
    let flagged: Vec<String> = Status::all()
        .iter_names()
        .filter_map(|(name, flag)| {
            let count = rows.iter().filter(|row| row.1.intersects(flag)).count();
            (count > 0).then(|| format!("{name} {count} of {ticks} ticks"))
        })
        .collect();
    let flagged = match (args.arithmetic, flagged.is_empty()) {
        (Arithmetic::Reference, _) => "no flags: the reference checks nothing".to_owned(),
        (_, true) => "no tick flagged".to_owned(),
        (_, false) => format!("flagged: {}", flagged.join(", ")),
    };
    // The reference has no class; the standard one is not printed.
    let class = match (args.arithmetic, class) {
        (Arithmetic::Reference, _) | (_, Class::Standard) => String::new(),
        (_, class) => format!(", {} class", class.name()),
    };
    let to = if args.output == Path::new(crate::output_file::STANDARD) {
        String::new()
    } else {
        format!("; written to {}", args.output.display())
    };
    format!(
        "{ticks} ticks, {mode}, {}{class}: peak force {:.3} N at {} s; fascicle length {least:.4} to \
         {most:.4} L_ce0; {flagged}{to}",
        args.arithmetic.name(),
        force(&peak),
        trace::time_digits(trace.time(peak)),
    )
}

/// Refuses an output that is also an input, and a first row in which the muscle cannot rest.
pub(super) fn check_run(
    output: &Path,
    input: &Path,
    muscle_file: &Path,
    muscle: &Muscle,
    trace: &InputTrace,
) -> Result<(), Box<dyn Error>> {
    check_ending("--output", output, CSV)?;
    for (read, file) in [("--input", input), ("--muscle", muscle_file)] {
        if trace::same_file(output, file) {
            let output = output.display();
            return Err(format!("--output {output}: must be another file than {read}'s").into());
        }
    }
    let (shortest, longest) = model_muscle::path_domain(muscle);
    let first = trace.inputs[0].path_length;
    if !(shortest..=longest).contains(&first) {
        let problem = format!(
            "{first}: the muscle rests in the first row, so the path must be {shortest:.6} to \
             {longest:.6} m, the shortest and the longest on which it can rest"
        );
        return Err(trace::cell_error(input, 2, "path_length_m", problem).into());
    }
    Ok(())
}
