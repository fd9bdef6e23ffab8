//! `vm measured`: the model compared with recordings of real muscle.

use super::fit::SearchArgs;
use super::{complain, print};
use crate::fit::Role;
use crate::markdown_table::markdown_table;
use crate::measured::{self, Board, LeftOut};
use crate::readme;
use clap::Args;
use comfy_table::Table;
use std::error::Error;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct MeasuredArgs {
    /// Folder of the recordings, with one folder per set.
    #[arg(long)]
    data: PathBuf,
    /// Print the trials as a JSON array instead of tables.
    #[arg(long)]
    json: bool,
    /// Skip the models without yield and without length dependence of Af and FV.
    #[arg(long)]
    no_ablation: bool,
    /// Write the tables to host-sim/docs/fitting.md of the checkout that this program was built in.
    #[arg(long)]
    write: bool,
    /// Skip missing sets without an error.
    #[arg(long)]
    allow_missing: bool,
    /// Number of starts of the complete model; ablations start once, from its solution.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Random seed of the starts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// True if no set was missing, or missing sets are allowed.
pub fn run(args: &MeasuredArgs) -> Result<bool, Box<dyn Error>> {
    if !args.data.is_dir() {
        return Err(format!("--data {}: no such folder", args.data.display()).into());
    }
    let left_out = if args.no_ablation { &LeftOut::ALL[..1] } else { &LeftOut::ALL[..] };
    let search = SearchArgs { starts: args.starts, seed: args.seed }.search();
    let board = measured::measure(&args.data, left_out, &search)?;
    for (set, reason) in &board.skipped {
        complain(&format!("SKIPPED {set}: {reason}"));
    }
    for (set, out, reason) in &board.refused {
        complain(&format!("{set} without {out}: {reason}"));
    }
    if args.json {
        print(&serde_json::to_string_pretty(&board.rows)?)?;
    } else if !board.rows.is_empty() {
        print(&text(&board, left_out))?;
    }
    if args.write && !board.rows.is_empty() {
        readme::SCOREBOARD.write(&text(&board, left_out))?;
    }
    Ok(board.skipped.is_empty() || args.allow_missing)
}

/// Errors of all trials and sets, fitted parameters, residual force enhancement and refusals.
fn text(board: &Board, left_out: &[LeftOut]) -> String {
    let mut text = format!("{}\n\n{}\n\n", trials(board), means(board, left_out));
    for (set, _, fit) in board.fits.iter().filter(|fit| fit.1 == LeftOut::Nothing.name()) {
        for estimate in &fit.estimates {
            let (name, value) = (&estimate.name, estimate.value);
            text += format!("- {set}: {name} = {value:.5} {}", estimate.note()).trim_end();
            text += "\n";
        }
    }
    for left in &board.enhancements {
        text += &format!(
            "- {}: residual force enhancement {:.1} % of F0 (trial {} against {}); model {:.1} %\n",
            left.dataset, left.measured_pct_f0, left.trial, left.isometric, left.model_pct_f0
        );
    }
    for (set, out, held) in &board.held {
        let names = held.join(", ");
        text += &format!(
            "- {set} without {out}: the recordings do not determine {names}, which stays as in the \
             complete model\n"
        );
    }
    for (set, out, reason) in &board.refused {
        text += &format!("- {set} without {out}: {reason}\n");
    }
    text
}

fn trials(board: &Board) -> Table {
    let header = ["dataset", "trial", "role", "left out", "mae % F0", "rms % F0", "published mae"];
    let mut table = markdown_table(&header, 4..7);
    for row in &board.rows {
        let published = row
            .published_mae_pct_f0
            .map_or("-".to_owned(), |[least, most]| format!("{least} to {most}"));
        table.add_row([
            row.dataset.clone(),
            row.trial.clone(),
            row.role.to_owned(),
            row.left_out.to_owned(),
            format!("{:.2}", row.mae_pct_f0),
            format!("{:.2}", row.rms_pct_f0),
            published,
        ]);
    }
    table
}

fn means(board: &Board, left_out: &[LeftOut]) -> Table {
    let mut table =
        markdown_table(&["dataset", "left out", "mean mae, fitted", "predicted", "all"], 2..5);
    let mut sets: Vec<&String> = board.rows.iter().map(|row| &row.dataset).collect();
    sets.dedup();
    for set in sets {
        for &out in left_out {
            let mean = |role| format!("{:.2}", measured::mean(board, set, role, out));
            table.add_row([
                set.clone(),
                out.name().to_owned(),
                mean(Some(Role::Fit)),
                mean(Some(Role::Predict)),
                mean(None),
            ]);
        }
    }
    table
}
