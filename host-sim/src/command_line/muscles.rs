//! `vm muscles`: named muscles and their assumptions.

use super::print;
use crate::markdown_table::markdown_table;
use crate::muscles::{self, ASSUMPTIONS};
use std::error::Error;

const HEADER: [&str; 11] = [
    "muscle",
    "F0 N",
    "mass g",
    "L_ce0 cm",
    "L_se0 cm",
    "L_mt_max cm",
    "slow",
    "source",
    "pennation deg",
    "error % F0",
    "corrected % F0",
];

pub fn run() -> Result<(), Box<dyn Error>> {
    let numbers = (1..HEADER.len()).filter(|&column| HEADER[column] != "source");
    let mut table = markdown_table(&HEADER, numbers);
    for human in muscles::all() {
        let muscle = human.muscle();
        let error = human.pennation_error();
        table.add_row([
            human.name,
            format!("{:.1}", muscle.f0()),
            format!("{:.1}", muscle.mass * 1e3),
            format!("{:.2}", muscle.L_ce0 * 1e2),
            format!("{:.2}", muscle.L_se0 * 1e2),
            format!("{:.2}", muscle.L_mt_max * 1e2),
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
        &"error: largest error of steady force at full activation without pennation, for fascicles of \
          0.7 to 1.3 L_ce0; corrected: the same with F0 cos(angle) and a shifted path.",
    )?;
    Ok(())
}
