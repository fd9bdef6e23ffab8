//! Published recordings of real muscle: the model is fitted to some and compared with the rest.
//!
//! The definitions of the fits are in `data/measured`; the recordings are read from a folder.

mod ablation;
mod left_out;

pub use left_out::LeftOut;

use crate::engine::Arithmetic;
use crate::fit::{Fit, FitError, Role, Search, Start, TrialFit, Trials, fit};
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A set of recordings with a built-in definition.
struct Known {
    folder: &'static str,
    muscle: &'static str,
    trials: &'static str,
    /// Range of the published mean absolute errors, % of F0, if known.
    published: Option<[f64; 2]>,
    /// Trial with an active stretch, isometric trial at its final length, and a time (s) at which
    /// both are still active.
    stretched: &'static [(&'static str, &'static str, f64)],
}

const KNOWN: [Known; 2] = [
    Known {
        folder: "krylow_sandercock_1997",
        muscle: include_str!("../data/measured/krylow_sandercock_1997.muscle.toml"),
        trials: include_str!("../data/measured/krylow_sandercock_1997.trials.toml"),
        // Six amplitudes, three Hill models fitted by their morphometry: Millard et al., J.
        // Biomech. Eng. 135 (2013) 021005.
        published: Some([3.3, 8.9]),
        stretched: &[],
    },
    Known {
        folder: "herzog_leonard_2002",
        muscle: include_str!("../data/measured/herzog_leonard_2002.muscle.toml"),
        trials: include_str!("../data/measured/herzog_leonard_2002.trials.toml"),
        published: None,
        stretched: &[
            ("61", "60", 7.6),
            ("63", "60", 7.6),
            ("65", "60", 7.6),
            ("45", "44", 9.9),
            ("47", "44", 9.9),
            ("50", "44", 9.9),
        ],
    },
];

/// Averaging time of forces, s.
const AVERAGED: f64 = 0.3;

/// Files of a set with its own definition.
const MUSCLE_FILE: &str = "muscle.toml";
const TRIALS_FILE: &str = "trials.toml";

/// A row of the results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Set of recordings.
    pub dataset: String,
    /// Trial.
    pub trial: String,
    /// `fit` or `predict`.
    pub role: &'static str,
    /// Mean absolute error of force, % of measured F0.
    pub mae_pct_f0: f64,
    /// Root mean square error of force, % of measured F0.
    pub rms_pct_f0: f64,
    /// Range of the published mean absolute errors, if there is one.
    pub published_mae_pct_f0: Option<[f64; 2]>,
    /// Left-out feature.
    pub left_out: &'static str,
}

/// Residual force enhancement: force after an active stretch minus isometric force at the same
/// length.
#[derive(Clone, Debug, PartialEq)]
pub struct Enhancement {
    /// Set of recordings.
    pub dataset: String,
    /// Trial with the stretch.
    pub trial: String,
    /// Isometric trial.
    pub isometric: String,
    /// Measured, % of measured F0.
    pub measured_pct_f0: f64,
    /// Of the model, % of measured F0.
    pub model_pct_f0: f64,
}

