//! `vm hil`: plays a trace to a muscle on a device, or closes a loop over its controller, and
//! compares its bits with the host's.

use super::print;
use super::run::check_run;
use crate::closed_loop::Task;
use crate::engine::{self, Class};
use crate::hil::{self, Client, Emulated, HilError, Line, Looped, Played};
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
    /// Closes the loop of a task of `vm loop` over the device's controller, in lockstep, instead of
    /// playing a trace.
    #[arg(long = "loop", value_name = "TASK", value_enum,
          conflicts_with_all = ["muscle", "input", "mode", "class"])]
    looped: Option<Task>,
    /// The simulated patient of `--loop`, by number.
    #[arg(long, default_value_t = 0, requires = "looped")]
    patient: u64,
    /// Muscle, in TOML, or a name of `vm muscles`.
    #[arg(long, required_unless_present = "looped")]
    muscle: Option<PathBuf>,
    /// Inputs, in CSV: t_s,activation,path_length_m,stim_hz, one row per tick; `-` is standard
    /// input.
    #[arg(long, required_unless_present = "looped")]
    input: Option<PathBuf>,
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
    if let Some(task) = args.looped {
        return close(args, task);
    }
    // Without a loop, both are there.
    let (Some(path), Some(input)) = (&args.muscle, &args.input) else { return Ok(()) };
    let NamedMuscle { muscle, class, .. } = find(path)?;
    let class = args.class.unwrap_or(class);
    let trace = trace::read_inputs(input)?;
    check_run(&args.output, input, path, &muscle, &trace)?;
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

fn close(args: &HilArgs, task: Task) -> Result<(), Box<dyn Error>> {
    let looped = match &args.port {
        Some(port) => closed(hil::serial(port, args.baud)?, task, args.patient),
        None => closed(Emulated::start()?, task, args.patient),
    }?;
    let Looped { score, steps, report } = looped;
    print(&format!(
        "{} of patient {}: {steps} steps, all bits equal to the host's; error {:.1} degrees rms; \
         longest tick {} us, {} late of {}",
        task.name(),
        args.patient,
        score.rms,
        report.longest_us,
        report.late,
        report.ticks,
    ))?;
    Ok(())
}

fn closed<L: Line>(mut client: Client<L>, task: Task, patient: u64) -> Result<Looped, HilError> {
    let bar = progress::bar("steps", (task.duration(false) * 1e3) as usize);
    let looped =
        hil::close(&mut client, task, patient, &mut |steps| bar.set_position(steps.into()));
    bar.finish_and_clear();
    looped
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
