//! Golden bits: one checksum per scenario and arithmetic over the state of all ticks. Changing one
//! needs a reason (`cargo vm golden --bless --reason`).

use crate::engine::{self, Arithmetic, RunError};
use crate::scenario;
use crate::trace::{TraceError, write_atomically};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The committed file.
pub const COMMITTED: &str = include_str!("../data/golden.toml");

/// The committed checksums and the reason for their last change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Golden {
    /// Why the bits were last changed.
    pub reason: String,
    /// CRC-64/XZ of the state's words, in hexadecimal, by scenario, mode and arithmetic.
    pub state: BTreeMap<String, String>,
}

/// Why the golden bits could not be compared or written.
#[derive(Debug, thiserror::Error)]
pub enum GoldenError {
    /// A scenario could not be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] TraceError),
    /// The file could not be serialised.
    #[error(transparent)]
    Format(#[from] toml::ser::Error),
    /// The committed file could not be parsed.
    #[error("data/golden.toml: {0}")]
    Parse(#[from] toml::de::Error),
}

/// Checksums of this build.
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

/// The model's version and a checksum of its golden bits: identifies the model that made a table.
pub fn model() -> String {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let bits = crc.checksum(COMMITTED.as_bytes());
    format!("vm {} with golden bits {bits:08x}", env!("CARGO_PKG_VERSION"))
}

/// The committed checksums.
pub fn committed() -> Result<Golden, GoldenError> {
    Ok(toml::from_str(COMMITTED)?)
}

/// Differences between the committed checksums and those of this build.
pub fn differences() -> Result<Vec<String>, GoldenError> {
    let committed = committed()?;
    let computed = compute()?;
    let mut found = Vec::new();
    for (key, bits) in &computed {
        match committed.state.get(key) {
            None => found.push(format!("{key}: {bits}, no golden bits")),
            Some(golden) if golden != bits => found.push(format!("{key}: {bits}, golden {golden}")),
            Some(_) => {}
        }
    }
    let gone = committed.state.keys().filter(|key| !computed.contains_key(*key));
    found.extend(gone.map(|key| format!("{key}: golden bits without a scenario")));
    Ok(found)
}

/// Stores the bits of this build as golden, with a reason.
pub fn bless(reason: &str) -> Result<(), GoldenError> {
    let golden = Golden { reason: reason.to_owned(), state: compute()? };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/golden.toml");
    write_atomically(&path, toml::to_string(&golden)?.as_bytes())?;
    Ok(())
}
