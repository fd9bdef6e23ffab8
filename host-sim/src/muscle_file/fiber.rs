//! The table of a fibre type.

use super::refusal::{Refusal, override_by_name};
use crate::coefficients::{self, Row, RowError};
use crate::engine::MOST_UNITS;
use crate::reference::{Fiber, UnitSizes};
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Debug, Deserialize)]
pub(super) struct FiberTable {
    preset: Option<String>,
    fraction: f64,
    units: Option<i64>,
    unit_sizes: Option<UnitSizesKey>,
    #[serde(flatten)]
    overrides: BTreeMap<String, toml::Value>,
}

/// `unit_sizes`: a name, `{ geometric = 0.1 }`, or a list.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    deny_unknown_fields,
    expecting = "must be \"default\", \"equal\", { geometric = growth } or a list of numbers"
)]
enum UnitSizesKey {
    Named(String),
    Geometric { geometric: f64 },
    Listed(Vec<f64>),
}

/// The fibre type of a table.
pub(super) fn fiber(table: &FiberTable) -> Result<Fiber, Refusal> {
    let mut row = match &table.preset {
        None => Row::new(),
        Some(preset) => coefficients::fiber_row(preset).ok_or_else(|| {
            let known: Vec<String> =
                coefficients::fiber_rows().into_iter().map(|(name, _)| name).collect();
            let limit = format!("must be one of {}", known.join(", "));
            ("preset".to_owned(), format!("\"{preset}\""), limit)
        })?,
    };
    let columns = coefficients::fiber_columns();
    let has = "a fibre has preset, fraction, units, unit_sizes and";
    override_by_name(&mut row, &table.overrides, &columns, has)?;
    let fiber_type = coefficients::fiber_type(&row).map_err(|error| match error {
        RowError::Missing(name) => {
            (name.to_owned(), "(missing)".to_owned(), "give it, or a preset that has it".to_owned())
        }
        RowError::Rank(rank) => {
            ("rank".to_owned(), rank.to_string(), "must be a whole number from 1 to 255".to_owned())
        }
    })?;
    let units = units(table, fiber_type.rank)?;
    Ok(Fiber { fraction: table.fraction, units, fiber_type })
}

/// Least share of a unit in the cross section of its type.
const LEAST_SHARE: f64 = 1e-9;

/// Shares of the type's motor units; empty if the file gives no units.
fn units(table: &FiberTable, rank: u8) -> Result<Vec<f64>, Refusal> {
    let refuse =
        |key: &str, value: String, limit: &str| Err((key.to_owned(), value, limit.to_owned()));
    if let Some(units) = table.units
        && !(1..=MOST_UNITS as i64).contains(&units)
    {
        let limit = format!("must be a whole number from 1 to {MOST_UNITS}");
        return refuse("units", units.to_string(), &limit);
    }
    let count = table.units.map(|units| units as usize);
    let sizes = match &table.unit_sizes {
        None => UnitSizes::Default,
        Some(UnitSizesKey::Named(name)) => match name.as_str() {
            "default" => UnitSizes::Default,
            "equal" => UnitSizes::Equal,
            _ => {
                let limit = "must be \"default\", \"equal\", { geometric = growth } or a list";
                return refuse("unit_sizes", format!("\"{name}\""), limit);
            }
        },
        Some(UnitSizesKey::Geometric { geometric }) => {
            let geometric = *geometric;
            if !(-0.5..=1.0).contains(&geometric) {
                return refuse("unit_sizes.geometric", geometric.to_string(), "must be -0.5 to 1");
            }
            UnitSizes::Geometric(geometric)
        }
        Some(UnitSizesKey::Listed(sizes)) => {
            if let Some(size) = sizes.iter().find(|size| !(1e-6..=1e6).contains(*size)) {
                return refuse("unit_sizes", size.to_string(), "each must be 1e-6 to 1e6");
            }
            if count.is_some_and(|count| count != sizes.len()) || sizes.is_empty() {
                let limit = "must be as many as `units`, and at least one";
                return refuse("unit_sizes", format!("{} sizes", sizes.len()), limit);
            }
            UnitSizes::Listed(sizes.clone())
        }
    };
    let count = match &sizes {
        UnitSizes::Listed(sizes) => Some(sizes.len()),
        _ => count,
    };
    match count {
        Some(count) => {
            let shares = sizes.shares(rank, count);
            let least = shares.iter().copied().fold(1.0, f64::min);
            if least.is_nan() || least < LEAST_SHARE {
                let limit = format!("share of the smallest unit: must be at least {LEAST_SHARE}");
                return refuse("unit_sizes", least.to_string(), &limit);
            }
            Ok(shares)
        }
        None if table.unit_sizes.is_some() => {
            refuse("units", "(missing)".to_owned(), "give the number of units as well")
        }
        None => Ok(Vec::new()),
    }
}
