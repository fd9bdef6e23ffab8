//! Cost of a tick in `f32` by number of motor units, for figure 7 of the paper. Measured with the
//! table.

use super::case::{Case, Subject};
use super::core::Core;
use super::row::Row;
use crate::engine::{self, Arithmetic};
use crate::reference::Mode;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Written by `vm cycles --write`.
const COUNTED: &str = include_str!("../../data/computation.csv");

/// Cost of a tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitCost {
    /// Recruitment mode.
    pub mode: String,
    /// Motor units of each of two types; 1 under continuous recruitment.
    pub units_per_type: usize,
    /// Mean cycles on a Cortex-M4F, typical setting of the timing model.
    pub cycles: u64,
    /// Most instructions in a tick.
    pub instructions: u64,
}

impl UnitCost {
    /// Selects the rows in `f32` on the Cortex-M4F.
    pub fn of(rows: &[Row]) -> Vec<Self> {
        let cost = |row: &Row| {
            if row.target != Core::CortexM4F {
                return None;
            }
            let (mode, units_per_type) = match Case::named(&row.case)?.subject {
                Subject::Model(Mode::Continuous, Arithmetic::F32) => (Mode::Continuous, 1),
                Subject::Discrete(units) => (Mode::Discrete, units),
                Subject::EffectiveLength(units) => (Mode::DiscreteEffectiveLength, units),
                _ => return None,
            };
            Some(Self {
                mode: engine::mode_name(mode).to_owned(),
                units_per_type,
                cycles: row.cycles_typ_mean.round() as u64,
                instructions: row.instructions_max,
            })
        };
        let mut costs: Vec<Self> = rows.iter().filter_map(cost).collect();
        costs.sort_by(|a, b| (&a.mode, a.units_per_type).cmp(&(&b.mode, b.units_per_type)));
        costs
    }

    /// Reads the stored costs.
    pub fn counted() -> Result<Vec<Self>, csv::Error> {
        csv::Reader::from_reader(COUNTED.as_bytes()).deserialize().collect()
    }

    /// Path of the stored costs.
    pub fn path() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("data/computation.csv")
    }

    /// Encodes costs in the format of that file.
    pub fn file(costs: &[Self]) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        costs.iter().try_for_each(|cost| writer.serialize(cost))?;
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}
