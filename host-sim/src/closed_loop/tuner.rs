//! The tuner: the same for every controller, with the same number of evaluations.
//!
//! The first evaluation is the middle of all ranges. A third are random settings, as likely in
//! every decade; the others are the best so far, each setting changed by a random factor that
//! shrinks. An evaluation is one run of every tuning patient. The cost is the 95th percentile of
//! the rms error, and 30 degrees more for the share of runs that were unstable.

use super::controller::{Kind, Settings};
use super::patient::Patient;
use super::percentile::percentile;
use super::random::Random;
use super::task::Task;
use super::trial::Trial;
use rayon::prelude::*;
use vm_nostd::control::JointError;

/// The best settings.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// In the order of [`Kind::ranges`].
    pub settings: Settings,
    /// Their cost, degrees.
    pub cost: f64,
}

/// Cost of an unstable run, degrees.
const UNSTABLE: f64 = 30.0;

/// Tunes a controller on patients with so many evaluations.
pub fn tune(
    kind: Kind,
    task: Task,
    patients: &[Patient],
    evaluations: usize,
) -> Result<Tuned, JointError> {
    // One stream for all: luck is the same.
    let mut random = Random::new(4, task as u64);
    let mut best = Tuned { settings: Vec::new(), cost: f64::INFINITY };
    for evaluation in 0..evaluations {
        let explores = 3 * evaluation < evaluations;
        let spread = 1.0 - evaluation as f64 / evaluations as f64;
        let settings: Settings = kind
            .ranges()
            .iter()
            .enumerate()
            .map(|(index, &(least, most))| {
                let (from, to) = (least.ln(), most.ln());
                let value = if evaluation == 0 {
                    0.5 * (from + to)
                } else if explores {
                    random.between(from, to)
                } else {
                    best.settings[index].ln()
                        + 0.3 * spread * (to - from) * random.between(-1.0, 1.0)
                };
                value.clamp(from, to).exp()
            })
            .collect();
        let cost = cost(kind, task, patients, &settings)?;
        if cost < best.cost {
            best = Tuned { settings, cost };
        }
    }
    Ok(best)
}

fn cost(kind: Kind, task: Task, patients: &[Patient], settings: &[f64]) -> Result<f64, JointError> {
    let scores = patients
        .par_iter()
        .map(|patient| Trial { task, patient, kind, settings, tuning: true }.run(|_| ()))
        .collect::<Result<Vec<_>, _>>()?;
    let rms: Vec<f64> = scores.iter().map(|score| score.rms).collect();
    let unstable = scores.iter().filter(|score| score.unstable).count() as f64;
    Ok(percentile(&rms, 0.95) + UNSTABLE * unstable / scores.len() as f64)
}
