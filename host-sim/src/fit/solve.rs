//! The search: Levenberg-Marquardt from several starts, on all cores.

use super::error::FitError;
use super::problem::Problem;
use crate::progress;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

/// Settings of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Number of starts: the first as given, the others drawn.
    pub starts: usize,
    /// Seed of the draw; the same seed gives the same fit.
    pub seed: u64,
}

/// Solution reached from a start.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// Half the sum of squares of the residuals, including those of the priors.
    pub objective: f64,
}

/// Maximum number of model evaluations per parameter and start.
const PATIENCE: usize = 20;
/// Convergence: relative change of the sum of squares or of the parameters.
const TOLERANCE: f64 = 1e-6;
/// Step of the one-sided differences, in the unbounded parameters.
const STEP: f64 = 1e-5;
/// Residual of a refused muscle, over the noise: larger than any of a valid muscle.
const REFUSED: f64 = 1e6;

impl Search {
    /// The starts: the first as given, the others from a Latin hypercube over the ranges.
    fn starts(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let parameters = problem.parameters();
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        // 53 bits in [0, 1).
        let mut share = || (generator.next_u64() >> 11) as f64 * 2_f64.powi(-53);
        let mut starts = vec![parameters.iter().map(|p| p.start).collect::<Vec<_>>()];
        let drawn = self.starts.saturating_sub(1);
        starts.resize(1 + drawn, Vec::new());
        for parameter in parameters {
            let (least, most) = parameter.range();
            let mut strata: Vec<usize> = (0..drawn).collect();
            for last in (1..drawn).rev() {
                strata.swap(last, (share() * (last + 1) as f64) as usize);
            }
            for (start, stratum) in starts[1..].iter_mut().zip(strata) {
                let place = (stratum as f64 + share()) / drawn as f64;
                start.push(least + place * (most - least));
            }
        }
        starts
    }

    /// The best solution, and the number of starts that reached it within 0.1 % of its objective.
    pub fn best(&self, problem: &Problem) -> Result<(Solution, usize), FitError> {
        let starts = self.starts(problem);
        let progress = progress::bar("fitting from starts", starts.len());
        let solutions: Vec<Result<Solution, String>> = starts
            .into_par_iter()
            .map(|start| {
                let solution = descend(problem, &start);
                progress.inc(1);
                solution
            })
            .collect();
        progress.finish_and_clear();
        let why = solutions.iter().find_map(|solution| solution.as_ref().err().cloned());
        let mut found: Vec<Solution> = solutions.into_iter().flatten().collect();
        // A stable sort keeps equal solutions in the order of the starts.
        found.sort_by(|a, b| a.objective.total_cmp(&b.objective));
        let Some(best) = found.first().cloned() else {
            return Err(FitError::NoSolution(self.starts, why.unwrap_or_default()));
        };
        let near = found.iter().filter(|s| s.objective <= 1.001 * best.objective + 1e-9).count();
        Ok((best, near))
    }
}

fn descend(problem: &Problem, start: &[f64]) -> Result<Solution, String> {
    if problem.residuals(start).is_none() {
        return Err("the muscle with the start values is refused".to_owned());
    }
    let free = problem.parameters().iter().zip(start).map(|(p, &value)| p.unbounded(value));
    let descent = Descent::new(problem, DVector::from_iterator(start.len(), free));
    let method = LevenbergMarquardt::new()
        .with_ftol(TOLERANCE)
        .with_xtol(TOLERANCE)
        .with_gtol(TOLERANCE)
        .with_stepbound(1.0)
        .with_patience(PATIENCE);
    let (end, report) = method.minimize(descent);
    if report.objective_function.is_finite() && end.is_valid() {
        Ok(Solution { values: end.values(), objective: report.objective_function })
    } else {
        Err(format!("{:?}", report.termination))
    }
}

/// The least-squares problem as seen by the solver.
struct Descent<'a> {
    problem: &'a Problem,
    free: DVector<f64>,
    residuals: Option<DVector<f64>>,
    count: usize,
}

impl<'a> Descent<'a> {
    fn new(problem: &'a Problem, free: DVector<f64>) -> Self {
        let mut descent = Self { problem, free: free.clone(), residuals: None, count: 0 };
        descent.count = descent.at(&free).map_or(0, |residuals| residuals.len());
        descent.set_params(&free);
        descent
    }

    fn is_valid(&self) -> bool {
        self.residuals.is_some()
    }

    fn values_at(&self, free: &DVector<f64>) -> Vec<f64> {
        self.problem.parameters().iter().zip(free.iter()).map(|(p, &x)| p.bounded(x)).collect()
    }

    fn values(&self) -> Vec<f64> {
        self.values_at(&self.free)
    }

    /// Residuals of the recordings and of the priors.
    fn at(&self, free: &DVector<f64>) -> Option<DVector<f64>> {
        let values = self.values_at(free);
        let mut residuals = self.problem.residuals(&values)?;
        residuals.extend(self.problem.prior_residuals(&values));
        Some(DVector::from_vec(residuals))
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Descent<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, free: &DVector<f64>) {
        self.free.copy_from(free);
        self.residuals = self.at(free);
    }

    fn params(&self) -> DVector<f64> {
        self.free.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        // Large residuals make the solver reject a step to a refused muscle; `None` would end it.
        let refused = || DVector::from_element(self.count, REFUSED);
        Some(self.residuals.clone().unwrap_or_else(refused))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let middle = self.residuals.as_ref()?;
        let mut jacobian = DMatrix::zeros(middle.len(), self.free.len());
        for column in 0..self.free.len() {
            let moved = |step: f64| {
                let mut free = self.free.clone();
                free[column] += step;
                Some((self.at(&free)? - middle) / step)
            };
            jacobian.set_column(column, &moved(STEP).or_else(|| moved(-STEP))?);
        }
        Some(jacobian)
    }
}
