//! A row of the table of costs.

use super::breakdown::Part;
use super::core::Core;
use super::estimator::Cost;
use serde::{Deserialize, Serialize};

/// What the timing model may be short of hardware by.
pub const MARGIN: f64 = 1.05;
/// Core clocks that muscles are counted for, MHz.
pub const CLOCKS: [u32; 4] = [48, 84, 168, 480];

/// Cycles of a tick in one setting of the timing model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// What 99 of 100 ticks do not exceed.
    pub p99: u64,
    /// Most.
    pub max: u64,
}

impl Spread {
    /// Of some ticks in a setting, by its index.
    pub fn of(calls: &[Cost], setting: usize) -> Self {
        let mut cycles: Vec<u64> = calls.iter().map(|cost| cost.cycles[setting]).collect();
        cycles.sort_unstable();
        let Some(&max) = cycles.last() else { return Self::default() };
        let mean = cycles.iter().sum::<u64>() as f64 / cycles.len() as f64;
        let p99 = cycles[(cycles.len() * 99).div_ceil(100) - 1];
        Self { mean, p99, max }
    }
}

/// A part of what a tick takes, on average.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// What it is the part of.
    pub name: String,
    /// Instructions.
    pub instructions: f64,
    /// Cycles, typical setting.
    pub cycles: f64,
}

impl Share {
    /// Of so many ticks.
    pub(super) fn of(part: Part, ticks: usize) -> Self {
        let mean = |all: u64| all as f64 / ticks as f64;
        let Part { name, cost } = part;
        Self { name, instructions: mean(cost.instructions), cycles: mean(cost.cycles[1]) }
    }

    /// The sum of parts.
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
    /// Recruitment mode; `-` where it is no muscle.
    pub mode: String,
    /// What it is computed in.
    pub arithmetic: String,
    /// The core.
    pub target: Core,
    /// Accuracy class of the model.
    #[serde(default)]
    pub class: String,
    /// Ticks that were measured.
    pub ticks: usize,
    /// Most instructions of a tick.
    pub instructions_max: u64,
    /// Mean cycles, optimistic setting.
    pub cycles_opt_mean: f64,
    /// Cycles that 99 of 100 ticks do not exceed, optimistic setting.
    pub cycles_opt_p99: u64,
    /// Most cycles, optimistic setting.
    pub cycles_opt_max: u64,
    /// Mean cycles, typical setting.
    pub cycles_typ_mean: f64,
    /// Cycles that 99 of 100 ticks do not exceed, typical setting.
    pub cycles_typ_p99: u64,
    /// Most cycles, typical setting.
    pub cycles_typ_max: u64,
    /// Mean cycles, pessimistic setting.
    pub cycles_pess_mean: f64,
    /// Cycles that 99 of 100 ticks do not exceed, pessimistic setting.
    pub cycles_pess_p99: u64,
    /// Most cycles, pessimistic setting.
    pub cycles_pess_max: u64,
    /// The tick that took most, counted from 0 over all scenarios.
    pub worst_tick: usize,
    /// The command that replays that tick.
    pub replay: String,
    /// Bytes of a muscle's state.
    pub state_bytes: u32,
    /// Bytes of code that was executed, whole functions.
    pub code_bytes: u32,
    /// Bytes of code and tables of the model in this arithmetic, both modes; none for the others.
    #[serde(default)]
    pub both_modes_bytes: Option<u32>,
    /// Bytes of stack below the caller's.
    pub stack_bytes: u32,
    /// Largest error on the same inputs, adversarial ones apart, % of F0; none without a force.
    pub max_pct_f0: Option<f64>,
    /// Pessimistic maximum over that of the model in `f32` and the same mode; none for the model.
    pub ratio: Option<f64>,
    /// Budget in pessimistic cycles; none for what the model is compared with.
    pub budget: Option<u64>,
    /// Whether all budgets hold and none is stale.
    pub pass: bool,
    /// What a tick takes, by the model's file that it is part of, most first; none for what is not
    /// the model.
    #[serde(default)]
    pub files: Vec<Share>,
    /// The same by class of instruction.
    #[serde(default)]
    pub classes: Vec<Share>,
    /// What is wrong with a row that does not pass.
    #[serde(skip)]
    pub problem: String,
}

impl Row {
    /// The most expensive tick relative to the mean, pessimistic.
    pub fn maximum_over_mean(&self) -> f64 {
        self.cycles_pess_max as f64 / self.cycles_pess_mean
    }

    /// Muscles that a core of `megahertz` steps at 1 kHz in a `share` of its time, 0..1.
    pub fn muscles(&self, megahertz: u32, share: f64) -> u64 {
        let cycles_per_tick = f64::from(megahertz) * 1e3 * share;
        (cycles_per_tick / (self.cycles_pess_max as f64 * MARGIN)) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ninety_nine_of_a_hundred_ticks_do_not_exceed_p99() {
        let calls: Vec<Cost> =
            (1..=200).map(|n| Cost { instructions: n, cycles: [n, 2 * n, 3 * n] }).collect();
        assert_eq!(Spread::of(&calls, 1), Spread { mean: 201.0, p99: 396, max: 400 });
        assert_eq!(Spread::of(&calls[..1], 0), Spread { mean: 1.0, p99: 1, max: 1 });
    }
}
