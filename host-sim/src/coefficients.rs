//! Published coefficient sets, from the tables in `host-sim/data`.

use crate::reference::{Elements, Fiber, FiberType, Sag, Yielding};
use std::collections::BTreeMap;

const FIBERS: &str = include_str!("../data/fibers.csv");
const ELEMENTS: &str = include_str!("../data/elements.csv");

/// Default set.
pub const DEFAULT_SET: &str = "paper-table-1";

/// T_L of all published types, ms.
const EFFECTIVE_LENGTH_TIME: f64 = 0.088;

/// One row of a table: column name to value; an empty cell has no entry.
pub type Row = BTreeMap<String, f64>;

/// An error in a row, by column.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RowError {
    /// A required coefficient is missing.
    #[error("`{0}` is missing: the fibre type requires it")]
    Missing(&'static str),
    /// The rank is not a whole number from 1 to 255.
    #[error("`rank` = {0}: must be a whole number from 1 to 255")]
    Rank(f64),
}

/// Reads a table whose first `labels` columns are text; rows are keyed by those, joined by `/`.
fn table(text: &'static str, labels: usize) -> Vec<(String, Row)> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().expect("a header in the built-in table").clone();
    reader
        .records()
        .map(|record| {
            let record = record.expect("an even row in the built-in table");
            let label: Vec<&str> = record.iter().take(labels).collect();
            let row = header
                .iter()
                .zip(&record)
                .skip(labels)
                .filter(|(_, cell)| !cell.is_empty())
                .map(|(name, cell)| {
                    (name.to_owned(), cell.parse().expect("a number in the built-in table"))
                })
                .collect();
            (label.join("/"), row)
        })
        .collect()
}

/// Every preset fibre type, as ("set/type", row).
pub fn fiber_rows() -> Vec<(String, Row)> {
    table(FIBERS, 2)
}

/// Every set of shared elements, as ("set", row).
pub fn element_rows() -> Vec<(String, Row)> {
    table(ELEMENTS, 1)
}

/// Names of a fibre type's coefficients, in table order.
pub fn fiber_columns() -> Vec<String> {
    columns(FIBERS, 2)
}

/// Names of the elements' coefficients, in table order.
pub fn element_columns() -> Vec<String> {
    columns(ELEMENTS, 1)
}

fn columns(text: &'static str, labels: usize) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().expect("a header in the built-in table");
    header.iter().skip(labels).map(str::to_owned).collect()
}

/// The row of a preset fibre type, such as "paper-table-1/slow".
pub fn fiber_row(preset: &str) -> Option<Row> {
    find(fiber_rows(), preset)
}

/// A preset type with its share of the cross section, without motor units.
pub fn fiber(preset: &str, fraction: f64) -> Option<Fiber> {
    let fiber_type = fiber_type(&fiber_row(preset)?).ok()?;
    Some(Fiber { fraction, units: Vec::new(), fiber_type })
}

/// The shared elements of a set, such as "paper-table-1".
pub fn elements(set: &str) -> Option<Elements> {
    Some(elements_of(&element_row(set)?))
}

/// Row of a set of shared elements; every column has a value.
pub fn element_row(set: &str) -> Option<Row> {
    find(element_rows(), set)
}

/// Shared elements from a full row.
pub fn elements_of(row: &Row) -> Elements {
    let get = |name: &str| row.get(name).copied().expect("a full row in the built-in table");
    Elements {
        cT: get("cT"),
        kT: get("kT"),
        LrT: get("LrT"),
        c1: get("c1"),
        k1: get("k1"),
        Lr1: get("Lr1"),
        eta: get("eta"),
        c2: get("c2"),
        k2: get("k2"),
        Lr2: get("Lr2"),
        specific_tension: get("specific_tension_n_per_cm2") * 1e4,
        density: get("density_g_per_cm3") * 1e3,
    }
}

fn find(rows: Vec<(String, Row)>, label: &str) -> Option<Row> {
    rows.into_iter().find(|(name, _)| name == label).map(|(_, row)| row)
}

/// A fibre type from its row; times are converted from ms to s.
///
/// A row with any coefficient of sag (or yield) needs all of them. `TL_ms` (effective length) is
/// the same in all published types, which is the default.
pub fn fiber_type(row: &Row) -> Result<FiberType, RowError> {
    let get = |name: &'static str| row.get(name).copied().ok_or(RowError::Missing(name));
    let seconds = |name: &'static str| Ok::<f64, RowError>(get(name)? * 1e-3);
    let any = |names: &[&str]| names.iter().any(|&name| row.contains_key(name));
    let rank = get("rank")?;
    if !(1.0..=255.0).contains(&rank) || rank.fract() != 0.0 {
        return Err(RowError::Rank(rank));
    }
    Ok(FiberType {
        rank: rank as u8,
        f05: get("f05_pps")?,
        fmin: get("fmin")?,
        fmax: get("fmax")?,
        omega: get("omega")?,
        beta: get("beta")?,
        rho: get("rho")?,
        Vmax: get("Vmax")?,
        cV0: get("cV0")?,
        cV1: get("cV1")?,
        aV0: get("aV0")?,
        aV1: get("aV1")?,
        aV2: get("aV2")?,
        bV: get("bV")?,
        af: get("af")?,
        nf0: get("nf0")?,
        nf1: get("nf1")?,
        Tf1: seconds("Tf1_ms")?,
        Tf2: seconds("Tf2_ms")?,
        Tf3: seconds("Tf3_ms")?,
        Tf4: seconds("Tf4_ms")?,
        TL: row.get("TL_ms").copied().unwrap_or(EFFECTIVE_LENGTH_TIME) * 1e-3,
        sag: if any(&["aS1", "aS2", "TS_ms"]) {
            Some(Sag { aS1: get("aS1")?, aS2: get("aS2")?, TS: seconds("TS_ms")? })
        } else {
            None
        },
        yielding: if any(&["cY", "VY", "TY_ms"]) {
            Some(Yielding { cY: get("cY")?, VY: get("VY")?, TY: seconds("TY_ms")? })
        } else {
            None
        },
    })
}
