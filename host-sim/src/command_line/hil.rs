//! `vm hil`: plays a trace to a muscle on a device and compares its bits with the host's.

use super::print;
use super::run::check_run;
use crate::engine::{self, Class};
use crate::hil::{self, Client, Emulated, HilError, Line, Played};
use crate::muscle_file::NamedMuscle;
use crate::muscles::find;
use crate::output_file::STANDARD;
use crate::progress;
use crate::reference::{Mode, Muscle};
use crate::trace::{self, InputTrace, OutputRow};
use clap::{Args, ValueEnum};
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct HilArgs {
    /// Muscle, in TOML, or a name of `vm muscles`.
    #[arg(long)]
    muscle: PathBuf,
    /// Inputs, in CSV: t_s,activation,path_length_m,stim_hz, one row per tick; `-` is standard
    /// input.
    #[arg(long)]
    input: PathBuf,
    /// Outputs of the device, in CSV; `-` is standard output.
    #[arg(long, visible_alias = "out", default_value = "hil.csv")]
    output: PathBuf,
    /// Recruitment mode.
    #[arg(long, value_enum, default_value = "continuous")]
    mode: DeviceMode,
    /// Accuracy class. Default: that of the muscle file, which is standard if it names none.
    #[arg(long, value_enum)]
    class: Option<Class>,
    /// Serial port of a board; without one, the firmware is built and runs in QEMU.
    #[arg(long)]
    port: Option<String>,
    /// Baud rate of that port.
    #[arg(long, default_value_t = 460_800, requires = "port")]
    baud: u32,
}

/// The modes that the firmware has.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum DeviceMode {
    /// Natural continuous recruitment.
    Continuous,
    /// Intramuscular FES.
    Fes,
}

pub fn run(args: &HilArgs) -> Result<(), Box<dyn Error>> {
    let NamedMuscle { muscle, class, .. } = find(&args.muscle)?;
    let class = args.class.unwrap_or(class);
    let trace = trace::read_inputs(&args.input)?;
    check_run(&args.output, &args.input, &args.muscle, &muscle, &trace)?;
    let mode = match args.mode {
        DeviceMode::Continuous => Mode::Continuous,
        DeviceMode::Fes => Mode::Fes,
    };
    let played = match &args.port {
        Some(port) => play(hil::serial(port, args.baud)?, &muscle, class, mode, &trace),
        None => play(Emulated::start()?, &muscle, class, mode, &trace),
    }?;
    let rows: Vec<OutputRow> = played
        .rows
        .iter()
        .enumerate()
        .map(|(row, &(sample, status))| OutputRow {
            time: trace.time(row),
            sample,
            status: engine::status_names(status),
        })
        .collect();
    trace::write_outputs(&args.output, &rows)?;
    let Played { words, report, .. } = &played;
    let told = format!(
        "{} rows and {} words of state, all bits equal to the host's; longest tick {} us, {} late of {}, \
         {} frames broken and {} refused",
        rows.len(),
        words.len(),
        report.longest_us,
        report.late,
        report.ticks,
        report.frames.broken,
        report.frames.refused,
    );
    if args.output == Path::new(STANDARD) {
        // Nothing else is printed if the outputs go to standard output.
        let _nobody_listens = writeln!(std::io::stderr(), "{told}");
    } else {
        print(&told)?;
    }
    Ok(())
}

fn play<L: Line>(
    mut client: Client<L>,
    muscle: &Muscle,
    class: Class,
    mode: Mode,
    trace: &InputTrace,
) -> Result<Played, HilError> {
    let bar = progress::bar("playing ticks", trace.inputs.len());
    let played = hil::play(&mut client, muscle, class, mode, trace, &mut |rows| {
        bar.set_position(rows as u64);
    });
    bar.finish_and_clear();
    played
}
