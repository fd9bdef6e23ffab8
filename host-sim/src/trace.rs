//! Input and output traces in CSV.

use crate::model_muscle::in_file_unit;
use crate::output_file::{self, STANDARD, folder_of};
use crate::reference::{Input, Sample};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Columns that an input file begins with.
pub const INPUT_COLUMNS: [&str; 4] = ["t_s", "activation", "path_length_m", "stim_hz"];
/// Columns of an output file.
pub const OUTPUT_COLUMNS: [&str; 5] =
    ["t_s", "force_n", "fascicle_length_l0", "fascicle_velocity_l0_per_s", "status"];

/// Why a trace was refused.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// An error in the file.
    #[error("{}, line {line}, column {column}: {problem}", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// Line, counted from 1.
        line: u64,
        /// Column name.
        column: String,
        /// The error.
        problem: String,
    },
}

/// Inputs at a uniform time step; the first row is the muscle at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct InputTrace {
    /// Time of the first row, s.
    pub start: f64,
    /// Time between rows, s.
    pub time_step: f64,
    /// One input per row.
    pub inputs: Vec<Input>,
}

impl InputTrace {
    /// Time of a row, s.
    pub fn time(&self, row: usize) -> f64 {
        self.start + self.time_step * row as f64
    }

    /// Every `stride`-th input.
    #[must_use]
    pub fn strided(&self, stride: usize) -> Self {
        let inputs = self.inputs.iter().copied().step_by(stride).collect();
        Self { time_step: self.time_step * stride as f64, inputs, ..*self }
    }

    /// The same inputs at a time step `factor` times shorter: held, and the path interpolated.
    #[must_use]
    pub fn refined(&self, factor: usize) -> Self {
        let mut inputs = vec![self.inputs[0]];
        for pair in self.inputs.windows(2) {
            for part in 1..=factor {
                let share = part as f64 / factor as f64;
                let path = pair[0].path_length * (1.0 - share) + pair[1].path_length * share;
                inputs.push(Input { path_length: path, ..pair[1] });
            }
        }
        Self { time_step: self.time_step / factor as f64, inputs, ..*self }
    }
}

/// Tolerance of a time step, relative to the median.
const TIME_TOLERANCE: f64 = 1e-3;

/// Largest number in a trace.
const LARGEST: f64 = 1e12;

/// Reads a file of inputs; `-` is standard input.
pub fn read_inputs(path: &Path) -> Result<InputTrace, TraceError> {
    parse_inputs(&read(path)?, name(path))
}

/// The bytes of a file; `-` is standard input.
pub fn read(path: &Path) -> Result<Vec<u8>, TraceError> {
    let bytes = if path == Path::new(STANDARD) {
        let mut bytes = Vec::new();
        std::io::stdin().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    bytes.map_err(|source| file_error(name(path), source))
}

/// What a file that is read is called in messages.
pub fn name(path: &Path) -> &Path {
    if path == Path::new(STANDARD) { Path::new("standard input") } else { path }
}

/// Parses inputs; `path` is for the messages.
pub fn parse_inputs(text: &[u8], path: &Path) -> Result<InputTrace, TraceError> {
    let rows = numbers(text, path, &INPUT_COLUMNS)?;
    let wrong = |index: usize, column: &str, problem: String| {
        cell_error(path, rows[index].0, column, problem)
    };
    let [(_, first), .., (_, last)] = rows.as_slice() else {
        let line = rows.last().map_or(1, |(line, _)| *line) + 1;
        let problem = format!(
            "{} row{}: a trace needs at least 2",
            rows.len(),
            if rows.len() == 1 { "" } else { "s" }
        );
        return Err(cell_error(path, line, "t_s", problem));
    };
    for (index, pair) in rows.windows(2).enumerate() {
        let (before, time) = (pair[0].1[0], pair[1].1[0]);
        if time <= before {
            let problem = format!("{time} is not after {before}, the previous time");
            return Err(wrong(index + 1, "t_s", problem));
        }
    }
    let usual = usual_step(&rows);
    for (index, pair) in rows.windows(2).enumerate() {
        let (before, time) = (pair[0].1[0], pair[1].1[0]);
        if ((time - before) - usual).abs() > TIME_TOLERANCE * usual {
            let problem = format!(
                "{time} is {:.9} s after {before}; the time step is {usual:.9} s",
                time - before
            );
            return Err(wrong(index + 1, "t_s", problem));
        }
    }
    let time_step = (last[0] - first[0]) / (rows.len() - 1) as f64;
    // A step near a whole number of nanoseconds is rounded to it.
    let nanoseconds = time_step * 1e9;
    let time_step = if (nanoseconds - nanoseconds.round()).abs() < 1e-3 {
        nanoseconds.round() * 1e-9
    } else {
        time_step
    };
    check_time_step(time_step, 1.0)
        .map_err(|limit| wrong(1, "t_s", format!("rows {time_step} s apart: {limit} s apart")))?;
    let inputs = rows
        .iter()
        .map(|(_, row)| Input {
            activation: row[1],
            path_length: row[2],
            stimulation_frequency: row[3],
        })
        .collect();
    Ok(InputTrace { start: first[0], time_step, inputs })
}

/// Refuses a time step (s) that no muscle takes; the limits are in a unit of which `per_second`
/// make a second.
pub fn check_time_step(seconds: f64, per_second: f64) -> Result<(), String> {
    use vm_nostd::TimeStep;
    match TimeStep::from_seconds(seconds) {
        Ok(_) => Ok(()),
        Err(_) => {
            let limits = [TimeStep::SHORTEST, TimeStep::LONGEST];
            let [least, most] = limits.map(|limit| in_file_unit(limit, per_second));
            Err(format!("must be {least} to {most}"))
        }
    }
}

/// Median of the time steps, s.
fn usual_step(rows: &[(u64, Vec<f64>)]) -> f64 {
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1].1[0] - pair[0].1[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps[(steps.len() - 1) / 2]
}

/// Reads the numbers of the leading `columns` of a file, each row with its line.
pub fn numbers(
    text: &[u8],
    path: &Path,
    columns: &[&str],
) -> Result<Vec<(u64, Vec<f64>)>, TraceError> {
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text);
    let header = reader.headers().map_err(|error| csv_error(path, &error))?.clone();
    for (index, &column) in columns.iter().enumerate() {
        let found = header.get(index).unwrap_or("");
        if found.trim() != column {
            let problem =
                format!("the header has \"{found}\"; it must begin with {}", columns.join(","));
            return Err(cell_error(path, 1, column, problem));
        }
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| csv_error(path, &error))?;
        let line = record.position().map_or(0, csv::Position::line);
        if record.len() != header.len() {
            let problem = format!("{} cells, the header has {}", record.len(), header.len());
            let column = header.get(record.len()).unwrap_or("(beyond the last)");
            return Err(cell_error(path, line, column, problem));
        }
        let mut row = Vec::with_capacity(columns.len());
        for (cell, column) in record.iter().zip(columns) {
            match cell.trim().parse::<f64>() {
                Ok(number) if number.abs() <= LARGEST => row.push(number),
                Ok(number) if number.is_finite() => {
                    let problem = format!("{number} is beyond {LARGEST:e}");
                    return Err(cell_error(path, line, column, problem));
                }
                _ => {
                    let problem = format!("\"{cell}\" is not a finite number");
                    return Err(cell_error(path, line, column, problem));
                }
            }
        }
        rows.push((line, row));
    }
    Ok(rows)
}

