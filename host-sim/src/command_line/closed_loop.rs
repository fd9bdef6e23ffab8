//! `vm loop`: controllers of stimulation in closed loop, on patients that differ from the model.

use super::print;
use crate::chart::{Chart, Line, Panel};
use crate::closed_loop::{self, Instant, Kind, Patient, Row, Study, Task, Trial};
use crate::trace::write_atomically;
use clap::Args;
use comfy_table::{Table, presets};
use std::error::Error;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct LoopArgs {
    /// Patients that are scored.
    #[arg(long, default_value_t = 200)]
    patients: u64,
    /// Patients that controllers are tuned on; they are not among those scored.
    #[arg(long, default_value_t = 50)]
    tuning_patients: u64,
    /// Evaluations that each controller is tuned with on each task.
    #[arg(long, default_value_t = 40)]
    evaluations: usize,
    /// Tasks; all of them if none is given.
    #[arg(long = "task", value_enum)]
    tasks: Vec<Task>,
    /// Prints the table as JSON.
    #[arg(long)]
    json: bool,
    /// Draws the first patient's run of the first task under every controller, in SVG.
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

pub fn run(args: &LoopArgs) -> Result<(), Box<dyn Error>> {
    if let Some(path) = &args.svg {
        super::check_ending("--svg", path, ("SVG", &["svg"]))?;
        crate::trace::check_folder(path)?;
    }
    let tasks = if args.tasks.is_empty() { Task::ALL.to_vec() } else { args.tasks.clone() };
    let study = Study {
        tasks,
        patients: args.patients,
        tuning_patients: args.tuning_patients,
        evaluations: args.evaluations,
    };
    let rows = closed_loop::run(&study)?;
    if let Some(path) = &args.svg {
        let svg = drawn(study.tasks[0], &rows)?;
        write_atomically(path, svg.as_bytes())?;
    }
    if args.json {
        print(&serde_json::to_string_pretty(&rows)?)?;
    } else {
        print(&table(&rows))?;
    }
    Ok(())
}

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header([
        "task",
        "controller",
        "arithmetic",
        "patients",
        "rms, deg (median)",
        "rms, deg (p95)",
        "overshoot, deg (p95)",
        "charge, uC (median)",
        "endured, s (p5)",
        "unstable",
        "limit broken",
        "settings",
    ]);
    for row in rows {
        let settings: Vec<String> = row.settings.iter().map(|x| format!("{x:.3}")).collect();
        table.add_row([
            row.task.to_owned(),
            row.controller.to_owned(),
            row.arithmetic.to_owned(),
            row.patients.to_string(),
            format!("{:.2}", row.rms_median),
            format!("{:.2}", row.rms_p95),
            format!("{:.1}", row.overshoot_p95),
            format!("{:.0}", row.charge_median_uc),
            format!("{:.0}", row.endured_p5_s),
            row.unstable.to_string(),
            row.limit_broken.to_string(),
            settings.join(" "),
        ]);
    }
    table
}

/// The first patient's runs of a task, with the settings of the rows.
fn drawn(task: Task, rows: &[Row]) -> Result<String, Box<dyn Error>> {
    let patient = Patient::scored(task, 0);
    let (mut angles, mut widths) = (Vec::new(), Vec::new());
    for (kind, row) in Kind::ALL.into_iter().zip(rows).take(4) {
        let mut instants: Vec<Instant> = Vec::new();
        let trial = Trial { task, patient: &patient, kind, settings: &row.settings, tuning: false };
        trial.run(|instant| instants.push(instant))?;
        let of = |value: fn(&Instant) -> f64| {
            instants.iter().map(|instant| (instant.time, value(instant))).collect::<Vec<_>>()
        };
        if angles.is_empty() {
            angles.push(Line::new("target", of(|instant| instant.target.to_degrees())));
        }
        angles.push(Line::new(kind.name(), of(|instant| instant.angle.to_degrees())));
        // Extensors' pulses are drawn downwards.
        widths.push(Line::new(
            kind.name(),
            of(|instant| (instant.widths[0] - instant.widths[1]) * 1e6),
        ));
    }
    let panels = vec![Panel::new("angle (deg)", angles), Panel::new("pulse width (us)", widths)];
    Ok(Chart { title: task.name(), x: "time (s)", panels }.draw())
}
