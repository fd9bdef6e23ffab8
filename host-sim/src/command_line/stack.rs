//! `vm stack`.

use super::{complain, print};
use crate::markdown_table::markdown_table;
use crate::readme;
use crate::stack::{self, Description, Report};
use crate::target::{self, STIMULATOR, STM32F405};
use clap::Args;
use comfy_table::Table;
use std::error::Error;
use std::path::PathBuf;

/// `vm stack`: memory of the stimulator's image.
#[derive(Debug, Args)]
pub struct StackArgs {
    /// Image; by default the stimulator is built.
    #[arg(long, value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Description of handlers and indirect calls, in TOML; by default firmware/stack.toml.
    #[arg(long, value_name = "FILE")]
    description: Option<PathBuf>,
    /// Print a JSON object instead of tables.
    #[arg(long)]
    json: bool,
    /// Also fail if the tables of firmware/README.md have drifted.
    #[arg(long)]
    check: bool,
    /// Write the tables of firmware/README.md of the checkout that this program was built in.
    #[arg(long, conflicts_with = "check")]
    write: bool,
}

/// Runs the command; false if a depth is unknown or memory is short.
pub fn run(args: &StackArgs) -> Result<bool, Box<dyn Error>> {
    let elf = match &args.elf {
        Some(elf) => elf.clone(),
        None => target::build(STM32F405, STIMULATOR, &[])?,
    };
    let described =
        args.description.clone().unwrap_or_else(|| target::root().join("firmware/stack.toml"));
    let text = std::fs::read_to_string(&described)
        .map_err(|error| format!("{}: {error}", described.display()))?;
    let description: Description =
        toml::from_str(&text).map_err(|error| format!("{}: {error}", described.display()))?;
    let report = stack::report(&elf, &description)?;
    if args.json {
        print(&serde_json::to_string_pretty(&report)?)?;
    } else {
        print(&table(&report))?;
        print(&format!("\n{}", readme::memory(&report)))?;
    }
    report.problems.iter().for_each(|problem| complain(problem));
    let mut passed = report.problems.is_empty();
    let tables = readme::stack(&report);
    if args.write && passed {
        readme::STACK.write(&tables)?;
    }
    if args.check && !readme::STACK.is_current(&tables)? {
        complain("firmware/README.md has drifted: cargo vm stack --write");
        passed = false;
    }
    Ok(passed)
}

/// Each task with its deepest path.
fn table(report: &Report) -> Table {
    let mut table = markdown_table(&["task", "priority", "stack B", "deepest path"], [2]);
    for entry in &report.entries {
        let path = &entry.deepest.path;
        let steps: Vec<String> =
            path.iter().map(|step| format!("{:6} {}", step.bytes, step.function)).collect();
        let bytes = entry.deepest.bytes.to_string();
        table.add_row([entry.task.clone(), entry.priority.clone(), bytes, steps.join("\n")]);
    }
    table
}