/// Results.
#[derive(Clone, Debug, Default)]
pub struct Board {
    /// Every trial.
    pub rows: Vec<Row>,
    /// The fits, by set and left-out feature.
    pub fits: Vec<(String, &'static str, Fit)>,
    /// Missing sets, with the reason.
    pub skipped: Vec<(String, String)>,
    /// Parameters that an ablation left at their values in the complete model because the
    /// recordings do not determine them without the feature, by set and left-out feature.
    pub held: Vec<(String, &'static str, Vec<String>)>,
    /// Ablations that cannot be fitted, by set and left-out feature, with the reason.
    pub refused: Vec<(String, &'static str, String)>,
    /// Residual force enhancement, of the complete model.
    pub enhancements: Vec<Enhancement>,
}

/// A set of recordings on disk.
struct Found {
    name: String,
    folder: PathBuf,
    start: Start,
    trials: Trials,
    published: Option<[f64; 2]>,
    stretched: &'static [(&'static str, &'static str, f64)],
}

/// A fit, and the parameters that it held.
type Fitted = (Fit, Vec<String>);

/// Compares the model with every set of recordings in `folder`, for the versions `left_out`.
pub fn measure(folder: &Path, left_out: &[LeftOut], search: &Search) -> Result<Board, FitError> {
    let mut board = Board::default();
    let found = find(folder, &mut board.skipped)?;
    let fits: Vec<(&Found, LeftOut, Result<Fitted, FitError>)> = found
        .par_iter()
        .flat_map(|set| {
            let whole = set.fitted(search);
            let others = left_out.par_iter().filter(|&&out| out != LeftOut::Nothing);
            let mut fits: Vec<_> = match &whole {
                Ok(whole) => others.map(|&out| (set, out, set.without(out, whole))).collect(),
                Err(_) => Vec::new(),
            };
            fits.insert(0, (set, LeftOut::Nothing, whole.map(|fit| (fit, Vec::new()))));
            fits
        })
        .collect();
    for (set, out, fit) in fits {
        let fit = match fit {
            Ok((fit, held)) => {
                if !held.is_empty() {
                    board.held.push((set.name.clone(), out.name(), held));
                }
                fit
            }
            Err(error) if out == LeftOut::Nothing => return Err(error),
            Err(error) => {
                board.refused.push((set.name.clone(), out.name(), error.to_string()));
                continue;
            }
        };
        // Relative to the measured F0, not the fitted one.
        let f0 = set.start.named.muscle.f0();
        let scale = fit.muscle.f0() / f0;
        board.rows.extend(fit.trials.iter().map(|trial| Row {
            dataset: set.name.clone(),
            trial: trial.name.clone(),
            role: trial.role.name(),
            mae_pct_f0: trial.mae_pct_f0 * scale,
            rms_pct_f0: trial.rms_pct_f0 * scale,
            published_mae_pct_f0: set.published,
            left_out: out.name(),
        }));
        if out == LeftOut::Nothing {
            board.enhancements.extend(set.enhancements(&fit, f0));
        }
        board.fits.push((set.name.clone(), out.name(), fit));
    }
    Ok(board)
}

/// Sets in a folder: the built-in ones, then those with their own definition.
fn find(folder: &Path, skipped: &mut Vec<(String, String)>) -> Result<Vec<Found>, FitError> {
    let mut found = Vec::new();
    for known in &KNOWN {
        let place = folder.join(known.folder);
        if place.is_dir() {
            let definition = Path::new(known.folder).join(MUSCLE_FILE);
            let start = Start::parse(known.muscle, &definition)?;
            let list = Path::new(known.folder).join(TRIALS_FILE);
            let trials = Trials::parse(known.trials, &list, &place, &start.named)?;
            let name = known.folder.to_owned();
            let Known { published, stretched, .. } = *known;
            found.push(Found { name, folder: place, start, trials, published, stretched });
        } else {
            let reason = format!("{}: no such folder", place.display());
            skipped.push((known.folder.to_owned(), reason));
        }
    }
    let mut others: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        // Not a set: a temporary folder of another program.
        .filter(|path| !path.file_name().is_some_and(|n| n.as_encoded_bytes().starts_with(b".")))
        .filter(|path| [MUSCLE_FILE, TRIALS_FILE].iter().any(|file| path.join(file).is_file()))
        .filter(|path| !found.iter().any(|set: &Found| set.folder == *path))
        .collect();
    others.sort();
    for folder in others {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let missing = [MUSCLE_FILE, TRIALS_FILE].into_iter().find(|f| !folder.join(f).is_file());
        if let Some(missing) = missing {
            skipped.push((name, format!("no {missing} in {}", folder.display())));
            continue;
        }
        let start = Start::read(&folder.join(MUSCLE_FILE))?;
        let trials = Trials::read(&folder.join(TRIALS_FILE), &folder, &start.named)?;
        found.push(Found { name, folder, start, trials, published: None, stretched: &[] });
    }
    Ok(found)
}

impl Found {
    /// Fits the complete model.
    fn fitted(&self, search: &Search) -> Result<Fit, FitError> {
        let Start { named, keep_force, .. } = &self.start;
        // Without the reference, which takes longer than the fit for these small muscles.
        let confirm = [Arithmetic::F32, Arithmetic::Fixed];
        fit(named, *keep_force, self.trials.clone(), search, &confirm)
    }

    fn enhancements<'a>(&'a self, fit: &'a Fit, f0: f64) -> impl Iterator<Item = Enhancement> + 'a {
        let find = |name: &str| fit.trials.iter().find(|trial| trial.name == name);
        self.stretched.iter().filter_map(move |&(trial, isometric, end)| {
            let (stretched, held) = (find(trial)?, find(isometric)?);
            let percent = |of: &dyn Fn(&TrialFit) -> f64| 100.0 * (of(stretched) - of(held)) / f0;
            Some(Enhancement {
                dataset: self.name.clone(),
                trial: trial.to_owned(),
                isometric: isometric.to_owned(),
                measured_pct_f0: percent(&|t| average(&t.times, &t.measured, end)),
                model_pct_f0: percent(&|t| average(&t.times, &t.model, end)),
            })
        })
    }
}

/// Mean of the readings that end at a time (s).
fn average(times: &[f64], forces: &[f64], end: f64) -> f64 {
    let near = times.iter().zip(forces).filter(|(t, _)| (end - AVERAGED..=end).contains(*t));
    let (sum, count) = near.fold((0.0, 0), |(sum, count), (_, force)| (sum + force, count + 1));
    sum / f64::from(count)
}

/// Mean of the mean absolute errors of a set and a role; NaN if there are none.
pub fn mean(board: &Board, dataset: &str, role: Option<Role>, left_out: LeftOut) -> f64 {
    let of_interest = |row: &&Row| {
        row.dataset == dataset
            && row.left_out == left_out.name()
            && role.is_none_or(|role| row.role == role.name())
    };
    let errors: Vec<f64> =
        board.rows.iter().filter(of_interest).map(|row| row.mae_pct_f0).collect();
    errors.iter().sum::<f64>() / errors.len() as f64
}
