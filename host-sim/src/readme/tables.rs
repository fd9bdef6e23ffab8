//! The measured tables as Markdown.

use crate::cycles::{self, Core, Share};
use crate::engine::Class;
use crate::scenario::paper_muscle;
use crate::stack;
use crate::tolerance;
use crate::verify::{Report, Row};
use std::collections::BTreeMap;

/// The worst scenario of each mode and arithmetic at 1 ms and its promise, where the usual promise
/// holds; then the worst of the scenarios with a wider one.
pub fn worst(report: &Report) -> String {
    let mut text = String::from(
        "| mode | arithmetic | worst scenario | error % | promised % |\n|---|---|---|---:|---:|\n",
    );
    let promise = |row: &Row| {
        let key = [&row.scenario, &row.mode, &row.arithmetic, &row.against].map(Clone::clone);
        // F0 matters to the reference only, which is not listed.
        tolerance::promise(&key, Class::Standard, 1.0).0
    };
    let rows = || ["f32", "fixed"].into_iter().flat_map(|name| at_1_ms(report, name));
    let usual = rows().map(promise).fold(f64::INFINITY, f64::min);
    let is_usual = |row: &&Row| promise(row) <= usual;
    let largest = |found: Vec<&'_ Row>| {
        found.into_iter().max_by(|a, b| a.max_pct_f0.total_cmp(&b.max_pct_f0)).map(|row| {
            let (error, promised) = (row.max_pct_f0, promise(row));
            let names = format!("{} | {} | {}", row.mode, row.arithmetic, row.scenario);
            format!("| {names} | {error:.4} | {promised} |\n")
        })
    };
    for mode in ["continuous", "fes"] {
        for arithmetic in ["f32", "fixed"] {
            let of = |row: &&Row| row.mode == mode && row.arithmetic == arithmetic;
            text.extend(largest(rows().filter(of).filter(is_usual).collect()));
        }
    }
    text.extend(largest(rows().filter(|row| !is_usual(row)).collect()));
    text
}

