//! A recording: one column of a file over time, in the units of the file.

use crate::trace::{TraceError, cell_error};
use serde::Deserialize;
use std::path::PathBuf;

/// A column, by its name in the header or, in a file without header, by its number counted from 1.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Column {
    /// Its name.
    Named(String),
    /// Its number.
    Numbered(usize),
}

impl Column {
    fn label(&self) -> String {
        match self {
            Self::Named(name) => name.clone(),
            Self::Numbered(number) => number.to_string(),
        }
    }
}

/// Source of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// Delimiter; `None` for any run of blanks.
    pub delimiter: Option<u8>,
    /// Lines before the header or, without header, before the numbers.
    pub skip_lines: usize,
    /// Times, s.
    pub time: Column,
    /// Values.
    pub value: Column,
}

/// Values at increasing times.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Time (s), value and line number.
    rows: Vec<(f64, f64, u64)>,
    path: PathBuf,
    column: String,
}

/// This many consecutive readings at the greatest force count as saturation.
const SATURATED: usize = 5;
/// Minimum number of readings in a trial.
const FEWEST: usize = 8;

impl Recording {
    /// Reads a recording; errors name file, line and column.
    pub fn read(source: &Source) -> Result<Self, TraceError> {
        let path = &source.path;
        let bytes = std::fs::read(path)
            .map_err(|source| TraceError::File { path: path.clone(), source })?;
        let text = String::from_utf8_lossy(&bytes);
        let mut lines = cells(&text, source)?.into_iter();
        let named = [&source.time, &source.value].iter().any(|c| matches!(c, Column::Named(_)));
        let header = if named { lines.next() } else { None };
        let find = |column: &Column| match (column, &header) {
            (Column::Numbered(number), _) if *number > 0 => Ok(number - 1),
            (Column::Named(name), Some((_, cells))) => {
                cells.iter().position(|cell| cell == name).ok_or_else(|| {
                    let line = source.skip_lines as u64 + 1;
                    let problem = format!("the header has only {}", cells.join(", "));
                    cell_error(path, line, name, problem)
                })
            }
            (column, _) => {
                let line = source.skip_lines as u64 + 1;
                let problem = "no such column: numbers count from 1".to_owned();
                Err(cell_error(path, line, &column.label(), problem))
            }
        };
        let (time, value) = (find(&source.time)?, find(&source.value)?);
        let mut rows: Vec<(f64, f64, u64)> = Vec::new();
        for (line, cells) in lines {
            let number = |index: usize, column: &Column| {
                let refuse = |problem| Err(cell_error(path, line, &column.label(), problem));
                match cells.get(index).map(String::as_str) {
                    None | Some("") => refuse("missing".to_owned()),
                    Some(cell) => match cell.parse::<f64>() {
                        Ok(number) if number.is_finite() => Ok(number),
                        _ => refuse(format!("\"{cell}\" is not a finite number")),
                    },
                }
            };
            let (t, v) = (number(time, &source.time)?, number(value, &source.value)?);
            if let Some(&(before, ..)) = rows.last()
                && t <= before
            {
                let how = if t == before { "repeats" } else { "goes back from" };
                let problem = format!("{t} {how} {before}, the previous time");
                return Err(cell_error(path, line, &source.time.label(), problem));
            }
            rows.push((t, v, line));
        }
        let recording = Self { rows, path: path.clone(), column: source.value.label() };
        if recording.rows.len() < 2 {
            let count = recording.rows.len();
            return Err(recording.wrong(0, format!("{count} rows: at least 2 are needed")));
        }
        Ok(recording)
    }

    /// Refuses implausible forces: too few readings, constant, or saturated.
    pub fn check_force(&self) -> Result<(), TraceError> {
        if self.rows.len() < FEWEST {
            let problem = format!("{} readings in the window: at least {FEWEST}", self.rows.len());
            return Err(self.wrong(0, problem));
        }
        let greatest = self.rows.iter().map(|row| row.1).fold(f64::NEG_INFINITY, f64::max);
        let least = self.rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min);
        if greatest == least {
            let problem = format!("{greatest} in every row of the window: dead channel");
            return Err(self.wrong(0, problem));
        }
        let saturated =
            self.rows.windows(SATURATED).position(|few| few.iter().all(|row| row.1 == greatest));
        match saturated {
            Some(index) => {
                let problem = format!(
                    "{greatest}, the greatest value, in {SATURATED} consecutive rows: saturated"
                );
                Err(self.wrong(index, problem))
            }
            None => Ok(()),
        }
    }

    /// Refuses the first value for which `problem` has something to say.
    pub fn check(&self, problem: &dyn Fn(f64) -> Option<String>) -> Result<(), TraceError> {
        let first = self.rows.iter().enumerate().find_map(|(i, row)| Some((i, problem(row.1)?)));
        first.map_or(Ok(()), |(index, problem)| Err(self.wrong(index, problem)))
    }

    fn wrong(&self, index: usize, problem: String) -> TraceError {
        let line = self.rows.get(index).map_or(1, |row| row.2);
        cell_error(&self.path, line, &self.column, problem)
    }

    /// The readings from one time to another, inclusive.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Self {
        let rows = self.rows.iter().filter(|row| (from..=to).contains(&row.0)).copied().collect();
        Self { rows, path: self.path.clone(), column: self.column.clone() }
    }

    /// Times (s) and values.
    pub fn readings(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.rows.iter().map(|&(time, value, _)| (time, value))
    }

    /// The first and the last time, s.
    pub fn span(&self) -> (f64, f64) {
        let time = |row: Option<&(f64, f64, u64)>| row.map_or(0.0, |row| row.0);
        (time(self.rows.first()), time(self.rows.last()))
    }

    /// The value at a time, linear between readings, held before the first and after the last.
    pub fn at(&self, time: f64) -> f64 {
        let after = self.rows.partition_point(|row| row.0 <= time);
        match (after.checked_sub(1).map(|before| self.rows[before]), self.rows.get(after)) {
            (Some((t0, v0, _)), Some(&(t1, v1, _))) => v0 + (v1 - v0) * (time - t0) / (t1 - t0),
            (Some((_, value, _)), None) | (None, Some(&(_, value, _))) => value,
            (None, None) => 0.0,
        }
    }
}

/// Number and cells of each line after the skipped ones, without empty lines.
fn cells(text: &str, source: &Source) -> Result<Vec<(u64, Vec<String>)>, TraceError> {
    let skipped = source.skip_lines as u64;
    let Some(delimiter) = source.delimiter else {
        return Ok(text
            .lines()
            .enumerate()
            .skip(source.skip_lines)
            .map(|(index, line)| {
                (index as u64 + 1, line.split_whitespace().map(str::to_owned).collect())
            })
            .filter(|(_, cells): &(u64, Vec<String>)| !cells.is_empty())
            .collect());
    };
    let rest: String = text.split_inclusive('\n').skip(source.skip_lines).collect();
    csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .from_reader(rest.as_bytes())
        .records()
        .map(|record| {
            let record = record.map_err(|error| {
                let line = error.position().map_or(1, csv::Position::line) + skipped;
                cell_error(&source.path, line, "(any)", error.to_string())
            })?;
            let line = record.position().map_or(1, csv::Position::line) + skipped;
            Ok((line, record.iter().map(|cell| cell.trim().to_owned()).collect()))
        })
        .collect()
}
