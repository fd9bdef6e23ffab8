//! A row of the table of costs.

use super::breakdown::Part;
use super::core::Core;
use super::estimator::Cost;
use crate::engine::Class;
use serde::{Deserialize, Serialize};

/// Safety factor on pessimistic cycles: the timing model may underestimate hardware by this.
pub const MARGIN: f64 = 1.05;
/// Core clocks for which the number of muscles is stated, MHz.
pub const CLOCKS: [u32; 4] = [48, 84, 168, 480];

/// Cycles of a tick in one setting of the timing model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 99th percentile.
    pub p99: u64,
    /// Maximum.
    pub max: u64,
}

impl Spread {
    /// Statistics of the ticks in the setting with an index.
    pub fn of(calls: &[Cost], setting: usize) -> Self {
        let mut cycles: Vec<u64> = calls.iter().map(|cost| cost.cycles[setting]).collect();
        cycles.sort_unstable();
        let Some(&max) = cycles.last() else { return Self::default() };
        let mean = cycles.iter().sum::<u64>() as f64 / cycles.len() as f64;
        let p99 = cycles[(cycles.len() * 99).div_ceil(100) - 1];
        Self { mean, p99, max }
    }
}

/// Mean share of one part in the cost of a tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// Name of the file or class.
    pub name: String,
    /// Instructions.
    pub instructions: f64,
    /// Cycles, typical setting.
    pub cycles: f64,
}

impl Share {
    /// Mean over a number of ticks.
    pub(super) fn of(part: Part, ticks: usize) -> Self {
        let mean = |all: u64| all as f64 / ticks as f64;
        let Part { name, cost } = part;
        Self { name, instructions: mean(cost.instructions), cycles: mean(cost.cycles[1]) }
    }

    /// Sum of shares.
    pub fn all(parts: &[Self]) -> Self {
        let sum = |what: fn(&Self) -> f64| parts.iter().map(what).sum();
        Self {
            name: "all".to_owned(),
            instructions: sum(|part| part.instructions),
            cycles: sum(|part| part.cycles),
        }
    }
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the case.
    pub case: String,
    /// Recruitment mode; `-` if the case has none.
    pub mode: String,
    /// Arithmetic.
    pub arithmetic: String,
    /// The core.
    pub target: Core,
    /// Accuracy class of the model.
    #[serde(default)]
    pub class: Class,
    /// Number of measured ticks.
    pub ticks: usize,
    /// Most instructions in a tick.
    pub instructions_max: u64,
    /// Mean cycles, optimistic setting.
    pub cycles_opt_mean: f64,
    /// 99th percentile of cycles, optimistic setting.
    pub cycles_opt_p99: u64,
    /// Most cycles, optimistic setting.
    pub cycles_opt_max: u64,
    /// Mean cycles, typical setting.
    pub cycles_typ_mean: f64,
    /// 99th percentile of cycles, typical setting.
    pub cycles_typ_p99: u64,
    /// Most cycles, typical setting.
    pub cycles_typ_max: u64,
    /// Mean cycles, pessimistic setting.
    pub cycles_pess_mean: f64,
    /// 99th percentile of cycles, pessimistic setting.
    pub cycles_pess_p99: u64,
    /// Most cycles, pessimistic setting.
    pub cycles_pess_max: u64,
    /// The most expensive tick, counted from 0 over all scenarios.
    pub worst_tick: usize,
    /// The command that profiles that tick.
    pub replay: String,
    /// Bytes of a muscle's state.
    pub state_bytes: u32,
    /// Total size of the executed functions, bytes.
    pub code_bytes: u32,
    /// Code and tables of both modes of the model in this arithmetic, bytes; `None` for baselines.
    #[serde(default)]
    pub both_modes_bytes: Option<u32>,
    /// Stack high watermark below the caller's frame, bytes.
    pub stack_bytes: u32,
    /// As `max_pct_f0`, without the scenarios in which the tendon rings.
    pub smooth_pct_f0: Option<f64>,
    /// Largest error on the same inputs except the adversarial ones, % of F0; `None` if the case
    /// computes no force.
    pub max_pct_f0: Option<f64>,
    /// Pessimistic maximum over that of the model in `f32` and the same mode; `None` for the model.
    pub ratio: Option<f64>,
    /// Budget in pessimistic cycles; `None` for baselines.
    pub budget: Option<u64>,
    /// Whether all budgets hold and none is stale.
    pub pass: bool,
    /// Mean cost of a tick by source file of the model, most expensive first; empty for baselines.
    #[serde(default)]
    pub files: Vec<Share>,
    /// The same by class of instruction.
    #[serde(default)]
    pub classes: Vec<Share>,
    /// Why the row does not pass.
    #[serde(skip)]
    pub problem: String,
}

impl Row {
    /// The most expensive tick over the mean, pessimistic setting.
    pub fn maximum_over_mean(&self) -> f64 {
        self.cycles_pess_max as f64 / self.cycles_pess_mean
    }

    /// Number of muscles that a core at `megahertz` steps at 1 kHz in a `share` (0..1) of its time.
    pub fn muscles(&self, megahertz: u32, share: f64) -> u64 {
        let cycles_per_tick = f64::from(megahertz) * 1e3 * share;
        (cycles_per_tick / (self.cycles_pess_max as f64 * MARGIN)) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_has_mean_p99_and_maximum() {
        let calls: Vec<Cost> =
            (1..=200).map(|n| Cost { instructions: n, cycles: [n, 2 * n, 3 * n] }).collect();
        assert_eq!(Spread::of(&calls, 1), Spread { mean: 201.0, p99: 396, max: 400 });
        assert_eq!(Spread::of(&calls[..1], 0), Spread { mean: 1.0, p99: 1, max: 1 });
    }
}
