//! A result table that can be resumed after an interruption: complete rows are kept, a truncated
//! last row is computed again.

use crate::progress;
use crate::trace::{TraceError, cell_error, write_atomically};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc;

/// Why a table could not be opened, resumed or written.
#[derive(Debug, thiserror::Error)]
pub enum LedgerError {
    /// The file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// Another process holds the lock.
    #[error("{}: another run is writing it", .0.display())]
    Busy(PathBuf),
    /// The header is that of another run, or the file is no table.
    #[error("{}: begins with \"{found}\", expected \"{expected}\": not a table of this run; give --output another file, or remove {}", path.display(), path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// The line found.
        found: String,
        /// The line of this run's table.
        expected: String,
    },
    /// A row that this run would not write.
    #[error(transparent)]
    Row(#[from] TraceError),
}

/// The result table of a run of many cases.
#[derive(Debug)]
pub struct Ledger {
    path: PathBuf,
    file: File,
    head: [String; 2],
    count: usize,
    /// Rows by case.
    rows: BTreeMap<usize, Vec<String>>,
}

impl Ledger {
    /// Opens or creates a table of `count` cases. A truncated last row is dropped. The first cells
    /// of every other row must equal `begin` of its case.
    pub fn open(
        path: &Path,
        head: &[String; 2],
        count: usize,
        begin: &dyn Fn(usize) -> Vec<String>,
    ) -> Result<Self, LedgerError> {
        let failed = |source| LedgerError::File { path: path.to_owned(), source };
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(failed)?;
        file.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => LedgerError::Busy(path.to_owned()),
            TryLockError::Error(source) => failed(source),
        })?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        let text = String::from_utf8_lossy(&bytes[..whole]).into_owned();
        let mut lines = text.lines();
        for (index, expected) in head.iter().enumerate() {
            match lines.next() {
                Some(line) if line == expected => {}
                // Empty, or interrupted while writing the header: start again.
                None if is_prefix_of_head(head, &bytes) => {
                    file.set_len(0).and_then(|()| file.rewind()).map_err(failed)?;
                    let text = format!("{}\n{}\n", head[0], head[1]);
                    file.write_all(text.as_bytes()).map_err(failed)?;
                    return Ok(Self::new(path, file, head, count, BTreeMap::new()));
                }
                other => {
                    let found = other.unwrap_or_default().to_owned();
                    let expected = head[index].clone();
                    return Err(LedgerError::Other { path: path.to_owned(), found, expected });
                }
            }
        }
        let rows = rows(path, &text, head, count, begin)?;
        file.set_len(whole as u64).map_err(failed)?;
        file.seek(SeekFrom::End(0)).map_err(failed)?;
        Ok(Self::new(path, file, head, count, rows))
    }

    fn new(
        path: &Path,
        file: File,
        head: &[String; 2],
        count: usize,
        rows: BTreeMap<usize, Vec<String>>,
    ) -> Self {
        Self { path: path.to_owned(), file, head: head.clone(), count, rows }
    }

    /// Cases without a row.
    fn missing(&self) -> Vec<usize> {
        (0..self.count).filter(|case| !self.rows.contains_key(case)).collect()
    }

    /// The rows, by case.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &[String])> {
        self.rows.iter().map(|(&case, row)| (case, row.as_slice()))
    }

    /// Appends a row; its first cell is the number of its case.
    fn append(&mut self, row: &[String]) -> Result<(), LedgerError> {
        let failed = |source| LedgerError::File { path: self.path.clone(), source };
        let line = line(row).map_err(failed)?;
        // One write per row: an interruption can only truncate the last row.
        self.file.write_all(&line).map_err(failed)?;
        if let Some(case) = row.first().and_then(|cell| cell.parse().ok()) {
            self.rows.insert(case, row.to_vec());
        }
        Ok(())
    }

    /// Computes the missing rows on all cores, then sorts the table: its bytes do not depend on
    /// interruptions.
    pub fn complete(
        &mut self,
        row: impl Fn(usize) -> Vec<String> + Sync,
    ) -> Result<(), LedgerError> {
        let missing = self.missing();
        let progress = progress::bar("computing cases", self.count);
        progress.set_position((self.count - missing.len()) as u64);
        let (sender, receiver) = mpsc::channel::<Vec<String>>();
        std::thread::scope(|scope| {
            let writer = scope.spawn(|| {
                for row in receiver {
                    self.append(&row)?;
                    progress.inc(1);
                }
                Ok::<(), LedgerError>(())
            });
            // Sending fails only if the writer stopped; its own error is returned below.
            let _stopped = missing
                .into_par_iter()
                .try_for_each_with(sender, |sender, case| sender.send(row(case)));
            writer.join().expect("the writer does not panic")
        })?;
        progress.finish_and_clear();
        self.finish()
    }

    /// Rewrites the table with its rows sorted by case.
    fn finish(&mut self) -> Result<(), LedgerError> {
        let failed = |source| LedgerError::File { path: self.path.clone(), source };
        let mut bytes = format!("{}\n{}\n", self.head[0], self.head[1]).into_bytes();
        for row in self.rows.values() {
            bytes.extend(line(row).map_err(failed)?);
        }
        Ok(write_atomically(&self.path, &bytes)?)
    }
}

fn line(row: &[String]) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(row)?;
    writer.into_inner().map_err(|error| std::io::Error::other(error.to_string()))
}

/// Whether the bytes are a prefix of the table's header.
fn is_prefix_of_head(head: &[String; 2], bytes: &[u8]) -> bool {
    format!("{}\n{}\n", head[0], head[1]).as_bytes().starts_with(bytes)
}

/// Parses the rows below the header and checks that they belong to this run.
fn rows(
    path: &Path,
    text: &str,
    head: &[String; 2],
    count: usize,
    begin: &dyn Fn(usize) -> Vec<String>,
) -> Result<BTreeMap<usize, Vec<String>>, LedgerError> {
    let body = &text[head[0].len() + head[1].len() + 2..];
    let columns = head[1].split(',').count();
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(body.as_bytes());
    let mut rows = BTreeMap::new();
    for record in reader.records() {
        let refused = |line: u64, column: &str, problem: String| {
            LedgerError::Row(cell_error(path, line + 2, column, problem))
        };
        let record = record.map_err(|error| {
            let line = error.position().map_or(0, csv::Position::line);
            refused(line, "(any)", error.to_string())
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let row: Vec<String> = record.iter().map(str::to_owned).collect();
        if row.len() != columns {
            let problem = format!("{} cells, the header has {columns}", row.len());
            return Err(refused(line, "(any)", problem));
        }
        let case = row[0].parse().ok().filter(|case| (0..count).contains(case));
        let Some(case) = case else {
            let problem = format!("\"{}\": must be a whole number below {count}", row[0]);
            return Err(refused(line, "case", problem));
        };
        let expected = begin(case);
        for ((cell, expected), column) in row.iter().zip(&expected).zip(head[1].split(',')) {
            if cell != expected {
                let problem = format!("\"{cell}\": case {case} has {expected}");
                return Err(refused(line, column, problem));
            }
        }
        if row[expected.len()..].iter().all(String::is_empty) {
            return Err(refused(line, "(any)", format!("case {case} has no result")));
        }
        if rows.insert(case, row).is_some() {
            return Err(refused(line, "case", format!("{case} occurs twice")));
        }
    }
    Ok(rows)
}
