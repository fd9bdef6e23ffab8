//! Budgets of cycles, state, code and stack, and the check against them.

use super::case::{Case, Subject};
use super::core::Core;
use super::row::{MARGIN, Row, Share};
use crate::engine::Arithmetic;
use serde::Deserialize;
use std::collections::BTreeMap;

const BUDGETS: &str = include_str!("../../data/budgets.toml");
/// A budget is stale if less than this share of it is used.
const USED: f64 = 0.8;

/// Contents of `data/budgets.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Budgets {
    /// Upper limit of the most expensive tick over the mean, pessimistic setting.
    maximum_over_mean: f64,
    /// Lower limit of the literal port's cycles over the model's, both in `f32`.
    literal_over_model: f64,
    /// By core and case of the model or the controller.
    core: BTreeMap<Core, BTreeMap<String, Budget>>,
}

/// Budget of one case.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Budget {
    /// Pessimistic cycles of the most expensive tick, including the margin.
    cycles: u64,
    /// Bytes of a muscle's state.
    state_bytes: u32,
    /// Bytes of code.
    code_bytes: u32,
    /// Bytes of code and tables of both modes; of the model only.
    both_modes_bytes: Option<u32>,
    /// Bytes of stack.
    stack_bytes: u32,
}

impl Budgets {
    /// Reads `data/budgets.toml`.
    pub fn read() -> Result<Self, toml::de::Error> {
        toml::from_str(BUDGETS)
    }

    /// State budget of a case, bytes.
    pub fn state_bytes(&self, case: &str) -> Option<u32> {
        self.core.get(&Core::CortexM4F)?.get(case).map(|budget| budget.state_bytes)
    }

    /// Checks a case's row against its budget and records the result in the row.
    pub fn hold(&self, case: &Case, row: &mut Row) {
        let budget = self.core.get(&row.target).and_then(|cases| cases.get(case.name));
        let problems = match (case.subject, budget) {
            (Subject::Model(..), Some(budget)) => {
                let mut problems = problems(row, budget);
                problems.extend(self.uneven(row));
                problems
            }
            (Subject::Controller(_), Some(budget)) => problems(row, budget),
            (Subject::Model(..) | Subject::Controller(_), None) => vec!["no budget".to_owned()],
            (Subject::Literal(_, Arithmetic::F32), _) => self.problems_of_literal(row),
            _ => Vec::new(),
        };
        row.budget = budget.map(|budget| budget.cycles);
        row.pass = problems.is_empty();
        row.problem = problems.join("; ");
    }

    /// The most expensive tick of the model against the mean.
    fn uneven(&self, row: &Row) -> Option<String> {
        let (spread, most) = (row.maximum_over_mean(), self.maximum_over_mean);
        // NaN fails every comparison, so it is never within the limit.
        let within = spread <= most;
        (!within).then(|| format!("maximum over mean {spread:.3} > {most}"))
    }

    fn problems_of_literal(&self, row: &Row) -> Vec<String> {
        let least = self.literal_over_model;
        match row.ratio {
            Some(ratio) if least < USED * ratio => {
                vec![format!("{ratio:.1} times the model leaves a stale limit of {least}")]
            }
            Some(ratio) if ratio >= least => Vec::new(),
            Some(ratio) => vec![format!("{ratio:.1} times the model < {least}")],
            None => vec!["no model to compare with".to_owned()],
        }
    }
}

