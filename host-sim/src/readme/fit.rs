//! The front page's "does it fit?": one row per core and arithmetic.

use super::ReadmeError;
use crate::tolerance;
use crate::verify::{Report, Row};
use vm_nostd::{
    ContinuousMuscle, FesMuscle, Fixed, IntramuscularFes, NaturalContinuous, Scalar, State,
};

/// Core clock of the column "CPU", MHz: the STM32F405.
const CLOCK_MHZ: f64 = 168.0;

/// An arithmetic on a core.
struct Fit {
    core: &'static str,
    arithmetic: &'static str,
    /// Cases of the table of cycles, one per mode.
    cases: [&'static str; 2],
    /// Bytes of a muscle's coefficients and state.
    muscle_bytes: usize,
}

/// The table, from the report of accuracy and the table of cycles.
pub(super) fn table(report: &Report, cycles: &str) -> Result<String, ReadmeError> {
    let rows = [
        Fit {
            core: "Cortex-M4F",
            arithmetic: "f32",
            cases: ["continuous-f32", "fes-f32"],
            muscle_bytes: muscle_bytes::<f32>(),
        },
        Fit {
            core: "Cortex-M4F",
            arithmetic: "fixed",
            cases: ["continuous-fixed", "fes-fixed"],
            muscle_bytes: muscle_bytes::<Fixed>(),
        },
    ];
    let mut text = String::from(
        "| core, arithmetic | cycles per tick | CPU | flash | RAM per muscle | stack | max. error |\n\
         |---|---:|---:|---:|---:|---:|---:|\n",
    );
    for fit in rows {
        let worst = |column| {
            let values = fit.cases.map(|case| cell(cycles, case, column));
            let [first, second] = values;
            Ok::<_, ReadmeError>(first?.max(second?))
        };
        let cycles = worst("pess max")?;
        let [smooth, ringing] = [false, true].map(|ringing| {
            let errors = errors(report, fit.arithmetic, ringing);
            errors.fold(0.0, f64::max)
        });
        text.push_str(&format!(
            "| {}, `{}` | {} | {:.1} % | {:.1} KiB | {} B | {} B | {smooth:.2} % ({ringing:.1} %) |\n",
            fit.core,
            fit.arithmetic,
            cycles,
            // Cycles per ms over 1000 x MHz.
            100.0 * cycles / (CLOCK_MHZ * 1e3),
            worst("both modes B")? / 1024.0,
            fit.muscle_bytes,
            worst("stack B")?,
        ));
    }
    Ok(text)
}

/// Bytes of the coefficients and state of a muscle of two fibre types, in the larger of both modes.
fn muscle_bytes<S: Scalar>() -> usize {
    let continuous =
        size_of::<ContinuousMuscle<S, 2>>() + size_of::<State<S, NaturalContinuous, 2>>();
    let fes = size_of::<FesMuscle<S, 2>>() + size_of::<State<S, IntramuscularFes, 2>>();
    continuous.max(fes)
}

/// Largest errors of an arithmetic at 1 ms, % of F0, where a tendon rings or where none does.
fn errors<'a>(
    report: &'a Report,
    arithmetic: &'a str,
    ringing: bool,
) -> impl Iterator<Item = f64> + 'a {
    let is_of = move |row: &&Row| {
        let rings = tolerance::rings(&row.scenario);
        row.arithmetic == arithmetic && !row.scenario.contains('@') && rings == ringing
    };
    report.rows.iter().filter(is_of).map(|row| row.max_pct_f0)
}

/// A number of the table of cycles.
fn cell(table: &str, row: &'static str, column: &'static str) -> Result<f64, ReadmeError> {
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let number = || {
        let mut lines = table.trim().lines();
        let index = cells(lines.next()?).iter().position(|cell| cell == column)?;
        let cells = lines.map(cells).find(|cells| cells.get(1).is_some_and(|name| name == row))?;
        cells.get(index)?.parse().ok()
    };
    number().ok_or(ReadmeError::NoCell { row, column })
}
