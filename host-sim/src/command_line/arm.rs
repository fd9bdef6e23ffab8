//! `vm arm`.

use super::{CSV, ModeName, check_ending, print};
use crate::arm::{self, Activations, Arm, Drive, Joints, Moment, Outcome, Swings};
use crate::engine::{Arithmetic, status_names};
use crate::figures;
use crate::markdown_table::markdown_table;
use crate::trace::{check_folder, check_time_step, write_atomically};
use clap::Args;
use std::error::Error;
use std::path::PathBuf;

/// `vm arm`: the planar arm under constant activations.
#[derive(Debug, Args)]
pub struct ArmArgs {
    /// Recruitment mode.
    #[arg(long, value_enum, default_value = "continuous")]
    mode: ModeName,
    /// Arithmetic.
    #[arg(long, value_enum, default_value_t = Arithmetic::F32)]
    arithmetic: Arithmetic,
    /// Activation of both shoulder muscles, 0 to 1.
    #[arg(long, default_value_t = figures::ARM_ACTIVATIONS.shoulder)]
    shoulder: f64,
    /// Activation of both elbow muscles, 0 to 1.
    #[arg(long, default_value_t = figures::ARM_ACTIVATIONS.elbow)]
    elbow: f64,
    /// Activation of both biarticular muscles, 0 to 1.
    #[arg(long, default_value_t = figures::ARM_ACTIVATIONS.biarticular)]
    biarticular: f64,
    /// Stimulation frequency in mode fes, pps.
    #[arg(long, default_value_t = 20.0)]
    stimulation: f64,
    /// Initial angles of shoulder and elbow, degrees.
    #[arg(long, num_args = 2, value_names = ["SHOULDER", "ELBOW"],
          default_values_t = figures::ARM_START, allow_negative_numbers = true)]
    start: Vec<f64>,
    /// Duration, s.
    #[arg(long, default_value_t = figures::ARM_DURATION)]
    duration: f64,
    /// Time step, ms.
    #[arg(long, default_value_t = 1.0)]
    tick: f64,
    /// Output of every tick, in CSV.
    #[arg(long, visible_alias = "out")]
    output: Option<PathBuf>,
}

/// Runs the arm and prints the outcome.
pub fn run(args: &ArmArgs) -> Result<(), Box<dyn Error>> {
    check_time_step(args.tick * 1e-3, 1e3)
        .map_err(|limit| format!("--tick {}: {limit} ms", args.tick))?;
    let arm = Arm::built_in();
    let drive = Drive {
        mode: args.mode.into(),
        arithmetic: args.arithmetic,
        activations: Activations {
            shoulder: args.shoulder,
            elbow: args.elbow,
            biarticular: args.biarticular,
        },
        stimulation_frequency: args.stimulation,
        start: [args.start[0].to_radians(), args.start[1].to_radians()],
        time_step: args.tick * 1e-3,
        duration: args.duration,
    };
    if let Some(path) = &args.output {
        check_ending("--output", path, CSV)?;
        check_folder(path)?;
    }
    let moments = arm::run(&arm, &drive)?;
    if let Some(path) = &args.output {
        write_atomically(path, &table(&arm, &moments)?)?;
    }
    let outcome = Outcome::of(&arm, &moments, drive.time_step);
    let header =
        ["joint", "final angle, deg", "early swing, deg", "late swing, deg", "growth, 1/s"];
    let mut table = markdown_table(&header, []);
    for (index, joint) in ["shoulder", "elbow"].into_iter().enumerate() {
        let judged = |value: fn(&Swings) -> Joints| {
            let value = outcome.swings.as_ref().map(|swings| value(swings)[index]);
            value.map_or("-".to_owned(), |value| format!("{value:+.3}"))
        };
        table.add_row([
            joint.to_owned(),
            format!("{:.3}", outcome.final_angles[index]),
            judged(|swings| swings.early),
            judged(|swings| swings.late),
            judged(Swings::growth),
        ]);
    }
    print(&table)?;
    print(&format!(
        "{}{}{}; energy error {:.1e} of the turnover; status {}",
        match outcome.swings.map(|swings| swings.settle()) {
            Some(true) => "settles",
            Some(false) => "does not settle",
            None => "too short to be judged (3 s)",
        },
        outcome.period.map_or(String::new(), |period| format!(", period {period:.2} s")),
        if outcome.out_of_range { "; a joint was beyond its range" } else { "" },
        outcome.energy_error,
        status_names(outcome.status),
    ))?;
    Ok(())
}

/// Every tick as CSV.
fn table(arm: &Arm, moments: &[Moment]) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let columns = ["t_s", "shoulder_deg", "elbow_deg", "shoulder_rad_per_s", "elbow_rad_per_s"];
    let mut header: Vec<String> = columns.map(str::to_owned).to_vec();
    header.extend(arm.muscles.iter().map(|muscle| format!("{}_n", muscle.name.replace(' ', "_"))));
    header.extend(["kinetic_energy_j", "work_j", "status"].map(str::to_owned));
    writer.write_record(&header)?;
    for moment in moments {
        let numbers = [moment.time].into_iter();
        let numbers = numbers
            .chain(moment.angles.map(f64::to_degrees))
            .chain(moment.velocities)
            .chain(moment.forces.iter().copied())
            .chain([moment.kinetic_energy, moment.work]);
        let mut cells: Vec<String> = numbers.map(|number| format!("{number:.9}")).collect();
        cells.push(status_names(moment.status));
        writer.write_record(&cells)?;
    }
    Ok(writer.into_inner()?)
}
