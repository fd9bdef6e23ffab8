//! Figures and tables, by the name of the file.

use super::claim::Claim;
use crate::arm::ArmError;
use crate::chart::Chart;
use crate::engine::RunError;
use crate::trace::{TraceError, write_atomically};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Why figures could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FiguresError {
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The arm failed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The folder could not be created.
    #[error("{}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A table could not be serialised.
    #[error(transparent)]
    Table(#[from] csv::Error),
}

/// The figures and their tables, by the name of the file.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    files: Vec<(&'static str, Vec<u8>)>,
    /// The paper's claims.
    pub claims: Vec<Claim>,
}

impl Figures {
    /// Writes all files into a folder, which is created if missing.
    pub fn write(&self, folder: &Path) -> Result<(), FiguresError> {
        std::fs::create_dir_all(folder)
            .map_err(|source| FiguresError::Folder { path: folder.to_owned(), source })?;
        for (name, bytes) in &self.files {
            write_atomically(&folder.join(name), bytes)?;
        }
        Ok(())
    }

    /// The text of a file.
    pub fn file(&self, name: &str) -> Option<&str> {
        let (_, bytes) = self.files.iter().find(|(file, _)| *file == name)?;
        std::str::from_utf8(bytes).ok()
    }

    pub(super) fn table<T: Serialize>(
        &mut self,
        name: &'static str,
        rows: &[T],
    ) -> Result<(), FiguresError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        rows.iter().try_for_each(|row| writer.serialize(row))?;
        let text = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
        self.files.push((name, text));
        Ok(())
    }

    pub(super) fn figure(&mut self, name: &'static str, chart: &Chart<'_>) {
        self.files.push((name, chart.draw().into_bytes()));
    }
}