/// What of a row is beyond its budget or leaves it stale.
fn problems(row: &Row, budget: &Budget) -> Vec<String> {
    let cycles = (row.cycles_pess_max as f64 * MARGIN).ceil() as u64;
    let both_modes = budget.both_modes_bytes.map(|budget| {
        let used = row.both_modes_bytes.map_or(u64::MAX, u64::from);
        ("both_modes_bytes", used, budget.into())
    });
    let used = [
        ("cycles", cycles, budget.cycles),
        ("state_bytes", row.state_bytes.into(), budget.state_bytes.into()),
        ("code_bytes", row.code_bytes.into(), budget.code_bytes.into()),
        ("stack_bytes", row.stack_bytes.into(), budget.stack_bytes.into()),
    ];
    let mut problems: Vec<String> = used
        .into_iter()
        .chain(both_modes)
        .filter_map(|(what, used, budget)| {
            if used > budget {
                Some(format!("{what} {used} > budget {budget}"))
            } else if (used as f64) < USED * budget as f64 {
                Some(format!("{what} {used} leaves a stale budget of {budget}"))
            } else {
                None
            }
        })
        .collect();
    for (what, parts) in [("files", &row.files), ("classes", &row.classes)] {
        let (sum, mean) = (Share::all(parts).cycles, row.cycles_typ_mean);
        let adds_up = (sum - mean).abs() < 0.5;
        if !adds_up {
            problems.push(format!("{what} add up to {sum:.0} of {mean:.0} cycles"));
        }
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::super::case::CASES;
    use super::super::report::{cases_on, tests::a_row};
    use super::*;

    fn budgets() -> Budgets {
        let budget = Budget {
            cycles: 1050,
            state_bytes: CASES[0].state_bytes(),
            code_bytes: 5000,
            both_modes_bytes: Some(9000),
            stack_bytes: 200,
        };
        let cases = [(CASES[0].name.to_owned(), budget)].into();
        let core = [(Core::CortexM4F, cases)].into();
        Budgets { maximum_over_mean: 1.12, literal_over_model: 100.0, core }
    }

    /// The problem of a row after a change of budgets or row; empty if it passes.
    fn problem(case: &Case, change: impl Fn(&mut Budgets, &mut Row)) -> String {
        let (mut budgets, mut row) = (budgets(), a_row(case));
        change(&mut budgets, &mut row);
        budgets.hold(case, &mut row);
        assert_eq!(row.pass, row.problem.is_empty());
        row.problem
    }

    #[test]
    fn exceeded_and_stale_budgets_are_reported() {
        let with = |change: fn(&mut Budget)| {
            problem(&CASES[0], |budgets, _| {
                budgets.core.values_mut().flat_map(BTreeMap::values_mut).for_each(change);
            })
        };
        assert_eq!(with(|_| ()), "");
        assert_eq!(with(|b| b.cycles = 1049), "cycles 1050 > budget 1049");
        assert_eq!(with(|b| b.cycles = 1313), "cycles 1050 leaves a stale budget of 1313");
        assert_eq!(with(|b| b.stack_bytes = 199), "stack_bytes 200 > budget 199");
        assert_eq!(with(|b| b.code_bytes = 6300), "code_bytes 5000 leaves a stale budget of 6300");
        assert_eq!(with(|b| b.both_modes_bytes = None), "");
        assert_eq!(
            with(|b| b.both_modes_bytes = Some(8999)),
            "both_modes_bytes 9000 > budget 8999"
        );
        let state_bytes = CASES[0].state_bytes();
        let (less, exceeded) = (state_bytes - 1, with(|b| b.state_bytes -= 1));
        assert_eq!(exceeded, format!("state_bytes {state_bytes} > budget {less}"));
    }

    #[test]
    fn missing_budgets_expensive_ticks_and_missing_shares_are_reported() {
        let none = problem(&CASES[0], |budgets, _| budgets.core.clear());
        assert_eq!(none, "no budget");
        let spread = problem(&CASES[0], |budgets, _| budgets.maximum_over_mean = 1.1);
        assert_eq!(spread, "maximum over mean 1.111 > 1.1");
        let none = problem(&CASES[0], |budgets, _| budgets.maximum_over_mean = f64::NAN);
        assert_eq!(none, "maximum over mean 1.111 > NaN");
        let lost = problem(&CASES[0], |_, row| drop(row.files.pop()));
        assert_eq!(lost, "files add up to 500 of 900 cycles");
    }

    #[test]
    fn the_ratio_of_the_literal_port_is_checked() {
        let literal = Case::named("literal-fes-f32").expect("a case");
        assert_eq!(problem(literal, |_, _| ()), "");
        let with = |ratio| problem(literal, |_, row| row.ratio = ratio);
        assert_eq!(with(Some(99.4)), "99.4 times the model < 100");
        assert_eq!(with(Some(126.0)), "126.0 times the model leaves a stale limit of 100");
        assert_eq!(with(None), "no model to compare with");
    }

    #[test]
    fn every_case_of_the_model_and_the_controller_has_a_budget() {
        let budgets = Budgets::read().expect("budgets");
        for core in Core::ALL.into_iter().filter(|core| !core.is_timed_as_m4f()) {
            let names: Vec<&str> = budgets.core[&core].keys().map(String::as_str).collect();
            let cases = cases_on(core);
            let mut expected: Vec<&str> =
                cases.iter().filter(|case| case.has_budget()).map(|case| case.name).collect();
            expected.sort_unstable();
            assert_eq!(names, expected, "{}", core.name());
        }
    }
}