/// One row of an output file.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputRow {
    /// s.
    pub time: f64,
    /// Force, length, velocity.
    pub sample: Sample,
    /// Names of the flags, joined by `|`; `ok` where there are none.
    pub status: String,
}

/// Nine significant digits, which distinguish any two `f32`.
fn digits(value: f64) -> String {
    format!("{value:.8e}").parse::<f64>().unwrap_or(value).to_string()
}

/// A time to the nanosecond, or to the precision of `f64`.
pub fn time_digits(time: f64) -> String {
    let whole = time.abs().max(1.0).log10().floor() as usize + 1;
    let text = format!("{time:.*}", 15_usize.saturating_sub(whole).clamp(1, 9));
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Writes an output file atomically.
pub fn write_outputs(path: &Path, rows: &[OutputRow]) -> Result<(), TraceError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let record = |writer: &mut csv::Writer<Vec<u8>>, cells: &[String]| {
        writer.write_record(cells).map_err(|error| csv_error(path, &error))
    };
    record(&mut writer, &OUTPUT_COLUMNS.map(str::to_owned))?;
    for row in rows {
        let sample = &row.sample;
        let cells = [
            time_digits(row.time),
            digits(sample.force),
            digits(sample.fascicle_length),
            digits(sample.fascicle_velocity),
            row.status.clone(),
        ];
        record(&mut writer, &cells)?;
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| file_error(path, std::io::Error::other(error.to_string())))?;
    write_atomically(path, &bytes)
}

/// Checks that the folder of an output file exists.
pub fn check_folder(path: &Path) -> Result<(), TraceError> {
    let folder = folder_of(path);
    let error = |source| file_error(folder, source);
    let found = std::fs::metadata(folder).map_err(error)?;
    if found.is_dir() { Ok(()) } else { Err(error(std::io::ErrorKind::NotADirectory.into())) }
}

/// Writes a file atomically, see [`output_file::write`].
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), TraceError> {
    let named = if path == Path::new(STANDARD) { Path::new("standard output") } else { path };
    output_file::write(path, bytes).map_err(|source| file_error(named, source))
}

/// Whether two paths are the same file.
pub fn same_file(one: &Path, other: &Path) -> bool {
    one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}

/// An error in a cell of a file.
pub fn cell_error(path: &Path, line: u64, column: &str, problem: String) -> TraceError {
    TraceError::Cell { path: path.to_owned(), line, column: column.to_owned(), problem }
}

fn file_error(path: &Path, source: std::io::Error) -> TraceError {
    TraceError::File { path: path.to_owned(), source }
}

fn csv_error(path: &Path, error: &csv::Error) -> TraceError {
    let line = error.position().map_or(1, csv::Position::line);
    cell_error(path, line, "(any)", error.to_string())
}
