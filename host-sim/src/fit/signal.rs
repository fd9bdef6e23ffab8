//! A signal of a trial: constant, steps or a recording, with a scale and an offset, which may be a
//! free parameter.

use super::error::{FitError, Refuse};
use super::recording::{Column, Recording, Source};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A signal in the list of trials.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SignalTable {
    constant: Option<f64>,
    steps: Option<Vec<(f64, f64)>>,
    file: Option<PathBuf>,
    #[serde(default = "comma")]
    delimiter: String,
    #[serde(default)]
    skip_lines: usize,
    time: Option<Column>,
    value: Option<Column>,
    #[serde(default = "one")]
    scale: f64,
    #[serde(default)]
    offset: OffsetKey,
}

fn comma() -> String {
    ",".to_owned()
}

fn one() -> f64 {
    1.0
}

/// A number, or the name of a free parameter.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "must be a number or the name of a free parameter")]
enum OffsetKey {
    Fixed(f64),
    Free(String),
}

impl Default for OffsetKey {
    fn default() -> Self {
        Self::Fixed(0.0)
    }
}

/// Offset of a signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// A constant.
    Fixed(f64),
    /// The free parameter with this index.
    Free(usize),
}

impl Offset {
    /// Its value for given free parameters.
    pub fn value(self, values: &[f64]) -> f64 {
        match self {
            Self::Fixed(offset) => offset,
            Self::Free(index) => values[index],
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Shape {
    Constant(f64),
    /// Values from each time (s) on; the first also before.
    Steps(Vec<(f64, f64)>),
    Recorded(Recording),
}

/// A signal over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    shape: Shape,
    scale: f64,
    offset: Offset,
}

impl Signal {
    /// A constant signal.
    pub fn constant(value: f64) -> Self {
        Self { shape: Shape::Constant(value), scale: 1.0, offset: Offset::Fixed(0.0) }
    }

    /// Reads a signal with its file in `folder`. `free` are the names of free offsets; `refuse`
    /// makes an error of a problem.
    pub fn read(
        table: &SignalTable,
        folder: &Path,
        free: &[&str],
        refuse: &dyn Fn(String) -> FitError,
    ) -> Result<Self, FitError> {
        let shape = match (table.constant, &table.steps, &table.file) {
            (Some(constant), None, None) if constant.is_finite() => Shape::Constant(constant),
            (None, Some(steps), None) => {
                let increasing = steps.windows(2).all(|pair| pair[0].0 < pair[1].0);
                let finite = steps.iter().all(|step| step.0.is_finite() && step.1.is_finite());
                if steps.is_empty() || !increasing || !finite {
                    let limit = "must be [time, value] pairs, at least one, times increasing";
                    return Err(refuse(format!("steps: {limit}")));
                }
                Shape::Steps(steps.clone())
            }
            (None, None, Some(file)) => {
                let source = table.source(&folder.join(file), refuse)?;
                Shape::Recorded(Recording::read(&source)?)
            }
            _ => {
                let limit = "give one of constant (a finite number), steps and file".to_owned();
                return Err(refuse(limit));
            }
        };
        if !table.scale.is_finite() || table.scale == 0.0 {
            return Err(refuse(format!("scale = {}: must be finite and not 0", table.scale)));
        }
        let offset = match &table.offset {
            OffsetKey::Fixed(offset) => Offset::Fixed(*offset),
            OffsetKey::Free(name) => match free.iter().position(|free| free == name) {
                Some(index) => Offset::Free(index),
                None => {
                    return Err(refuse(format!("offset = \"{name}\": no [[free]] of that name")));
                }
            },
        };
        Ok(Self { shape, scale: table.scale, offset })
    }

    /// The recording, if the signal is one.
    pub fn recording(&self) -> Option<&Recording> {
        match &self.shape {
            Shape::Recorded(recording) => Some(recording),
            _ => None,
        }
    }

    /// Refuses values outside `limits` during a trial, with the place of a recorded one. A free
    /// offset is not known before the fit; such a signal is taken as it is.
    pub fn check(
        &self,
        key: &str,
        limits: (f64, f64),
        during: (f64, f64),
        refuse: Refuse<'_>,
    ) -> Result<(), FitError> {
        let Offset::Fixed(_) = self.offset else { return Ok(()) };
        let (least, most) = limits;
        // Scaling rounds.
        let rounding = 1e-9 * most;
        let wrong = |raw: f64| {
            let value = self.scaled(raw, &[]);
            let within = (least - rounding..=most + rounding).contains(&value);
            (!within).then(|| format!("{key} = {value}: must be {least} to {most}"))
        };
        match &self.shape {
            Shape::Constant(constant) => wrong(*constant).map_or(Ok(()), |why| Err(refuse(why))),
            Shape::Steps(steps) => {
                let first = steps.iter().find_map(|&(_, value)| wrong(value));
                first.map_or(Ok(()), |why| Err(refuse(why)))
            }
            Shape::Recorded(recording) => {
                Ok(recording.between(during.0, during.1).check(&|value| wrong(value))?)
            }
        }
    }

    /// Value at a time (s) for given free parameters.
    pub fn at(&self, time: f64, values: &[f64]) -> f64 {
        let raw = match &self.shape {
            Shape::Constant(constant) => *constant,
            Shape::Steps(steps) => {
                let after = steps.partition_point(|step| step.0 <= time);
                steps[after.saturating_sub(1)].1
            }
            Shape::Recorded(recording) => recording.at(time),
        };
        self.scaled(raw, values)
    }

    /// Applies scale and offset to a raw value.
    pub fn scaled(&self, raw: f64, values: &[f64]) -> f64 {
        raw * self.scale + self.offset.value(values)
    }

    /// The signal times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { scale: self.scale * factor, ..self }
    }

    /// Replaces the index of the free offset `i` by `places[i]`.
    pub fn renumber(&mut self, places: &[usize]) {
        if let Offset::Free(index) = &mut self.offset {
            *index = places[*index];
        }
    }

    /// Index of the free offset, if any.
    pub fn free(&self) -> Option<usize> {
        match self.offset {
            Offset::Free(index) => Some(index),
            Offset::Fixed(_) => None,
        }
    }
}

impl SignalTable {
    fn source(&self, path: &Path, refuse: &dyn Fn(String) -> FitError) -> Result<Source, FitError> {
        let delimiter = match self.delimiter.as_bytes() {
            [one] => Some(*one),
            _ if self.delimiter == "blanks" => None,
            _ => {
                let given = &self.delimiter;
                let limit = "must be one character, or \"blanks\" for any run of them";
                return Err(refuse(format!("delimiter = \"{given}\": {limit}")));
            }
        };
        let (Some(time), Some(value)) = (self.time.clone(), self.value.clone()) else {
            return Err(refuse("a file needs the columns time and value".to_owned()));
        };
        let (path, skip_lines) = (path.to_owned(), self.skip_lines);
        Ok(Source { path, delimiter, skip_lines, time, value })
    }
}