/// Accuracy of f32 and fixed point against the reference, and of the reference against the vectors.
pub fn measured(report: &Report) -> String {
    let mut text = String::from(
        "| scenario | mode | f32 max | f32 rms | fixed max | fixed rms | f32 0.5 ms | fixed 0.5 ms | \
         f32 2 ms | reference, N |\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let newtons = paper_muscle().f0() / 100.0;
    for row in at_1_ms(report, "f32") {
        let other = |step: &str, arithmetic: &str| {
            report.row(&format!("{}{step}", row.scenario), &row.mode, arithmetic)
        };
        let max = |step: &str, arithmetic: &str| {
            let found = other(step, arithmetic);
            found.map_or("-".to_owned(), |other| format!("{:.4}", other.max_pct_f0))
        };
        let fixed_rms =
            other("", "fixed").map_or("-".to_owned(), |other| format!("{:.4}", other.rms_pct_f0));
        let vector = other("", "reference")
            .map_or("-".to_owned(), |vector| format!("{:.4}", vector.max_pct_f0 * newtons));
        text.push_str(&format!(
            "| {} | {} | {:.4} | {:.4} | {} | {fixed_rms} | {} | {} | {} | {vector} |\n",
            row.scenario,
            row.mode,
            row.max_pct_f0,
            row.rms_pct_f0,
            max("", "fixed"),
            max("@0.5ms", "f32"),
            max("@0.5ms", "fixed"),
            max("@2ms", "f32"),
        ));
    }
    text
}

/// The error budget at 1 ms: truncation error, and what rounding and kernels add.
pub fn error_budget(report: &Report) -> String {
    let mut text = String::from(
        "| scenario | mode | scheme | f32 adds | f32 measured | fixed adds | fixed measured |\n\
         |---|---|---:|---:|---:|---:|---:|\n",
    );
    for scheme in at_1_ms(report, "f64") {
        text.push_str(&format!(
            "| {} | {} | {:.4} |",
            scheme.scenario, scheme.mode, scheme.max_pct_f0
        ));
        let same = |row: &&Row| row.scenario == scheme.scenario && row.mode == scheme.mode;
        for row in report.rows.iter().filter(same) {
            if let Some(adds) = row.arithmetic_pct_f0 {
                text.push_str(&format!(" {adds:.4} | {:.4} |", row.max_pct_f0));
            }
        }
        text.push('\n');
    }
    text
}

/// Rows of an arithmetic at 1 ms.
fn at_1_ms<'a>(report: &'a Report, arithmetic: &'a str) -> impl Iterator<Item = &'a Row> {
    report.rows.iter().filter(move |row| row.arithmetic == arithmetic && row.is_at_1_ms())
}

/// Cost of a tick of the model and the baselines, by file, and by class of instruction.
pub fn cycles(rows: &[cycles::Row]) -> String {
    let mut text = String::from(
        "| core | case | class | instr max | typ mean | typ max | pess max | max/mean | x model | smooth % F0 | max % F0 | state B | code B | both modes B | stack B |\n\
         |---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let optional = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    for row in rows.iter().filter(|row| cycles::is_listed(&row.case)) {
        text.push_str(&format!(
            "| {} | {} | {} | {} | {:.0} | {} | {} | {:.2} | {} | {} | {} | {} | {} | {} | {} |\n",
            row.target.name(),
            row.case,
            row.class.name(),
            row.instructions_max,
            row.cycles_typ_mean,
            row.cycles_typ_max,
            row.cycles_pess_max,
            row.maximum_over_mean(),
            optional(row.ratio.map(|ratio| format!("{ratio:.1}"))),
            optional(row.smooth_pct_f0.map(|error| format!("{error:.3}"))),
            optional(row.max_pct_f0.map(|error| format!("{error:.3}"))),
            row.state_bytes,
            row.code_bytes,
            optional(row.both_modes_bytes.map(|bytes| bytes.to_string())),
            row.stack_bytes,
        ));
    }
    let model: Vec<&cycles::Row> =
        rows.iter().filter(|row| row.target == Core::CortexM4F && !row.files.is_empty()).collect();
    let columns = |shares: fn(&cycles::Row) -> &[Share]| {
        model.iter().map(|row| (row.case.as_str(), shares(row))).collect::<Vec<Column<'_>>>()
    };
    text.push('\n');
    let cycles = |share: &Share| format!("{:.0}", share.cycles);
    text.push_str(&side_by_side("typ mean, by file", &columns(|row| &row.files), cycles));
    text.push('\n');
    let both = |share: &Share| format!("{:.0} ({:.0})", share.cycles, share.instructions);
    let heading = "typ mean, by class (instructions)";
    text.push_str(&side_by_side(heading, &columns(|row| &row.classes), both));
    text
}

/// Stack of each of the stimulator's tasks, and its memory budget.
pub fn stack(report: &stack::Report) -> String {
    let mut text =
        String::from("| task | priority | stack, B | largest frame |\n|---|---:|---:|---|\n");
    for stack::Entry { task, priority, deepest } in &report.entries {
        let most = deepest.path.iter().max_by_key(|step| step.bytes).filter(|step| step.bytes > 0);
        let most =
            most.map_or("-".to_owned(), |step| format!("`{}`, {} B", step.function, step.bytes));
        text.push_str(&format!("| {task} | {priority} | {} | {most} |\n", deepest.bytes));
    }
    format!("{text}\n{}", memory(report))
}

/// The stimulator's memory budget.
pub fn memory(report: &stack::Report) -> String {
    let mut text = String::from("| RAM | B | % |\n|---|---:|---:|\n");
    for (what, bytes) in [
        ("statics", report.statics),
        ("deepest stack", report.stack),
        ("of that, exception frames", report.core_frames),
        ("free", report.free),
        ("all", report.ram),
        ("reserved for the stack", report.room_for_stack),
    ] {
        let share = 100.0 * f64::from(bytes) / f64::from(report.ram);
        text.push_str(&format!("| {what} | {bytes} | {share:.1} |\n"));
    }
    text
}

/// A case with the shares of its parts.
type Column<'a> = (&'a str, &'a [Share]);

/// Cost of each part of a tick with one column per case, most expensive part first, then the sum.
fn side_by_side(heading: &str, columns: &[Column<'_>], cell: fn(&Share) -> String) -> String {
    let mut total: BTreeMap<&str, f64> = BTreeMap::new();
    for share in columns.iter().flat_map(|(_, shares)| *shares) {
        *total.entry(&share.name).or_default() += share.cycles;
    }
    let mut names: Vec<&str> = total.keys().copied().collect();
    names.sort_by(|a, b| total[b].total_cmp(&total[a]));

    let line = |first: &str, cell: &dyn Fn(&Column<'_>) -> String| {
        let cells: Vec<String> = columns.iter().map(cell).collect();
        format!("| {first} | {} |\n", cells.join(" | "))
    };
    let mut text = line(heading, &|(case, _)| (*case).to_owned());
    text.push_str(&format!("|---|{}\n", "---:|".repeat(columns.len())));
    for name in names {
        text.push_str(&line(name, &|(_, shares)| {
            let share = shares.iter().find(|share| share.name == name);
            share.map_or("-".to_owned(), cell)
        }));
    }
    text.push_str(&line("all", &|(_, shares)| cell(&Share::all(shares))));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_sorted_by_cost_and_summed() {
        let share = |name: &str, instructions, cycles| Share {
            name: name.to_owned(),
            instructions,
            cycles,
        };
        let one = [share("load", 3.0, 5.6), share("branch", 1.0, 2.8)];
        let other = [share("branch", 4.0, 9.0)];
        let cell = |share: &Share| format!("{:.0} ({:.0})", share.cycles, share.instructions);
        assert_eq!(
            side_by_side("by class", &[("one", &one), ("other", &other)], cell),
            "| by class | one | other |\n\
             |---|---:|---:|\n\
             | branch | 3 (1) | 9 (4) |\n\
             | load | 6 (3) | - |\n\
             | all | 8 (4) | 9 (4) |\n",
        );
    }
}
