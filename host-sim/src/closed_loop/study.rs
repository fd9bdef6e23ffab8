//! The comparison: tasks times controllers, over patients.

use super::controller::{Kind, Settings};
use super::patient::Patient;
use super::percentile::percentile;
use super::task::Task;
use super::trial::Trial;
use super::tuner;
use rayon::prelude::*;
use serde::Serialize;
use vm_nostd::control::JointError;

/// What is compared.
#[derive(Clone, Debug)]
pub struct Study {
    /// Tasks.
    pub tasks: Vec<Task>,
    /// Controllers.
    pub controllers: Vec<Kind>,
    /// Patients that are scored.
    pub patients: u64,
    /// Patients that controllers are tuned on: others.
    pub tuning_patients: u64,
    /// Evaluations that each controller is tuned with.
    pub evaluations: usize,
}

/// One controller on one task.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the task.
    pub task: &'static str,
    /// Name of the controller.
    pub controller: &'static str,
    /// Its arithmetic.
    pub arithmetic: &'static str,
    /// Patients.
    pub patients: usize,
    /// Median of the rms error, degrees.
    pub rms_median: f64,
    /// 95th percentile of the rms error, degrees.
    pub rms_p95: f64,
    /// 95th percentile of the overshoot, degrees.
    pub overshoot_p95: f64,
    /// Median charge, µC.
    pub charge_median_uc: f64,
    /// 5th percentile of the time until the task ended, s.
    #[serde(skip)]
    pub endured_p5_s: f64,
    /// Runs that were unstable.
    pub unstable: usize,
    /// Runs with a command beyond its limit.
    pub limit_broken: usize,
    /// What the tuner chose.
    #[serde(skip)]
    pub settings: Settings,
}

/// Headings of [`Row::cells`].
pub const COLUMNS: [&str; 11] = [
    "task",
    "controller",
    "arithmetic",
    "patients",
    "rms, deg (median)",
    "rms, deg (p95)",
    "overshoot, deg (p95)",
    "charge, uC (median)",
    "endured, s (p5)",
    "unstable",
    "limit broken",
];

impl Row {
    /// What tables show.
    pub fn cells(&self) -> [String; 11] {
        [
            self.task.to_owned(),
            self.controller.to_owned(),
            self.arithmetic.to_owned(),
            self.patients.to_string(),
            format!("{:.2}", self.rms_median),
            format!("{:.2}", self.rms_p95),
            format!("{:.1}", self.overshoot_p95),
            format!("{:.0}", self.charge_median_uc),
            format!("{:.0}", self.endured_p5_s),
            self.unstable.to_string(),
            self.limit_broken.to_string(),
        ]
    }
}

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A number that is no number of patients or evaluations.
    #[error("{field} = {value}: must be {least} to {most}")]
    Count {
        /// Which.
        field: &'static str,
        /// The refused value.
        value: u64,
        /// Least allowed value.
        least: u64,
        /// Greatest allowed value.
        most: u64,
    },
    /// A controller or plant was refused.
    #[error(transparent)]
    Joint(#[from] JointError),
}

impl Study {
    fn validate(&self) -> Result<(), StudyError> {
        let within = |field, value, least, most| {
            let inside = (least..=most).contains(&value);
            if inside { Ok(()) } else { Err(StudyError::Count { field, value, least, most }) }
        };
        within("patients", self.patients, 1, 10_000)?;
        within("tuning patients", self.tuning_patients, 1, 10_000)?;
        within("evaluations", self.evaluations as u64, 1, 10_000)
    }
}

/// Runs the comparison.
pub fn run(study: &Study) -> Result<Vec<Row>, StudyError> {
    study.validate()?;
    let mut rows = Vec::new();
    for &task in &study.tasks {
        let drawn = |draw: fn(Task, u64) -> Patient, count| -> Vec<Patient> {
            (0..count).map(|number| draw(task, number)).collect()
        };
        let scored = drawn(Patient::scored, study.patients);
        let tuning = drawn(Patient::tuned_on, study.tuning_patients);
        let mut of_model: Option<Settings> = None;
        for kind in Kind::ALL.into_iter().filter(|kind| study.controllers.contains(kind)) {
            let settings = match (kind, of_model.take()) {
                (Kind::ModelFixed, Some(settings)) => settings,
                (Kind::ModelFixed, None) => {
                    tuner::tune(Kind::Model, task, &tuning, study.evaluations)?.settings
                }
                _ => tuner::tune(kind, task, &tuning, study.evaluations)?.settings,
            };
            if kind == Kind::Model {
                of_model = Some(settings.clone());
            }
            rows.push(score(task, kind, &scored, settings)?);
        }
    }
    Ok(rows)
}

