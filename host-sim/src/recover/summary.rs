//! Summary of a study: median and 95th percentile of the errors, and coverage of the intervals.

use super::list::{Free, OFFSET, free};
use super::study::{LEADING, OF_PARAMETER, Study, TRAILING};
use crate::engine::mode_name;
use crate::ledger::Ledger;
use crate::markdown_table::markdown_table;
use crate::reference::Mode;
use comfy_table::Table;
use serde::Serialize;

/// Half of a 95 % interval, in standard errors.
const NORMAL_95: f64 = 1.96;
/// Limit of the root mean square error of predicted force, % of F0.
pub const PREDICTED: f64 = 2.0;

/// Errors of a parameter over all patients of a mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recovered {
    /// Name.
    pub parameter: String,
    /// Spread of the patients, % of the mean.
    pub spread_pct: f64,
    /// Median of the absolute error, % of the mean; for the path offset, % of the mean L_ce0.
    pub median_error_pct: f64,
    /// 95th percentile of the same.
    pub p95_error_pct: f64,
    /// Number of 95 % intervals that contain the true value.
    pub covered: usize,
    /// Number of intervals; a fit that ended at a bound has none.
    pub intervals: usize,
}

/// Summary of a mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The mode.
    pub mode: &'static str,
    /// Number of patients.
    pub patients: usize,
    /// Number of fits that were refused or failed.
    pub failed: usize,
    /// Median of the root mean square error of force in the predicted bout, % of F0.
    pub median_predicted_rms_pct_f0: f64,
    /// 95th percentile of the same.
    pub p95_predicted_rms_pct_f0: f64,
    /// Number of patients predicted within 2 % of F0.
    pub predicted_to_2_pct: usize,
    /// Errors by parameter.
    pub parameters: Vec<Recovered>,
}

impl Summary {
    /// Whether at least 95 % of the patients are predicted within 2 % of F0; failed fits count as
    /// not predicted.
    pub fn predicts(&self) -> bool {
        self.predicted_to_2_pct * 100 >= self.patients * 95
    }

    /// Coverage of all intervals, %.
    pub fn coverage_pct(&self) -> f64 {
        let covered: usize = self.parameters.iter().map(|p| p.covered).sum();
        let intervals: usize = self.parameters.iter().map(|p| p.intervals).sum();
        100.0 * covered as f64 / intervals as f64
    }
}

/// Summaries per mode of a complete table.
pub fn summaries(study: &Study, ledger: &Ledger) -> Vec<Summary> {
    study.modes.iter().map(|&mode| summary(study, ledger, mode)).collect()
}

fn summary(study: &Study, ledger: &Ledger, mode: Mode) -> Summary {
    let name = mode_name(mode);
    let rows: Vec<&[String]> =
        ledger.rows().map(|row| row.1).filter(|row| row[1] == name).collect();
    let names = study.names();
    let predicted_at = LEADING.len() + names.len() * OF_PARAMETER.len();
    let number = |cell: &String| cell.parse::<f64>().ok();
    let mut predicted: Vec<f64> =
        rows.iter().filter_map(|row| number(&row[predicted_at])).collect();
    predicted.sort_by(f64::total_cmp);
    let fascicle_m = study.start.named.muscle.L_ce0;
    let parameters = free(&study.start.named, mode)
        .into_iter()
        .filter_map(|free| {
            let place = names.iter().position(|name| *name == free.name)?;
            let at = LEADING.len() + place * OF_PARAMETER.len();
            Some(recovered(&free, fascicle_m, rows.iter().map(|row| &row[at..at + 3])))
        })
        .collect();
    Summary {
        mode: name,
        patients: rows.len(),
        failed: rows
            .iter()
            .filter(|row| !row[predicted_at + TRAILING.len() - 1].is_empty())
            .count(),
        median_predicted_rms_pct_f0: percentile(&predicted, 0.5),
        p95_predicted_rms_pct_f0: percentile(&predicted, 0.95),
        predicted_to_2_pct: predicted.iter().filter(|&&error| error <= PREDICTED).count(),
        parameters,
    }
}

fn recovered<'a>(
    free: &Free,
    fascicle_m: f64,
    cells: impl Iterator<Item = &'a [String]>,
) -> Recovered {
    let unit = if free.name == OFFSET { fascicle_m } else { free.mean };
    let mut errors = Vec::new();
    let (mut covered, mut intervals) = (0, 0);
    for cells in cells {
        let number = |index: usize| cells[index].parse::<f64>().ok();
        let (Some(truth), Some(fitted)) = (number(0), number(1)) else { continue };
        errors.push(100.0 * ((fitted - truth) / unit).abs());
        if let Some(error) = number(2) {
            intervals += 1;
            covered += usize::from((fitted - truth).abs() <= NORMAL_95 * error);
        }
    }
    errors.sort_by(f64::total_cmp);
    Recovered {
        parameter: free.name.clone(),
        spread_pct: 100.0 * free.spread / unit,
        median_error_pct: percentile(&errors, 0.5),
        p95_error_pct: percentile(&errors, 0.95),
        covered,
        intervals,
    }
}

/// Quantile of sorted values: the least one that is not exceeded by a share of them; NaN if there
/// are none.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(place.max(1) - 1).copied().unwrap_or(f64::NAN)
}

/// Tables and conclusions of all modes.
pub fn text(summaries: &[Summary]) -> String {
    let one = |summary: &Summary| {
        format!(
            "{}\n\n{}: force of the unseen trial within {:.2} % of F0 rms (median), {:.2} % (95th \
             percentile), 2 % in {} of {} patients; \
             {} fits failed; intervals hold {:.1} % of truths\n",
            table(summary),
            summary.mode,
            summary.median_predicted_rms_pct_f0,
            summary.p95_predicted_rms_pct_f0,
            summary.predicted_to_2_pct,
            summary.patients,
            summary.failed,
            summary.coverage_pct(),
        )
    };
    summaries.iter().map(one).collect::<Vec<_>>().join("\n")
}

/// The parameters of a mode as a table.
fn table(summary: &Summary) -> Table {
    let header = ["parameter", "spread %", "median error %", "95th percentile %", "covered"];
    let mut table = markdown_table(&header, 1..5);
    for row in &summary.parameters {
        table.add_row([
            row.parameter.clone(),
            format!("{:.1}", row.spread_pct),
            format!("{:.2}", row.median_error_pct),
            format!("{:.2}", row.p95_error_pct),
            format!("{} of {}", row.covered, row.intervals),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::percentile;

    #[test]
    fn quantiles_are_existing_values() {
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile(&hundred, 0.5), 50.0);
        assert_eq!(percentile(&hundred, 0.95), 95.0);
        assert_eq!(percentile(&[3.0], 0.95), 3.0);
        assert!(percentile(&[], 0.5).is_nan());
    }
}
