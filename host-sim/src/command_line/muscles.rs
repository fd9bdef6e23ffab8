//! `vm muscles`: named muscles and their assumptions.

use super::print;
use crate::muscles::{self, ASSUMPTIONS};
use comfy_table::{CellAlignment, Table, presets};
use std::error::Error;

const HEADER: [&str; 11] = [
    "muscle",
    "F0 N",
    "mass g",
    "L_ce0 cm",
    "L_se0 cm",
    "L_mt_max cm",
    "slow",
    "slow from",
    "pennation deg",
    "its cost % F0",
    "made up for % F0",
];

pub fn run() -> Result<(), Box<dyn Error>> {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(HEADER);
    for human in muscles::all() {
        let muscle = human.muscle();
        let cost = human.pennation_cost();
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
            format!("{:.1}", cost.as_it_stands),
            format!("{:.1}", cost.made_up_for),
        ]);
    }
    for column in (1..HEADER.len()).filter(|&column| HEADER[column] != "slow from") {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    print(&table)?;
    print(&"\nMorphometry: gait2392 and arm26 of the OpenSim project, CC BY 3.0. Assumed:")?;
    for assumption in ASSUMPTIONS {
        print(&format!("- {assumption}"))?;
    }
    print(
        &"Cost of pennation left out: largest error of steady force at full activation, fascicles of 0.7 to 1.3 \
          L_ce0, on the same path with the same F0; made up for, with F0 cos(angle) and the path shifted.",
    )?;
    Ok(())
}
