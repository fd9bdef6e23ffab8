//! Published recordings of real muscle: the model is fitted to some and compared with the rest.
//!
//! The definitions of the fits are in `data/measured`; the recordings are read from a folder.

use crate::fit::{Fit, FitError, Role, Search, Start, Trials, fit};
use crate::reference::Muscle;
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
}

const KNOWN: [Known; 2] = [
    Known {
        folder: "krylow_sandercock_1997",
        muscle: include_str!("../data/measured/krylow_sandercock_1997.muscle.toml"),
        trials: include_str!("../data/measured/krylow_sandercock_1997.trials.toml"),
        // Six amplitudes, three Hill models fitted by their morphometry: Millard et al., J.
        // Biomech. Eng. 135 (2013) 021005.
        published: Some([3.3, 8.9]),
    },
    Known {
        folder: "herzog_leonard_2002",
        muscle: include_str!("../data/measured/herzog_leonard_2002.muscle.toml"),
        trials: include_str!("../data/measured/herzog_leonard_2002.trials.toml"),
        published: None,
    },
];

/// Files of a folder that brings its own definition.
const MUSCLE_FILE: &str = "muscle.toml";
const TRIALS_FILE: &str = "trials.toml";

/// Ablation: a feature of Virtual Muscle that is left out, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// The full model.
    Nothing,
    /// Without yield.
    Yield,
    /// n_f is nf0 at all lengths.
    ActivationLength,
    /// FV at all lengths as at L_ce0.
    VelocityLength,
}

impl LeftOut {
    /// All versions, the full model first.
    pub const ALL: [Self; 4] =
        [Self::Nothing, Self::Yield, Self::ActivationLength, Self::VelocityLength];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Yield => "yield",
            Self::ActivationLength => "length dependence of Af",
            Self::VelocityLength => "length dependence of FV",
        }
    }

    fn out_of(self, muscle: &mut Muscle) {
        for fiber in &mut muscle.fibers {
            let t = &mut fiber.fiber_type;
            match self {
                Self::Nothing => {}
                Self::Yield => t.yielding = None,
                Self::ActivationLength => t.nf1 = 0.0,
                Self::VelocityLength => {
                    (t.cV0, t.cV1) = (t.cV0 + t.cV1, 0.0);
                    (t.aV0, t.aV1, t.aV2) = (t.aV0 + t.aV1 + t.aV2, 0.0, 0.0);
                }
            }
        }
    }

    /// Whether a free parameter belongs to the left-out feature.
    fn concerns(self, name: &str) -> bool {
        let keys: &[&str] = match self {
            Self::Nothing => &[],
            Self::Yield => &["cY", "VY", "TY_ms"],
            Self::ActivationLength => &["nf1"],
            Self::VelocityLength => &["cV1", "aV1", "aV2"],
        };
        name.rsplit_once('.').is_some_and(|(_, key)| keys.contains(&key))
    }
}

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

/// Results.
#[derive(Clone, Debug, Default)]
pub struct Board {
    /// Every trial.
    pub rows: Vec<Row>,
    /// The fits, by set and left-out feature.
    pub fits: Vec<(String, &'static str, Fit)>,
    /// Missing sets, with the reason.
    pub skipped: Vec<(String, String)>,
    /// Ablations that cannot be fitted, by set and left-out feature, with the reason.
    pub refused: Vec<(String, &'static str, String)>,
}

/// A set of recordings on disk.
struct Found {
    name: String,
    folder: PathBuf,
    start: Start,
    trials: Trials,
    published: Option<[f64; 2]>,
}

/// Compares the model with every set of recordings in `folder`, for the versions `left_out`.
pub fn measure(folder: &Path, left_out: &[LeftOut], search: &Search) -> Result<Board, FitError> {
    let mut board = Board::default();
    let found = find(folder, &mut board.skipped)?;
    let jobs: Vec<(&Found, LeftOut)> =
        found.iter().flat_map(|set| left_out.iter().map(move |&out| (set, out))).collect();
    let fits = jobs
        .into_par_iter()
        .map(|(set, out)| (set, out, set.fitted(out, search)))
        .collect::<Vec<_>>();
    for (set, out, fit) in fits {
        let fit = match fit {
            Ok(fit) => fit,
            Err(error) if out == LeftOut::Nothing => return Err(error),
            Err(error) => {
                board.refused.push((set.name.clone(), out.name(), error.to_string()));
                continue;
            }
        };
        // The measured F0, not the fitted one.
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
            let (name, published) = (known.folder.to_owned(), known.published);
            found.push(Found { name, folder: place, start, trials, published });
        } else {
            let reason = format!("{}: no such folder", place.display());
            skipped.push((known.folder.to_owned(), reason));
        }
    }
    let mut others: Vec<PathBuf> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.join(TRIALS_FILE).is_file())
        .filter(|path| !found.iter().any(|set: &Found| set.folder == *path))
        .collect();
    others.sort();
    for folder in others {
        let start = Start::read(&folder.join(MUSCLE_FILE))?;
        let trials = Trials::read(&folder.join(TRIALS_FILE), &folder, &start.named)?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        found.push(Found { name, folder, start, trials, published: None });
    }
    Ok(found)
}

impl Found {
    fn fitted(&self, out: LeftOut, search: &Search) -> Result<Fit, FitError> {
        let mut start = self.start.named.clone();
        out.out_of(&mut start.muscle);
        let mut trials = self.trials.clone();
        trials.keep(|parameter| !out.concerns(&parameter.name));
        fit(&start, self.start.keep_force, trials, search)
    }
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
