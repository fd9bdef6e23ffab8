//! Golden bits: the state of every scenario, tick by tick, as a checksum that must not change
//! without somebody saying why.

use crate::engine::{self, Arithmetic, RunError};
use crate::scenario;
use crate::trace::{TraceError, write_atomically};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The committed file.
pub const COMMITTED: &str = include_str!("../data/golden.toml");

/// The committed checksums, and why they are what they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Golden {
    /// Why the bits were last changed.
    pub reason: String,
    /// CRC-64/XZ of the state's words, in hexadecimal, by scenario, mode and arithmetic.
    pub state: BTreeMap<String, String>,
}

/// Why golden bits could not be had.
#[derive(Debug, thiserror::Error)]
pub enum GoldenError {
    /// A scenario could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The file could not be put together.
    #[error(transparent)]
    Format(#[from] toml::ser::Error),
    /// The committed file is not what it should be.
    #[error("data/golden.toml: {0}")]
    Parse(#[from] toml::de::Error),
}

/// The checksums of what is built.
pub fn compute() -> Result<BTreeMap<String, String>, RunError> {
    let cases: Vec<_> = scenario::all()
        .into_iter()
        .flat_map(|s| [Arithmetic::F32, Arithmetic::Fixed, Arithmetic::F64].map(|a| (s.clone(), a)))
        .collect();
    cases
        .par_iter()
        .map(|(scenario, arithmetic)| {
            let mode = engine::mode_name(scenario.mode);
            let key = format!("{} {mode} {}", scenario.name, arithmetic.name());
            let bits =
                engine::fingerprint(&scenario.muscle, scenario.mode, *arithmetic, &scenario.trace)?;
            Ok((key, format!("{bits:016x}")))
        })
        .collect()
}

/// What is committed.
pub fn committed() -> Result<Golden, GoldenError> {
    Ok(toml::from_str(COMMITTED)?)
}

/// What differs between the committed checksums and those of what is built; empty if nothing.
pub fn differences() -> Result<Vec<String>, GoldenError> {
    let committed = committed()?;
    let computed = compute()?;
    let mut found = Vec::new();
    for (key, bits) in &computed {
        match committed.state.get(key) {
            None => found.push(format!("{key}: {bits}, and no golden bits")),
            Some(golden) if golden != bits => found.push(format!("{key}: {bits}, golden {golden}")),
            Some(_) => {}
        }
    }
    let gone = committed.state.keys().filter(|key| !computed.contains_key(*key));
    found.extend(gone.map(|key| format!("{key}: golden bits of no scenario")));
    Ok(found)
}

/// Takes the bits of what is built as golden, for a reason.
pub fn bless(reason: &str) -> Result<(), GoldenError> {
    let golden = Golden { reason: reason.to_owned(), state: compute()? };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/golden.toml");
    write_atomically(&path, toml::to_string(&golden)?.as_bytes())?;
    Ok(())
}
