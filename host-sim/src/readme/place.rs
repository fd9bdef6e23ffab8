//! Places of generated text in the documents.

use crate::trace::{TraceError, write_atomically};
use std::path::{Path, PathBuf};

/// Place of generated text: between two marker lines of a Markdown file, or a file of its own.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    file: &'static str,
    /// First and last marker line; `None` for the whole file.
    markers: Option<[&'static str; 2]>,
}

/// The picture of the README.
pub const PICTURE: Place = Place { file: "host-sim/docs/force.svg", markers: None };

/// The README's table: cycles, memory and accuracy.
pub const FIT: Place = Place {
    file: "README.md",
    markers: Some(["<!-- fit: cargo vm readme --write -->", "<!-- end of fit -->"]),
};
/// The worst scenario of each arithmetic and mode.
pub const WORST: Place = Place {
    file: "host-sim/docs/accuracy.md",
    markers: Some(["<!-- worst: cargo vm readme --write -->", "<!-- end of worst -->"]),
};
/// Accuracy of every scenario.
pub const MEASURED: Place = Place {
    file: "host-sim/docs/accuracy.md",
    markers: Some(["<!-- measured: cargo vm readme --write -->", "<!-- end of measured -->"]),
};
/// The error budget: truncation and rounding separately.
pub const ERROR_BUDGET: Place = Place {
    file: "host-sim/docs/accuracy.md",
    markers: Some([
        "<!-- error budget: cargo vm readme --write -->",
        "<!-- end of error budget -->",
    ]),
};
/// Cycles, code size and stack.
pub const CYCLES: Place = Place {
    file: "host-sim/docs/cycles.md",
    markers: Some(["<!-- cycles: cargo vm cycles --write -->", "<!-- end of cycles -->"]),
};
/// The stimulator's memory.
pub const STACK: Place = Place {
    file: "firmware/README.md",
    markers: Some(["<!-- memory: cargo vm stack --write -->", "<!-- end of memory -->"]),
};
/// Recovery of the parameters of synthetic patients.
pub const RECOVERY: Place = Place {
    file: "host-sim/docs/fitting.md",
    markers: Some([
        "<!-- recovery: cargo vm recover --patients N --output FILE --write -->",
        "<!-- end of recovery -->",
    ]),
};
/// Comparison with recordings of real muscle.
pub const SCOREBOARD: Place = Place {
    file: "host-sim/docs/fitting.md",
    markers: Some([
        "<!-- scoreboard: cargo vm measured --data DIR --write -->",
        "<!-- end of scoreboard -->",
    ]),
};

/// Controllers in closed loop.
pub const LOOP: Place = Place {
    file: "host-sim/docs/loop.md",
    markers: Some(["<!-- loop: cargo vm loop --write -->", "<!-- end of loop -->"]),
};

/// Why a document could not be compared or written.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The marker lines of the table are missing.
    #[error("{file} has no lines \"{begin}\" and \"{end}\"")]
    NoPlace {
        /// The file.
        file: &'static str,
        /// First marker line.
        begin: &'static str,
        /// Last marker line.
        end: &'static str,
    },
    /// The table of cycles has no such cell.
    #[error("{}: no number in row {row}, column {column}", CYCLES.file)]
    NoCell {
        /// Name of the case.
        row: &'static str,
        /// Heading of the column.
        column: &'static str,
    },
    /// The muscle of the picture could not be run.
    #[error(transparent)]
    Run(#[from] crate::engine::RunError),
}

fn path_of(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

fn read(path: &Path) -> Result<String, ReadmeError> {
    let error = |source| ReadmeError::Read { path: path.to_owned(), source };
    std::fs::read_to_string(path).map_err(error)
}

impl Place {
    /// Name of the file.
    pub fn file(self) -> &'static str {
        self.file
    }

    /// Whether the file contains exactly this generated text.
    pub fn is_current(self, generated: &str) -> Result<bool, ReadmeError> {
        let text = read(&path_of(self.file))?;
        Ok(self.filled(&text, generated)? == text)
    }

    /// Writes generated text into the file.
    pub fn write(self, generated: &str) -> Result<(), ReadmeError> {
        let path = path_of(self.file);
        let text = self.filled(&read(&path)?, generated)?;
        write_atomically(&path, text.as_bytes())?;
        Ok(())
    }

    /// The generated text in the file.
    pub fn text(self) -> Result<String, ReadmeError> {
        let text = read(&path_of(self.file))?;
        Ok(self.split(&text)?[1].to_owned())
    }

    /// The file's text with the generated part replaced.
    fn filled(self, text: &str, generated: &str) -> Result<String, ReadmeError> {
        let [before, _, after] = self.split(text)?;
        Ok(match self.markers {
            Some([begin, end]) => format!("{before}{begin}\n\n{generated}\n{end}{after}"),
            None => generated.to_owned(),
        })
    }

    /// Text before, between and after the marker lines.
    fn split(self, text: &str) -> Result<[&str; 3], ReadmeError> {
        let Some([begin, end]) = self.markers else { return Ok(["", text, ""]) };
        let missing = || ReadmeError::NoPlace { file: self.file, begin, end };
        let (before, rest) = text.split_once(begin).ok_or_else(missing)?;
        let (generated, after) = rest.split_once(end).ok_or_else(missing)?;
        Ok([before, generated, after])
    }
}
