//! `vm loop`: controllers of stimulation in closed loop, on patients that differ from the model.

use super::print;
use crate::closed_loop::{self, Kind, Row, Study, Task};
use crate::markdown_table::markdown_table;
use crate::readme;
use crate::trace::write_atomically;
use clap::Args;
use comfy_table::Table;
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
    /// Controllers; all of them if none is given.
    #[arg(long = "controller", value_enum)]
    controllers: Vec<Kind>,
    /// Prints the table as JSON.
    #[arg(long)]
    json: bool,
    /// Write the rows of these tasks and controllers into host-sim/docs/loop.md of the checkout
    /// that this program was built in; the others stay.
    #[arg(long)]
    write: bool,
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
    let controllers =
        if args.controllers.is_empty() { Kind::ALL.to_vec() } else { args.controllers.clone() };
    let study = Study {
        tasks,
        controllers,
        patients: args.patients,
        tuning_patients: args.tuning_patients,
        evaluations: args.evaluations,
    };
    let rows = closed_loop::run(&study)?;
    if let Some(path) = &args.svg {
        let svg = closed_loop::picture(study.tasks[0], &rows)?;
        write_atomically(path, svg.as_bytes())?;
    }
    if args.write {
        let kept = readme::LOOP.text()?;
        readme::LOOP.write(&readme::closed_loop(&kept, &study, &rows))?;
    }
    if args.json {
        print(&serde_json::to_string_pretty(&rows)?)?;
    } else {
        print(&table(&rows))?;
    }
    Ok(())
}

fn table(rows: &[Row]) -> Table {
    let mut header: Vec<&str> = closed_loop::COLUMNS.to_vec();
    header.push("settings");
    let mut table = markdown_table(&header, 3..closed_loop::COLUMNS.len());
    for row in rows {
        let settings: Vec<String> = row.settings.iter().map(|x| format!("{x:.3}")).collect();
        table.add_row(row.cells().into_iter().chain([settings.join(" ")]));
    }
    table
}
