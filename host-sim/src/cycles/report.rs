//! Measures the table of costs.

use super::bench::{BenchError, measure};
use super::breakdown::{Part, by_class, by_file};
use super::budgets::Budgets;
use super::case::{self, CASES, Case, LargestErrors, Subject};
use super::core::Core;
use super::follow::{Count, Followed};
use super::image::{Image, ImageError};
use super::row::{Row, Share, Spread};
use super::trace::Tracer;
use crate::engine::{self, Arithmetic, Class, RunError};
use crate::reference::Mode;
use std::collections::BTreeSet;

/// Why the table could not be measured.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The bench could not be run.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// The debug information of the bench could not be read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A scenario could not be run on the host.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The budgets could not be read.
    #[error("data/budgets.toml: {0}")]
    Budgets(#[from] toml::de::Error),
}

/// Whether a case is listed in `docs/cycles.md`.
pub fn is_listed(case: &str) -> bool {
    Case::named(case).is_none_or(Case::is_listed)
}

/// State size of a case of the model and its budget, bytes.
pub fn state_bytes(case: &str) -> Result<Option<(u32, u32)>, toml::de::Error> {
    let most = Budgets::read()?.state_bytes(case);
    Ok(Case::named(case).map(Case::state_bytes).zip(most))
}

/// The cases measured on a core: all on the M4F; the model on cores that are timed like it; model
/// and controller in fixed point on the others.
pub(super) fn cases_on(core: Core) -> Vec<Case> {
    let wanted = |case: &&Case| match core {
        Core::CortexM4F => true,
        _ if core.is_timed_as_m4f() => case.is_model(),
        _ => case.has_budget() && case.arithmetic() == Arithmetic::Fixed,
    };
    CASES.iter().filter(wanted).copied().collect()
}

/// Measures all cases on all cores in an accuracy class, by default each core's own. Budgets are
/// checked only in the core's own class.
pub fn report(tracer: Tracer, class: Option<Class>) -> Result<Vec<Row>, ReportError> {
    let budgets: Budgets = Budgets::read()?;
    let scenarios = case::scenarios();
    let mut all = Vec::new();
    for core in Core::ALL {
        let class = class.unwrap_or(core.class());
        let cases = cases_on(core);
        let runs = case::runs_of(&cases);
        let (image, followed) = measure(core, &cases, &runs, tracer, Count::All, class)?;
        let mut rows = Vec::new();
        for (case, followed) in cases.iter().zip(&followed) {
            let errors = case.largest_errors(&scenarios, class)?;
            rows.push(row(core, class, case, followed, errors));
        }
        for (index, case) in cases.iter().enumerate() {
            if case.has_budget() {
                (rows[index].files, rows[index].classes) = shares(&image, &followed[index])?;
            }
            if case.is_model() {
                let bytes = both_modes_bytes(&image, case, &cases, &followed);
                rows[index].both_modes_bytes = Some(bytes);
            } else if !case.has_budget() {
                rows[index].ratio = cycles_of_model(&rows, case.mode())
                    .map(|cycles| rows[index].cycles_pess_max as f64 / cycles as f64);
            }
            if class == core.class() && !core.is_timed_as_m4f() {
                budgets.hold(case, &mut rows[index]);
            }
        }
        all.extend(rows);
    }
    Ok(all)
}

/// The command that profiles one tick of a case.
fn replay(core: Core, class: Class, case: &Case, tick: usize) -> String {
    let mut on = String::new();
    if core != Core::default() {
        on += &format!(" --core {}", core.name());
    }
    if class != Class::default() {
        on += &format!(" --class {}", class.name());
    }
    format!("cargo vm cycles{on} --case {} --tick {tick}", case.name)
}

/// Mean cost of a tick, by file and by class of instruction.
fn shares(image: &Image, followed: &Followed) -> Result<(Vec<Share>, Vec<Share>), ImageError> {
    let per_tick = |parts: Vec<Part>| {
        parts.into_iter().map(|part| Share::of(part, followed.calls.len())).collect()
    };
    Ok((per_tick(by_file(image, &followed.executions)?), per_tick(by_class(&followed.executions))))
}