fn score(
    task: Task,
    kind: Kind,
    patients: &[Patient],
    settings: Settings,
) -> Result<Row, JointError> {
    let scores = patients
        .par_iter()
        .map(|patient| {
            Trial { task, patient, kind, settings: &settings, tuning: false }.run(|_| ())
        })
        .collect::<Result<Vec<_>, _>>()?;
    let of = |value: fn(&super::Score) -> f64, share| {
        percentile(&scores.iter().map(value).collect::<Vec<_>>(), share)
    };
    Ok(Row {
        task: task.name(),
        controller: kind.name(),
        arithmetic: kind.arithmetic(),
        patients: scores.len(),
        rms_median: of(|score| score.rms, 0.5),
        rms_p95: of(|score| score.rms, 0.95),
        overshoot_p95: of(|score| score.overshoot, 0.95),
        charge_median_uc: of(|score| score.charge, 0.5),
        endured_p5_s: of(|score| score.endured, 0.05),
        unstable: scores.iter().filter(|score| score.unstable).count(),
        limit_broken: scores.iter().filter(|score| score.limit_broken).count(),
        settings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small(patients: u64) -> Study {
        let controllers = Kind::ALL.to_vec();
        let tasks = vec![Task::ElbowReach];
        Study { tasks, controllers, patients, tuning_patients: 1, evaluations: 1 }
    }

    #[test]
    fn a_comparison_is_the_same_whenever_it_is_run() {
        let [rows, again] = [(); 2].map(|()| run(&small(3)).expect("a comparison"));
        assert_eq!(rows.len(), Kind::ALL.len());
        for (row, again) in rows.iter().zip(&again) {
            assert_eq!(row.rms_p95.to_bits(), again.rms_p95.to_bits(), "{}", row.controller);
            assert!(row.rms_median <= row.rms_p95 && row.rms_p95 < 60.0, "{row:?}");
            assert_eq!(row.limit_broken, 0, "{row:?}");
        }
        // Fixed point differs from `f32` by rounding: far less than patients do from each other.
        let [single, fixed] = &rows[3..] else { panic!("two of the model") };
        assert!((single.rms_median - fixed.rms_median).abs() < 0.5, "{single:?} {fixed:?}");
        let charges = [single, fixed].map(|row| row.charge_median_uc);
        assert!((charges[0] / charges[1] - 1.0).abs() < 2.5e-5, "{charges:?}");
    }

    #[test]
    fn a_controller_alone_has_the_row_that_it_has_among_all() {
        let all = run(&small(2)).expect("a comparison");
        for (kind, expected) in [(Kind::PiCurve, &all[1]), (Kind::ModelFixed, &all[4])] {
            let alone = run(&Study { controllers: vec![kind], ..small(2) }).expect("a comparison");
            assert_eq!(alone.len(), 1);
            assert_eq!(alone[0].settings, expected.settings);
            assert_eq!(alone[0].rms_p95.to_bits(), expected.rms_p95.to_bits());
        }
    }

    #[test]
    fn the_table_has_the_named_columns() {
        let rows = run(&small(1)).expect("a comparison");
        let json = serde_json::to_value(&rows[0]).expect("JSON");
        let mut columns: Vec<&str> =
            json.as_object().expect("a row").keys().map(|k| &k[..]).collect();
        columns.sort_unstable();
        assert_eq!(
            columns,
            [
                "arithmetic",
                "charge_median_uc",
                "controller",
                "limit_broken",
                "overshoot_p95",
                "patients",
                "rms_median",
                "rms_p95",
                "task",
                "unstable",
            ]
        );
    }

    #[test]
    fn numbers_that_are_none_are_refused_by_name() {
        let error = run(&small(0)).expect_err("no patients");
        assert_eq!(error.to_string(), "patients = 0: must be 1 to 10000");
    }
}
