//! The README's table "Does it fit?": one row per core and arithmetic.

use super::place::ReadmeError;
use crate::cycles::Core;
use crate::engine::Class;
use crate::tolerance;
use crate::verify::{Report, Row};
use vm_nostd::{
    ContinuousMuscle, FesMuscle, Fixed, IntramuscularFes, NaturalContinuous, Scalar, State,
};

/// A row: an arithmetic on a core.
struct Fit {
    core: Core,
    /// Name of the core.
    name: &'static str,
    /// Clock of a common part (STM32F405, STM32F103, STM32C0, STM32U5, STM32H7), MHz.
    clock_mhz: f64,
    arithmetic: &'static str,
    /// Cases of the table of cycles, one per mode.
    cases: [&'static str; 2],
    /// Bytes of a muscle's coefficients and state.
    muscle_bytes: usize,
}

/// The table, from the report of accuracy and the table of cycles.
pub(super) fn table(report: &Report, cycles: &str) -> Result<String, ReadmeError> {
    let fixed = |core, name, clock_mhz| Fit {
        core,
        name,
        clock_mhz,
        arithmetic: "fixed",
        cases: ["continuous-fixed", "fes-fixed"],
        muscle_bytes: muscle_bytes::<Fixed>(),
    };
    let float = |core, name, clock_mhz| Fit {
        arithmetic: "f32",
        cases: ["continuous-f32", "fes-f32"],
        muscle_bytes: muscle_bytes::<f32>(),
        ..fixed(core, name, clock_mhz)
    };
    let rows = [
        float(Core::CortexM4F, "Cortex-M4F", 168.0),
        fixed(Core::CortexM4F, "Cortex-M4F", 168.0),
        fixed(Core::CortexM3, "Cortex-M3", 72.0),
        fixed(Core::CortexM0Plus, "Cortex-M0+, economy", 48.0),
        float(Core::CortexM33, "Cortex-M33, timed as M4F", 160.0),
        float(Core::CortexM7, "Cortex-M7, timed as M4F", 480.0),
    ];
    let mut text = String::from(
        "| core, arithmetic | cycles | CPU, % at MHz | flash, KiB | RAM, B | stack, B | error, % |\n\
         |---|---:|---:|---:|---:|---:|---:|\n",
    );
    for fit in rows {
        let worst = |column| {
            let values = fit.cases.map(|case| cell(cycles, fit.core, case, column));
            let [first, second] = values;
            Ok::<_, ReadmeError>(first?.max(second?))
        };
        let cycles = worst("pess max")?;
        // The report has more scenarios, in the standard class.
        let [smooth, ringing] = if fit.core.class() == Class::Standard {
            [false, true].map(|ringing| errors(report, fit.arithmetic, ringing).fold(0.0, f64::max))
        } else {
            [worst("smooth % F0")?, worst("max % F0")?]
        };
        text.push_str(&format!(
            "| {}, `{}` | {} | {:.0} at {} | {:.1} | {} | {} | {smooth:.2} ({ringing:.1}) |\n",
            fit.name,
            fit.arithmetic,
            cycles,
            // Cycles per ms over 1000 x MHz.
            100.0 * cycles / (fit.clock_mhz * 1e3),
            fit.clock_mhz,
            worst("both modes B")? / 1024.0,
            fit.muscle_bytes,
            worst("stack B")?,
        ));
    }
    Ok(text)
}

/// Bytes of coefficients and state of a muscle of two fibre types, the larger of both modes.
fn muscle_bytes<S: Scalar>() -> usize {
    let continuous =
        size_of::<ContinuousMuscle<S, 2>>() + size_of::<State<S, NaturalContinuous, 2>>();
    let fes = size_of::<FesMuscle<S, 2>>() + size_of::<State<S, IntramuscularFes, 2>>();
    continuous.max(fes)
}

/// Largest errors of an arithmetic at 1 ms, % of F0, in scenarios with or without a ringing tendon.
fn errors<'a>(
    report: &'a Report,
    arithmetic: &'a str,
    ringing: bool,
) -> impl Iterator<Item = f64> + 'a {
    let selected = move |row: &&Row| {
        let rings = tolerance::rings(&row.scenario);
        row.arithmetic == arithmetic && row.is_at_1_ms() && rings == ringing
    };
    report.rows.iter().filter(selected).map(|row| row.max_pct_f0)
}

/// Reads a number from the table of cycles.
fn cell(
    table: &str,
    core: Core,
    row: &'static str,
    column: &'static str,
) -> Result<f64, ReadmeError> {
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let number = || {
        let mut lines = table.trim().lines();
        let index = cells(lines.next()?).iter().position(|cell| cell == column)?;
        let is_wanted =
            |cells: &Vec<String>| cells.len() > 2 && cells[1] == core.name() && cells[2] == row;
        let cells = lines.map(cells).find(is_wanted)?;
        cells.get(index)?.parse().ok()
    };
    number().ok_or(ReadmeError::NoCell { row, column })
}
