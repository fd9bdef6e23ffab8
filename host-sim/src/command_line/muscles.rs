//! `vm muscles`: named muscles and their assumptions.

use super::print;
use crate::markdown_table::markdown_table;
use crate::model_muscle;
use crate::muscles::{self, ASSUMPTIONS};
use std::error::Error;

const HEADER: [&str; 14] = [
    "muscle",
    "F0 N",
    "mass g",
    "fascicle L_ce0 cm",
    "tendon L_se0 cm",
    "longest path L_mt_max cm",
    "neutral path m",
    "path from m",
    "path to m",
    "slow fraction",
    "source of fraction",
    "pennation deg",
    "error in line, % F0",
    "error with cosine, % F0",
];

pub fn run() -> Result<(), Box<dyn Error>> {
    let numbers = (1..HEADER.len()).filter(|&column| HEADER[column] != "source of fraction");
    let mut table = markdown_table(&HEADER, numbers);
    for human in muscles::all() {
        let muscle = human.muscle();
        let (shortest, longest) = model_muscle::path_domain(&muscle);
        let error = human.pennation_error();
        table.add_row([
            human.name,
            format!("{:.1}", muscle.f0()),
            format!("{:.1}", muscle.mass * 1e3),
            format!("{:.2}", muscle.L_ce0 * 1e2),
            format!("{:.2}", muscle.L_se0 * 1e2),
            format!("{:.2}", muscle.L_mt_max * 1e2),
            format!("{:.4}", muscle.L_ce0 + muscle.L_se0),
            format!("{shortest:.4}"),
            format!("{longest:.4}"),
            format!("{:.2}", human.slow_fraction),
            human.slow_source,
            format!("{}", human.pennation_deg),
            format!("{:.1}", error.uncorrected),
            format!("{:.1}", error.corrected),
        ]);
    }
    print(&table)?;
    print(&"\nMorphometry: gait2392 and arm26 of the OpenSim project, CC BY 3.0. Assumed:")?;
    for assumption in ASSUMPTIONS {
        print(&format!("- {assumption}"))?;
    }
    print(
        &"Paths: neutral at L_ce0 with the tendon at F0; the muscle can rest on paths from ... to. \
          Errors: largest of steady force at full activation for fascicles of 0.7 to 1.3 L_ce0; in \
          line: without pennation; with cosine: with F0 cos(angle) and a shifted path.",
    )?;
    Ok(())
}
