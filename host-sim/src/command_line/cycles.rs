//! `vm cycles`.

use super::{complain, print};
use crate::cycles::{
    self, Argument, CLOCKS, Core, Cost, MARGIN, Part, Profile, Row, Spread, Tracer, UnitCost,
};
use crate::engine::Class;
use crate::markdown_table::markdown_table;
use crate::readme;
use crate::trace::write_atomically;
use clap::Args;
use comfy_table::Table;
use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

/// `vm cycles`: a table of all cases, or the profile of one function.
#[derive(Debug, Args)]
pub struct CyclesArgs {
    /// Print the rows as a JSON array instead of a table.
    #[arg(long, conflicts_with_all = ["case", "elf"])]
    json: bool,
    /// Fail if a budget of data/budgets.toml is exceeded or stale, or if the tables of
    /// docs/cycles.md or data/computation.csv have drifted.
    #[arg(long, conflicts_with_all = ["case", "elf"])]
    check: bool,
    /// Write the tables of docs/cycles.md, and data/computation.csv for figure 7, in host-sim of
    /// the checkout that this program was built in.
    #[arg(long, conflicts_with_all = ["case", "elf", "check"])]
    write: bool,
    /// Share of the core's time that muscles may take, 0.01 to 1.
    #[arg(long, default_value_t = 0.5, value_parser = share)]
    share: f64,
    /// Profile one case by function, file and class of instruction.
    #[arg(long, conflicts_with = "elf")]
    case: Option<String>,
    /// The core that the case runs on.
    #[arg(long, requires = "case", value_enum, default_value_t)]
    core: Core,
    /// Only this tick of the case, counted from 0.
    #[arg(long, requires = "case")]
    tick: Option<usize>,
    /// Profile a function of another Cortex-M program.
    #[arg(long, requires = "symbol", value_name = "FILE")]
    elf: Option<PathBuf>,
    /// Function: its name (or the part after the last `::`), its mangled symbol, or its address
    /// (0x08000150).
    #[arg(long, requires = "elf", value_name = "NAME")]
    symbol: Option<String>,
    /// Call the function directly instead of running the program: with integers, zeros:64 or
    /// bytes:00ff for r0 to r3, 1.5 for s0 to s15, 1.5f64 for d0 to d7.
    #[arg(long, requires = "elf", num_args = 0.., allow_negative_numbers = true,
          value_name = "ARGS")]
    entry: Option<Vec<Argument>>,
    /// QEMU machine of the program.
    #[arg(long, requires = "elf", default_value = cycles::MACHINE)]
    machine: String,
    /// Timeout of the program, s: it is stopped then, and the calls that have returned are counted.
    #[arg(long, requires = "elf", default_value_t = 60, value_name = "SECONDS",
          value_parser = clap::value_parser!(u32).range(1..=86_400))]
    timeout: u32,
    /// Number of most expensive addresses to list.
    #[arg(long, num_args = 0..=1, default_missing_value = "40", value_name = "COUNT")]
    listing: Option<usize>,
    /// Accuracy class of the model. Default: that of budgets and documents, the standard class, and
    /// the economy class on a Cortex-M0+.
    #[arg(long, value_enum, conflicts_with_all = ["check", "write", "elf"])]
    class: Option<Class>,
    /// Source of the trace.
    #[arg(long, value_enum, default_value_t = Tracer::Auto)]
    tracer: Tracer,
}

/// A share of the core's time.
fn share(text: &str) -> Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.01..=1.0).contains(&share) { Ok(share) } else { Err("must be 0.01 to 1".to_owned()) }
}

/// Runs the command; false if a check failed.
pub fn run(args: &CyclesArgs) -> Result<bool, Box<dyn Error>> {
    let profile = match (&args.case, &args.elf, &args.symbol) {
        (Some(case), ..) => cycles::of_case(
            args.core,
            case,
            args.tick,
            args.tracer,
            args.class.unwrap_or(args.core.class()),
        )?,
        (None, Some(elf), Some(symbol)) => {
            let timeout = Duration::from_secs(args.timeout.into());
            let entry = args.entry.as_deref();
            cycles::of_image(elf, symbol, entry, &args.machine, args.tracer, timeout)?
        }
        _ => return report(args),
    };
    print(&profile.title)?;
    if profile.stopped {
        complain(&format!(
            "the program is still running after {} s (--timeout): {} calls until then are counted",
            args.timeout,
            profile.calls.len()
        ));
    }
    print(&calls(&profile))?;
    print(&parts("function", &profile.functions, &profile))?;
    print(&parts("file", &profile.files, &profile))?;
    print(&parts("class of instruction", &profile.classes, &profile))?;
    if let Some(count) = args.listing {
        print(&listing(&profile, count))?;
    }
    Ok(true)
}

