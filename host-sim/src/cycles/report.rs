//! The table of costs, and the budgets they are held to.

use super::adversarial;
use super::bench::{BenchError, Case, Measured, measure};
use crate::engine::{self, Arithmetic, RunError};
use crate::metrics::{ForceError, forces};
use crate::reference::Mode;
use crate::scenario::{self, Scenario, paper_muscle};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const BUDGETS: &str = include_str!("../../data/budgets.toml");
/// What the timing model may be short of hardware by.
const MARGIN: f64 = 1.05;
/// A budget of which less than this share is used is stale.
const USED: f64 = 0.8;

/// The cases that are measured, and what they are.
const CASES: [(Case, Mode, Arithmetic); 2] = [
    (
        Case { name: "continuous", function: "step_continuous_f32" },
        Mode::Continuous,
        Arithmetic::F32,
    ),
    (Case { name: "fes", function: "step_fes_f32" }, Mode::Fes, Arithmetic::F32),
];

/// What a case may cost.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// Pessimistic cycles of the most expensive tick, and the margin on top.
    pub cycles: u64,
    /// Bytes of a muscle's state.
    pub state_bytes: u32,
    /// Bytes of code.
    pub code_bytes: u32,
    /// Bytes of stack.
    pub stack_bytes: u32,
}

/// One row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the case.
    pub case: String,
    /// Recruitment mode.
    pub mode: String,
    /// What it is computed in.
    pub arithmetic: String,
    /// The core.
    pub target: String,
    /// Ticks that were measured.
    pub ticks: usize,
    /// Most instructions of a tick.
    pub instructions_max: u64,
    /// Mean cycles, typical setting.
    pub cycles_typ_mean: f64,
    /// Most cycles, typical setting.
    pub cycles_typ_max: u64,
    /// Most cycles, pessimistic setting.
    pub cycles_pess_max: u64,
    /// The tick that took most, counted from 0 over all scenarios.
    pub worst_tick: usize,
    /// Bytes of a muscle's state.
    pub state_bytes: u32,
    /// Bytes of code that was executed, whole functions.
    pub code_bytes: u32,
    /// Bytes of stack below the caller's.
    pub stack_bytes: u32,
    /// Largest error on the same inputs, adversarial ones apart, % of F0.
    pub max_pct_f0: f64,
    /// Budget in pessimistic cycles; 0 where there is none.
    pub budget: u64,
    /// Whether all budgets hold and none is stale.
    pub pass: bool,
    /// What is wrong with a row that does not pass.
    #[serde(skip)]
    pub problem: String,
}

/// Why there is no table.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The bench could not be run.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// A scenario could not be run on the host.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The budgets could not be read.
    #[error("data/budgets.toml: {0}")]
    Budgets(#[from] toml::de::Error),
}

/// Measures all cases and holds them to their budgets.
pub fn report() -> Result<Vec<Row>, ReportError> {
    let budgets: BTreeMap<String, Budget> = toml::from_str(BUDGETS)?;
    let paper = paper_muscle();
    let scenarios: Vec<Scenario> = scenario::all()
        .into_iter()
        .filter(|scenario| !scenario.name.contains('@') && scenario.muscle == paper)
        .collect();
    let mut inputs = scenarios.clone();
    inputs.push(adversarial::scenario());
    let measured = measure(&CASES.map(|(case, ..)| case), &inputs)?;
    CASES
        .iter()
        .zip(&measured)
        .map(|(&(_, mode, arithmetic), measured)| {
            let error = largest_error(&scenarios, mode, arithmetic)?;
            let key = format!("{}-{}", measured.case.name, arithmetic.name());
            Ok(row(mode, arithmetic, measured, error, budgets.get(&key)))
        })
        .collect()
}

/// Largest error of the force over all scenarios, % of F0.
fn largest_error(
    scenarios: &[Scenario],
    mode: Mode,
    arithmetic: Arithmetic,
) -> Result<f64, RunError> {
    let errors: Vec<f64> = scenarios
        .par_iter()
        .map(|scenario| {
            let run = |arithmetic| {
                let rows = engine::run(&scenario.muscle, mode, arithmetic, &scenario.trace)?;
                Ok::<_, RunError>(forces(rows.iter().map(|row| &row.0)))
            };
            let (computed, expected) = (run(arithmetic)?, run(Arithmetic::Reference)?);
            Ok(ForceError::between(&computed, &expected, scenario.muscle.f0()).max)
        })
        .collect::<Result<_, RunError>>()?;
    Ok(errors.into_iter().fold(0.0, f64::max))
}