/// Code and tables of all measured modes of the model in a case's arithmetic, bytes.
fn both_modes_bytes(image: &Image, case: &Case, cases: &[Case], followed: &[Followed]) -> u32 {
    let alike = cases
        .iter()
        .zip(followed)
        .filter(|(other, _)| other.is_model() && other.arithmetic() == case.arithmetic());
    let code: BTreeSet<(u32, u32)> =
        alike.flat_map(|(_, followed)| &followed.code).copied().collect();
    code.iter().map(|(_, bytes)| bytes).sum::<u32>() + image.constant_bytes(case.tables())
}

/// Pessimistic maximum of the model in `f32` in a mode, by default the continuous one.
fn cycles_of_model(rows: &[Row], mode: Option<Mode>) -> Option<u64> {
    let subject = Subject::Model(mode.unwrap_or(Mode::Continuous), Arithmetic::F32);
    let index = CASES.iter().position(|case| case.subject == subject)?;
    Some(rows.get(index)?.cycles_pess_max)
}

fn row(
    core: Core,
    class: Class,
    case: &Case,
    followed: &Followed,
    errors: Option<LargestErrors>,
) -> Row {
    let calls = &followed.calls;
    let [optimistic, typical, pessimistic] = [0, 1, 2].map(|setting| Spread::of(calls, setting));
    let worst = (0..calls.len()).max_by_key(|&tick| calls[tick].cycles[2]).unwrap_or(0);
    Row {
        case: case.name.to_owned(),
        mode: case.mode().map_or("-", engine::mode_name).to_owned(),
        arithmetic: case.arithmetic().name().to_owned(),
        target: core,
        class,
        ticks: calls.len(),
        instructions_max: calls.iter().map(|cost| cost.instructions).max().unwrap_or(0),
        cycles_opt_mean: optimistic.mean,
        cycles_opt_p99: optimistic.p99,
        cycles_opt_max: optimistic.max,
        cycles_typ_mean: typical.mean,
        cycles_typ_p99: typical.p99,
        cycles_typ_max: typical.max,
        cycles_pess_mean: pessimistic.mean,
        cycles_pess_p99: pessimistic.p99,
        cycles_pess_max: pessimistic.max,
        worst_tick: worst,
        replay: replay(core, class, case, worst),
        state_bytes: case.state_bytes(),
        code_bytes: followed.code_bytes(),
        both_modes_bytes: None,
        stack_bytes: followed.stack_bytes,
        smooth_pct_f0: errors.map(|errors| errors.smooth),
        max_pct_f0: errors.map(|errors| errors.any),
        ratio: None,
        budget: None,
        pass: true,
        files: Vec::new(),
        classes: Vec::new(),
        problem: String::new(),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::estimator::Cost;
    use super::*;

    /// The row of a case whose worst tick takes 1000 pessimistic cycles.
    pub fn a_row(case: &Case) -> Row {
        let cost = |cycles| Cost { instructions: cycles / 2, cycles: [cycles / 2, cycles, cycles] };
        let followed = Followed {
            calls: vec![cost(900), cost(1000), cost(800)],
            stack_bytes: 200,
            stopped: false,
            code: [(0x100, 3000), (0x2000, 2000)].into(),
            executions: Vec::new(),
        };
        let row = row(
            Core::CortexM4F,
            Class::Standard,
            case,
            &followed,
            Some(LargestErrors { smooth: 0.1, any: 0.1 }),
        );
        let share = |name: &str, cycles| Share { name: name.to_owned(), instructions: 1.0, cycles };
        Row {
            both_modes_bytes: Some(9000),
            ratio: Some(120.0),
            files: vec![share("muscle.rs", 500.0), share("equations/tendon.rs", 400.0)],
            classes: vec![share("load", 900.0)],
            ..row
        }
    }

    #[test]
    fn a_row_summarises_its_ticks() {
        let row = a_row(&CASES[0]);
        assert_eq!((row.cycles_pess_max, row.worst_tick, row.ticks), (1000, 1, 3));
        assert_eq!((row.cycles_typ_mean, row.cycles_opt_p99, row.code_bytes), (900.0, 500, 5000));
        // 84,000 cycles per tick, half of them used, 1050 per muscle with the margin.
        assert_eq!((row.muscles(84, 0.5), row.muscles(1, 1.0)), (40, 0));
    }
}
