//! Places of generated tables in the documents.

use crate::trace::{TraceError, write_atomically};
use std::path::{Path, PathBuf};

/// Place of a generated table: between two marker lines of a Markdown file.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    file: &'static str,
    begin: &'static str,
    end: &'static str,
}

/// The front page's table: cycles, memory and accuracy.
pub const FIT: Place = Place {
    file: "README.md",
    begin: "<!-- fit: cargo vm readme --write -->",
    end: "<!-- end of fit -->",
};
/// Accuracy of every scenario.
pub const MEASURED: Place = Place {
    file: "host-sim/docs/accuracy.md",
    begin: "<!-- measured: cargo vm readme --write -->",
    end: "<!-- end of measured -->",
};
/// The error budget: scheme and arithmetic apart.
pub const ERROR_BUDGET: Place = Place {
    file: "host-sim/docs/accuracy.md",
    begin: "<!-- error budget: cargo vm readme --write -->",
    end: "<!-- end of error budget -->",
};
/// Cycles, code size and stack.
pub const CYCLES: Place = Place {
    file: "host-sim/docs/cycles.md",
    begin: "<!-- cycles: cargo vm cycles --write -->",
    end: "<!-- end of cycles -->",
};
/// The stimulator's memory.
pub const STACK: Place = Place {
    file: "firmware/README.md",
    begin: "<!-- memory: cargo vm stack --write -->",
    end: "<!-- end of memory -->",
};

/// Place of the recovery of synthetic patients.
pub const RECOVERY: Place = Place {
    file: "host-sim/docs/fitting.md",
    begin: "<!-- recovery: cargo vm recover --output FILE --write -->",
    end: "<!-- end of recovery -->",
};

/// Place of the comparison with real muscle.
pub const SCOREBOARD: Place = Place {
    file: "host-sim/docs/fitting.md",
    begin: "<!-- scoreboard: cargo vm measured --data DIR --write -->",
    end: "<!-- end of scoreboard -->",
};

/// Why a document could not be compared or written.
#[derive(Debug, thiserror::Error)]
pub enum ReadmeError {
    /// It could not be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The marker lines of the table are missing.
    #[error("{} has no lines \"{}\" and \"{}\"", .0.file, .0.begin, .0.end)]
    NoPlace(Place),
    /// The table of cycles has no such cell.
    #[error("{}: no number in row {row}, column {column}", CYCLES.file)]
    NoCell {
        /// Name of the case.
        row: &'static str,
        /// Heading.
        column: &'static str,
    },
    /// The model refused the picture's muscle.
    #[error(transparent)]
    Run(#[from] crate::engine::RunError),
}

pub(super) fn path_of(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}

pub(super) fn read(path: &Path) -> Result<String, ReadmeError> {
    let error = |source| ReadmeError::Read { path: path.to_owned(), source };
    std::fs::read_to_string(path).map_err(error)
}

impl Place {
    /// Name of the file.
    pub fn file(self) -> &'static str {
        self.file
    }

    /// Whether a table is the one that stands in the file.
    pub fn is_current(self, table: &str) -> Result<bool, ReadmeError> {
        let text = read(&path_of(self.file))?;
        Ok(self.filled(&text, table)? == text)
    }

    /// Writes a table into the file.
    pub fn write(self, table: &str) -> Result<(), ReadmeError> {
        let path = path_of(self.file);
        let text = self.filled(&read(&path)?, table)?;
        write_atomically(&path, text.as_bytes())?;
        Ok(())
    }

    /// The table that stands in the file.
    pub fn table(self) -> Result<String, ReadmeError> {
        let text = read(&path_of(self.file))?;
        Ok(self.split(&text)?.1.to_owned())
    }

    /// A file's text with another table.
    fn filled(self, text: &str, table: &str) -> Result<String, ReadmeError> {
        let Place { begin, end, .. } = self;
        let (before, _, after) = self.split(text)?;
        Ok(format!("{before}{begin}\n\n{table}\n{end}{after}"))
    }

    /// Text before, between and after the marker lines.
    fn split(self, text: &str) -> Result<(&str, &str, &str), ReadmeError> {
        let missing = || ReadmeError::NoPlace(self);
        let (before, rest) = text.split_once(self.begin).ok_or_else(missing)?;
        let (table, after) = rest.split_once(self.end).ok_or_else(missing)?;
        Ok((before, table, after))
    }
}
