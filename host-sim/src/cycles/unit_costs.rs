//! What a tick in `f32` costs by the number of motor units: counted with the table, and kept for
//! figure 7 of the paper.

use super::case::{Case, Subject};
use super::core::Core;
use super::row::Row;
use crate::engine::{self, Arithmetic};
use crate::reference::Mode;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// What `vm cycles --write` has counted.
const COUNTED: &str = include_str!("../../data/computation.csv");

/// What a tick costs on average.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitCost {
    /// Recruitment mode.
    pub mode: String,
    /// Motor units of each of two types; 1 under continuous recruitment.
    pub units_per_type: usize,
    /// Mean cycles of a Cortex-M4F, typical setting of the timing model.
    pub cycles: u64,
    /// Instructions of the longest tick.
    pub instructions: u64,
}

impl UnitCost {
    /// Those of the rows of the table that are of `f32`.
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

    /// Those that were counted last.
    pub fn counted() -> Result<Vec<Self>, csv::Error> {
        csv::Reader::from_reader(COUNTED.as_bytes()).deserialize().collect()
    }

    /// Where they are kept.
    pub fn path() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("data/computation.csv")
    }

    /// Costs as that file has them.
    pub fn file(costs: &[Self]) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        costs.iter().try_for_each(|cost| writer.serialize(cost))?;
        writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}