fn report(args: &CyclesArgs) -> Result<bool, Box<dyn Error>> {
    let rows = cycles::report(args.tracer, args.class)?;
    let costs = UnitCost::of(&rows);
    if args.write {
        readme::CYCLES.write(&readme::cycles(&rows))?;
        write_atomically(&UnitCost::path(), &UnitCost::file(&costs)?)?;
        return Ok(true);
    }
    if args.json {
        print(&serde_json::to_string_pretty(&rows)?)?;
    } else {
        print(&table(&rows))?;
        print(&muscles(&rows, args.share))?;
        print(
            &"pess max is the most expensive tick in the pessimistic setting of the timing model; \
              flash wait states are not modelled.",
        )?;
        for row in &rows {
            print(&format!("worst tick of {}: {}", row.case, row.replay))?;
        }
    }
    if !args.check {
        return Ok(true);
    }
    let failed: Vec<&Row> = rows.iter().filter(|row| !row.pass).collect();
    failed.iter().for_each(|row| complain(&format!("{}: {}", row.case, row.problem)));
    let current = readme::CYCLES.is_current(&readme::cycles(&rows))?;
    if !current {
        complain("host-sim/docs/cycles.md has drifted: cargo vm cycles --write");
    }
    let counted = UnitCost::counted()? == costs;
    if !counted {
        complain("data/computation.csv has drifted: cargo vm cycles --write");
    }
    Ok(failed.is_empty() && current && counted)
}

fn table(rows: &[Row]) -> Table {
    let header = [
        "core",
        "case",
        "ticks",
        "instr max",
        "opt mean",
        "opt p99",
        "opt max",
        "typ mean",
        "typ p99",
        "typ max",
        "pess mean",
        "pess p99",
        "pess max",
        "x model",
        "max % F0",
        "state B",
        "code B",
        "both modes B",
        "stack B",
        "budget",
    ];
    let mut table = markdown_table(&header, 2..header.len());
    let optional = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    for row in rows {
        table.add_row([
            row.target.name().to_owned(),
            row.case.clone(),
            row.ticks.to_string(),
            row.instructions_max.to_string(),
            format!("{:.0}", row.cycles_opt_mean),
            row.cycles_opt_p99.to_string(),
            row.cycles_opt_max.to_string(),
            format!("{:.0}", row.cycles_typ_mean),
            row.cycles_typ_p99.to_string(),
            row.cycles_typ_max.to_string(),
            format!("{:.0}", row.cycles_pess_mean),
            row.cycles_pess_p99.to_string(),
            row.cycles_pess_max.to_string(),
            optional(row.ratio.map(|ratio| format!("{ratio:.1}"))),
            optional(row.max_pct_f0.map(|error| format!("{error:.3}"))),
            row.state_bytes.to_string(),
            row.code_bytes.to_string(),
            optional(row.both_modes_bytes.map(|bytes| bytes.to_string())),
            row.stack_bytes.to_string(),
            optional(row.budget.map(|budget| budget.to_string())),
        ]);
    }
    table
}

/// Number of muscles that a core steps.
fn muscles(rows: &[Row], share: f64) -> String {
    let clocks = CLOCKS.map(|clock| format!("{clock} MHz"));
    let title = format!("muscles at 1 kHz in {:.0} % of a core of", share * 100.0);
    let mut header = vec![title.as_str()];
    header.extend(clocks.iter().map(String::as_str));
    let mut table = markdown_table(&header, 1..header.len());
    for row in rows.iter().filter(|row| row.mode != "-") {
        let counts = CLOCKS.map(|clock| row.muscles(clock, share).to_string());
        let name = format!("{} on {}", row.case, row.target.name());
        table.add_row([vec![name], counts.to_vec()].concat());
    }
    format!("\n{table}\n(pess max x {MARGIN}, without flash wait states)")
}

fn calls(profile: &Profile) -> String {
    let mut table = markdown_table(&["setting", "mean", "p99", "max"], 1..4);
    for (setting, name) in ["optimistic", "typical", "pessimistic"].iter().enumerate() {
        let Spread { mean, p99, max } = Spread::of(&profile.calls, setting);
        let cells = [format!("{mean:.1}"), p99.to_string(), max.to_string()];
        table.add_row([vec![(*name).to_owned()], cells.to_vec()].concat());
    }
    let most = profile.calls.iter().map(|cost| cost.instructions).max().unwrap_or(0);
    format!(
        "{table}\n{} calls of up to {most} instructions; {} B of code, {} B of stack\n",
        profile.calls.len(),
        profile.code_bytes,
        profile.stack_bytes,
    )
}

/// The total of all counted calls.
fn total(profile: &Profile) -> Cost {
    let mut total = Cost::default();
    profile.functions.iter().for_each(|part| total.add(&part.cost));
    total
}

fn parts(what: &str, parts: &[Part], profile: &Profile) -> String {
    let total = total(profile);
    let header = [what, "instructions", "optimistic", "typical", "pessimistic", "% of typical"];
    let mut table = markdown_table(&header, 1..header.len());
    for Part { name, cost } in parts {
        let [optimistic, typical, pessimistic] = cost.cycles;
        table.add_row([
            name.clone(),
            cost.instructions.to_string(),
            optimistic.to_string(),
            typical.to_string(),
            pessimistic.to_string(),
            format!("{:.1}", 100.0 * typical as f64 / total.cycles[1].max(1) as f64),
        ]);
    }
    format!("{table}\n")
}

fn listing(profile: &Profile, count: usize) -> Table {
    let header = ["address", "instruction", "executed", "typical", "each"];
    let mut table = markdown_table(&header, 2..header.len());
    for (instruction, times, cost) in cycles::hottest(&profile.executions, count) {
        table.add_row([
            format!("{:#010x}", instruction.address),
            instruction.text.clone(),
            times.to_string(),
            cost.cycles[1].to_string(),
            format!("{:.2}", cost.cycles[1] as f64 / *times as f64),
        ]);
    }
    table
}
