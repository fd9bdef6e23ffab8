//! Figure 7: cost of a tick by number of motor units, in cycles of a Cortex-M4F.
//!
//! `vm cycles`, which needs QEMU, writes them to `data/computation.csv`.

use super::files::{Figures, FiguresError};
use crate::chart::{Chart, Line, Panel, Point};
use crate::cycles::UnitCost;

/// The paper's ratios of computing time of discrete 30 + 30 to continuous: figure 7 and abstract.
pub(super) const PRINTED: [f64; 2] = [8.5, 15.0];
const MOST_UNITS: usize = 30;

/// Cycles of one mode over those of continuous recruitment.
#[derive(Clone, Debug)]
pub(super) struct Costs(Vec<UnitCost>);

impl Costs {
    fn of<'a>(&'a self, mode: &'a str) -> impl Iterator<Item = &'a UnitCost> {
        self.0.iter().filter(move |cost| cost.mode == mode)
    }

    /// By the number of motor units of each type.
    fn ratios(&self, mode: &str) -> Vec<Point> {
        let continuous = self.of("continuous").next().map_or(f64::NAN, |cost| cost.cycles as f64);
        let ratio = |cost: &UnitCost| (cost.units_per_type as f64, cost.cycles as f64 / continuous);
        self.of(mode).map(ratio).collect()
    }

    /// Of discrete recruitment of 30 + 30 units.
    pub(super) fn most(&self) -> f64 {
        self.ratios("discrete").last().map_or(f64::NAN, |point| point.1)
    }
}

pub(super) fn make(figures: &mut Figures) -> Result<Costs, FiguresError> {
    let costs = Costs(UnitCost::counted()?);
    figures.table("computation.csv", &costs.0)?;
    let most = MOST_UNITS as f64;
    let lines = vec![
        Line::new("continuous", [(1.0, 1.0), (most, 1.0)]),
        Line::new("discrete", costs.ratios("discrete")),
        Line::new("discrete, effective length", costs.ratios("discrete-leff")),
        Line::marks(
            "discrete in the paper, times (8.5 in figure 7, 15 in the abstract)",
            PRINTED.map(|ratio| (most, ratio)),
        ),
    ];
    let chart = Chart {
        title: "Figure 7: cycles of a tick over those of continuous recruitment",
        x: "motor units per type",
        panels: vec![Panel::new("cycles / continuous (1)", lines)],
    };
    figures.figure("computation.svg", &chart);
    Ok(costs)
}