fn row(
    mode: Mode,
    arithmetic: Arithmetic,
    measured: &Measured,
    max_pct_f0: f64,
    budget: Option<&Budget>,
) -> Row {
    let ticks = &measured.ticks;
    let typical = ticks.iter().map(|cost| cost.cycles[1]);
    let worst = (0..ticks.len()).max_by_key(|&tick| ticks[tick].cycles[2]).unwrap_or(0);
    let cycles_pess_max = ticks[worst].cycles[2];
    let state_bytes = size_of::<vm_nostd::State<f32, vm_nostd::NaturalContinuous, 2>>() as u32;
    let mut problems = Vec::new();
    match budget {
        None => problems.push("no budget".to_owned()),
        Some(budget) => {
            let cycles = (cycles_pess_max as f64 * MARGIN).ceil() as u64;
            let used = [
                ("cycles", cycles, budget.cycles),
                ("state_bytes", state_bytes.into(), budget.state_bytes.into()),
                ("code_bytes", measured.code_bytes.into(), budget.code_bytes.into()),
                ("stack_bytes", measured.stack_bytes.into(), budget.stack_bytes.into()),
            ];
            for (what, used, budget) in used {
                if used > budget {
                    problems.push(format!("{what} {used} > budget {budget}"));
                } else if (used as f64) < USED * budget as f64 {
                    problems.push(format!("{what} {used} leaves a stale budget of {budget}"));
                }
            }
        }
    }
    Row {
        case: measured.case.name.to_owned(),
        mode: engine::mode_name(mode).to_owned(),
        arithmetic: arithmetic.name().to_owned(),
        target: "cortex-m4f".to_owned(),
        ticks: ticks.len(),
        instructions_max: ticks.iter().map(|cost| cost.instructions).max().unwrap_or(0),
        cycles_typ_mean: typical.clone().sum::<u64>() as f64 / ticks.len() as f64,
        cycles_typ_max: typical.max().unwrap_or(0),
        cycles_pess_max,
        worst_tick: worst,
        state_bytes,
        code_bytes: measured.code_bytes,
        stack_bytes: measured.stack_bytes,
        max_pct_f0,
        budget: budget.map_or(0, |budget| budget.cycles),
        pass: problems.is_empty(),
        problem: problems.join("; "),
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::Cost;
    use super::*;

    /// What is wrong with a case whose worst tick takes 1000 pessimistic cycles.
    fn problem(budget: Option<Budget>) -> String {
        let cost = |cycles| Cost { instructions: cycles / 2, cycles: [cycles / 2, cycles, cycles] };
        let measured = Measured {
            case: CASES[0].0,
            ticks: vec![cost(900), cost(1000), cost(800)],
            stack_bytes: 200,
            code_bytes: 5000,
        };
        let row = row(Mode::Continuous, Arithmetic::F32, &measured, 0.1, budget.as_ref());
        assert_eq!((row.cycles_pess_max, row.worst_tick, row.ticks), (1000, 1, 3));
        assert_eq!(row.cycles_typ_mean, 900.0);
        assert_eq!(row.pass, row.problem.is_empty());
        row.problem
    }

    #[test]
    fn a_budget_is_neither_exceeded_nor_stale() {
        let budget = Budget { cycles: 1050, state_bytes: 64, code_bytes: 5000, stack_bytes: 200 };
        assert_eq!(problem(Some(budget)), "");
        assert_eq!(problem(None), "no budget");
        let with = |change: fn(&mut Budget)| {
            let mut changed = budget;
            change(&mut changed);
            problem(Some(changed))
        };
        assert_eq!(with(|b| b.cycles = 1049), "cycles 1050 > budget 1049");
        assert_eq!(with(|b| b.cycles = 1313), "cycles 1050 leaves a stale budget of 1313");
        assert_eq!(with(|b| b.stack_bytes = 199), "stack_bytes 200 > budget 199");
        assert_eq!(with(|b| b.code_bytes = 6300), "code_bytes 5000 leaves a stale budget of 6300");
        assert_eq!(with(|b| b.state_bytes = 63), "state_bytes 64 > budget 63");
    }
}
