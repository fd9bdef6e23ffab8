//! Records and fits many patients: one row per patient, in a table that can be resumed.

use super::bout::{Bout, Setting};
use super::list::{Free, RECORDED, free};
use super::patient::{Patient, STRIDE};
use super::protocol::{self, bouts};
use crate::engine::mode_name;
use crate::fit::{Fit, Role, Search, Start, Trials, fit};
use crate::golden;
use crate::ledger::{Ledger, LedgerError};
use crate::muscle_file::NamedMuscle;
use crate::reference::Mode;
use crate::trace::write_atomically;
use std::fmt::Write;
use std::path::Path;

/// A study: patients and settings of the fits.
#[derive(Clone, Debug)]
pub struct Study {
    /// Mean muscle.
    pub start: Start,
    /// Number of patients per mode.
    pub patients: usize,
    /// Recruitment modes.
    pub modes: Vec<Mode>,
    /// Settings of the search; the seed also draws the patients.
    pub search: Search,
}

/// Columns per parameter: true value, fitted value, and standard error (empty at a bound).
pub const OF_PARAMETER: [&str; 3] = ["truth", "fitted", "error"];
/// First columns.
pub const LEADING: [&str; 2] = ["case", "mode"];
/// Last columns.
pub const TRAILING: [&str; 3] = ["predicted_rms_pct_f0", "noise_ratio", "problem"];

impl Study {
    /// The free parameters of all modes, without duplicates.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for &mode in &self.modes {
            for free in free(&self.start.named, mode) {
                if !names.contains(&free.name) {
                    names.push(free.name);
                }
            }
        }
        names
    }

    fn mode(&self, case: usize) -> Mode {
        self.modes[case % self.modes.len()]
    }

    /// First two lines of the table: the command with the model's version, and the columns.
    fn head(&self) -> [String; 2] {
        let modes: Vec<&str> = self.modes.iter().map(|&mode| mode_name(mode)).collect();
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        let mut digest = crc.digest();
        digest.update(format!("{:?}", self.start.named).as_bytes());
        for &mode in &self.modes {
            let bouts = self.bouts(mode);
            digest.update(super::list(&self.start.named, mode, &bouts).as_bytes());
        }
        let made = format!(
            "# vm recover --patients {} --modes {} --starts {} --seed {} # protocol {:08x}, {}",
            self.patients,
            modes.join(","),
            self.search.starts,
            self.search.seed,
            digest.finalize(),
            golden::model(),
        );
        let mut columns: Vec<String> = LEADING.map(str::to_owned).to_vec();
        for name in self.names() {
            columns.extend(OF_PARAMETER.map(|what| format!("{name} {what}")));
        }
        columns.extend(TRAILING.map(str::to_owned));
        [made, columns.join(",")]
    }

    fn bouts(&self, mode: Mode) -> Vec<Bout> {
        bouts(mode, self.start.named.muscle.fatigue.is_some())
    }

    /// Fits all patients that have no row yet.
    pub fn run(&self, output: &Path) -> Result<Ledger, LedgerError> {
        let begin = |case: usize| vec![case.to_string(), mode_name(self.mode(case)).to_owned()];
        let count = self.patients * self.modes.len();
        let mut ledger = Ledger::open(output, &self.head(), count, &begin)?;
        ledger.complete(|case| self.row(case))?;
        Ok(ledger)
    }

    fn row(&self, case: usize) -> Vec<String> {
        let mode = self.mode(case);
        let free = free(&self.start.named, mode);
        let mut row = vec![case.to_string(), mode_name(mode).to_owned()];
        let (truths, result) = match self.patient(case, mode, &free) {
            Ok(patient) => {
                let truths = patient.truths.clone();
                (truths, self.recover(patient, mode))
            }
            Err(problem) => (vec![f64::NAN; free.len()], Err(problem)),
        };
        for name in self.names() {
            let index = free.iter().position(|free| free.name == name);
            let truth = index.map_or(String::new(), |index| truths[index].to_string());
            let estimate = index.and_then(|index| Some(&result.as_ref().ok()?.0.estimates[index]));
            let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
            row.push(truth);
            row.push(number(estimate.map(|estimate| estimate.value)));
            row.push(number(estimate.and_then(|estimate| estimate.standard_error)));
        }
        match result {
            Ok((fit, predicted)) => {
                let rest = [format!("{predicted:.4}"), format!("{:.4}", fit.noise_ratio)];
                row.extend(rest);
                row.push(String::new());
            }
            // One line per row, so that a truncated row is recognised.
            Err(problem) => {
                row.extend([String::new(), String::new(), problem.replace(['\n', '\r'], " ")]);
            }
        }
        row
    }

    fn patient(&self, case: usize, mode: Mode, free: &[Free]) -> Result<Patient, String> {
        let draw = (self.search.seed, case);
        Patient::draw(&self.start.named, mode, free, &self.bouts(mode), draw)
            .map_err(|error| error.to_string())
    }

    /// Records a patient in a temporary folder and fits it. Returns the fit and the root mean
    /// square error of the predicted bout against the patient's force without noise, % of the
    /// patient's F0.
    fn recover(&self, mut patient: Patient, mode: Mode) -> Result<(Fit, f64), String> {
        let named = &self.start.named;
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        self.record(&mut patient, mode, folder.path())?;
        let trials = Trials::read(&folder.path().join("trials.toml"), folder.path(), named)
            .map_err(|error| error.to_string())?;
        let fit = fit(named, self.start.keep_force, trials, &self.search, &[])
            .map_err(|error| error.to_string())?;
        let unseen = fit.trials.iter().find(|trial| trial.role == Role::Predict);
        let predicted = unseen.map_or(f64::NAN, |trial| trial.rms_pct_f0);
        let predicted = predicted * fit.muscle.f0() / patient.muscle.f0();
        Ok((fit, predicted))
    }

    fn record(&self, patient: &mut Patient, mode: Mode, folder: &Path) -> Result<(), String> {
        fn said(error: impl ToString) -> String {
            error.to_string()
        }
        let named: &NamedMuscle = &self.start.named;
        protocol::write(named, mode, folder).map_err(said)?;
        std::fs::create_dir(folder.join(RECORDED)).map_err(said)?;
        let setting = Setting::of(named, mode);
        for bout in self.bouts(mode) {
            let mut text = "t_s,force_n\n".to_owned();
            let forces = patient.forces(&setting, mode, &bout).map_err(said)?;
            for (index, force) in forces.into_iter().enumerate() {
                let time = (index * STRIDE) as f64 * super::bout::TICK;
                // The prediction is compared with the force without noise.
                let force = if bout.role == Role::Fit { patient.reading(force) } else { force };
                writeln!(text, "{time:.3},{force:.6}").expect("a string grows");
            }
            let file = folder.join(RECORDED).join(bout.file_name());
            write_atomically(&file, text.as_bytes()).map_err(said)?;
        }
        Ok(())
    }
}
