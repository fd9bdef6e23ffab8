//! `vm plot`: a run as SVG.

use crate::chart::{Chart, Line, Panel, Point};
use crate::output_file::STANDARD;
use crate::trace::{self, InputTrace};
use clap::Args;
use std::error::Error;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct PlotArgs {
    /// Outputs of `vm run`.
    #[arg(long, default_value = "run.csv")]
    run: PathBuf,
    /// Inputs of that run, drawn below its outputs.
    #[arg(long)]
    input: Option<PathBuf>,
    /// Picture, in SVG; `-` is standard output.
    #[arg(long, visible_alias = "out", default_value = "run.svg")]
    output: PathBuf,
}

pub fn run(args: &PlotArgs) -> Result<(), Box<dyn Error>> {
    super::check_ending("--output", &args.output, ("SVG", &["svg"]))?;
    let bytes = trace::read(&args.run)?;
    let columns = &trace::OUTPUT_COLUMNS[..4];
    let rows = trace::numbers(&bytes, &args.run, columns)?;
    if rows.len() < 2 {
        let problem = format!("{} rows: a plot needs at least 2", rows.len());
        return Err(trace::cell_error(&args.run, 2, "t_s", problem).into());
    }
    let labels = ["force (N)", "length (L0)", "velocity (L0/s)"];
    let mut panels: Vec<Panel> = labels
        .into_iter()
        .enumerate()
        .map(|(index, y)| {
            let points = rows.iter().map(|(_, row)| (row[0], row[index + 1]));
            Panel::new(y, vec![Line::new("", points)])
        })
        .collect();
    if let Some(path) = &args.input {
        let inputs = input_lines(&trace::read_inputs(path)?);
        panels.extend(inputs.map(|(y, points)| Panel::input(y, vec![Line::new("", points)])));
    }
    let title = args.run.file_name().map_or(Path::new("run"), Path::new);
    let title = title.display().to_string();
    let count = panels.len();
    let svg = Chart { title: &title, x: "time (s)", panels }.draw();
    let replaced = args.output.is_file();
    trace::write_atomically(&args.output, svg.as_bytes())?;
    // Nothing else is printed if the picture goes to standard output.
    if args.output != Path::new(STANDARD) {
        let (run, output) = (trace::name(&args.run).display(), args.output.display());
        let how = if replaced { "replaced" } else { "written" };
        let rows = rows.len();
        super::print(&format!("{output} {how}: {rows} rows of {run} in {count} panels"))?;
    }
    Ok(())
}

/// The inputs over time, with their labels.
fn input_lines(trace: &InputTrace) -> [(&'static str, Vec<Point>); 3] {
    let points = |value: fn(&crate::reference::Input) -> f64| {
        trace
            .inputs
            .iter()
            .enumerate()
            .map(|(row, input)| (trace.time(row), value(input)))
            .collect()
    };
    [
        ("activation", points(|input| input.activation)),
        ("path (m)", points(|input| input.path_length)),
        ("stimulation (pps)", points(|input| input.stimulation_frequency)),
    ]
}
