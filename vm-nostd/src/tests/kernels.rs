//! Error bounds of the kernels: one table, with an oracle in `f64` for each row.
//!
//! Every row with one argument of 32 bits is asserted over every bit pattern by
//! `cargo test --release -p vm-nostd -- --ignored`. The default run takes one pattern in
//! [`STRIDE`], and those near both ends of the range. Rows with several arguments, and `f64`, are
//! sampled in both. A bound may not be more than twice the error found.

mod arguments;
mod double;
mod fixed;
mod force_balance;
mod single;

use arguments::{Arguments, largest_error};
use std::fmt::Write;

/// The default run takes one pattern in so many; a prime, so that it meets every place of a table's
/// piece.
const STRIDE: i64 = if cfg!(debug_assertions) { 10_007 } else { 97 };

/// What an error is measured in.
#[derive(Clone, Copy)]
enum Unit {
    /// The exact value.
    Relative,
    /// 1.
    Absolute,
    /// 1; the exact value where that exceeds 1.
    Mixed,
    /// 2^-24, the ULP of fixed point.
    Ulp,
    /// 2^-24; times the exact value where that exceeds 1.
    MixedUlp,
    /// 2^-32, the ULP of a share.
    ShareUlp,
    /// The condition that the kernel's documentation states.
    Condition,
}

impl Unit {
    fn text(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Absolute => "absolute",
            Self::Mixed => "absolute, relative above 1",
            Self::Ulp => "ULP",
            Self::MixedUlp => "ULP, times values above 1",
            Self::ShareUlp => "2^-32",
            Self::Condition => "times condition",
        }
    }

    /// The error of a value in this unit.
    fn of(self, found: f64, exact: f64) -> f64 {
        let error = (found - exact).abs();
        match self {
            Self::Absolute | Self::Condition => error,
            Self::Relative => error / exact.abs(),
            Self::Mixed => error / exact.abs().max(1.0),
            Self::Ulp => error * 2_f64.powi(24),
            Self::MixedUlp => error * 2_f64.powi(24) / exact.abs().max(1.0),
            Self::ShareUlp => error * 2_f64.powi(32),
        }
    }
}

/// A kernel and the bound of its error.
struct Row {
    arithmetic: &'static str,
    kernel: &'static str,
    /// Range of the argument, or of each.
    range: &'static str,
    arguments: Arguments,
    bound: f64,
    unit: Unit,
    /// The error for a number from [`Row::arguments`].
    error: fn(Unit, i64) -> f64,
}

fn rows() -> impl Iterator<Item = Row> {
    single::ROWS.into_iter().chain(fixed::ROWS).chain(force_balance::ROWS).chain(double::ROWS)
}

/// Holds all rows to their bounds, with every `stride`-th argument; reports all that fail.
fn check(stride: i64) {
    let mut report = String::new();
    for row in rows() {
        let found = largest_error(&row.arguments, stride, |number| (row.error)(row.unit, number));
        // The few samples of a build with assertions do not find the largest error.
        let is_tight = row.bound <= 2.0 * found || cfg!(debug_assertions);
        let verdict = if found <= row.bound && is_tight {
            "held"
        } else if found <= row.bound {
            "STALE: the bound is more than twice the error"
        } else {
            "EXCEEDED"
        };
        let Row { arithmetic, kernel, range, bound, .. } = row;
        let unit = row.unit.text();
        let line =
            format!("{arithmetic} {kernel} {range}: {found:.3e} of {bound:e} {unit}: {verdict}");
        println!("{line}");
        report += &line;
        report.push('\n');
    }
    assert!(!report.contains("EXCEEDED") && !report.contains("STALE"), "\n{report}");
}

#[test]
fn kernels_are_within_their_bounds() {
    check(STRIDE);
}

#[test]
#[ignore = "minutes: every bit pattern of every kernel with one 32-bit argument"]
fn kernels_are_within_their_bounds_for_every_bit_pattern() {
    check(1);
}

/// `VM_WRITE=1` writes the table; otherwise it is compared.
#[test]
fn the_readme_has_the_table_of_kernels() {
    let mut table = String::from(
        "| kernel | | arguments | largest error | unit | tested |\n|---|---|---|---:|---|---|\n",
    );
    for Row { arithmetic, kernel, range, arguments, bound, unit, .. } in rows() {
        let tested = arguments.text();
        let unit = unit.text();
        let plain = bound == 0.0 || (0.01..1000.0).contains(&bound);
        let bound = if plain { format!("{bound}") } else { format!("{bound:e}") };
        writeln!(table, "| {kernel} | {arithmetic} | {range} | {bound} | {unit} | {tested} |")
            .expect("a text");
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/KERNELS.md");
    let readme = std::fs::read_to_string(path).expect("the table");
    let (start, end) = ("<!-- kernels -->\n", "<!-- /kernels -->");
    let (before, rest) = readme.split_once(start).expect("the table's start");
    let (written, after) = rest.split_once(end).expect("the table's end");
    if std::env::var_os("VM_WRITE").is_some() {
        std::fs::write(path, format!("{before}{start}{table}{end}{after}")).expect("written");
    } else {
        assert_eq!(written, table, "VM_WRITE=1 cargo test --release -p vm-nostd kernels");
    }
}
