//! Uncertainty of the parameters, from the problem linearised at the solution.
//!
//! With J the derivatives of the residuals and s² their variance, the covariance of the parameters
//! is (JᵀJ/s² + P)⁻¹ with the precision P of the priors. Residuals of an imperfect model are
//! autocorrelated: s² is multiplied by (1 + r)/(1 - r) with their lag-1 autocorrelation r, the
//! variance of the mean of such a series (Bartlett, J. R. Stat. Soc. B 8 (1946) 27-41). It is never
//! less than that of the stated noise: smaller residuals are those of a recording that was averaged
//! or computed, and say nothing about the noise of its readings.

use super::parameters::Parameter;
use nalgebra::DMatrix;

/// Half of a 95 % interval, in standard errors.
const NORMAL_95: f64 = 1.96;
/// Correlation above which two parameters trade off.
const TRADE_OFF: f64 = 0.95;
/// Ratio of standard error to the prior's spread above which the recordings count as uninformative.
const AT_PRIOR: f64 = 0.9;

/// A fitted parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard error from recordings and prior; `None` at a bound.
    pub standard_error: Option<f64>,
    /// Whether the value is at one of its bounds.
    pub at_bound: bool,
    /// Whether it is determined by the prior, not by the recordings.
    pub at_prior: bool,
}

impl Estimate {
    /// Remark for tables; empty if none.
    pub fn note(&self) -> &'static str {
        match self {
            Self { at_bound: true, .. } => "at its bound",
            Self { at_prior: true, .. } => "left at its prior",
            _ => "",
        }
    }

    /// The 95 % interval.
    pub fn interval(&self) -> Option<(f64, f64)> {
        self.standard_error.map(|e| (self.value - NORMAL_95 * e, self.value + NORMAL_95 * e))
    }
}

/// Two parameters that trade off.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Names.
    pub names: [String; 2],
    /// Correlation.
    pub correlation: f64,
}

/// Statistics of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// Estimate of each parameter.
    pub estimates: Vec<Estimate>,
    /// Pairs that trade off.
    pub pairs: Vec<Pair>,
    /// Parameters that the recordings do not determine and that have no prior.
    pub undetermined: Vec<String>,
    /// Root mean square of the residuals over the stated noise.
    pub noise_ratio: f64,
}

/// Residuals of a trial of role fit.
#[derive(Clone, Debug)]
pub struct Series {
    /// Weight of the squared residuals.
    pub weight: f64,
    /// Residuals over the stated noise, times the root of the weight.
    pub residuals: Vec<f64>,
}

/// Statistics of a solution. `jacobian` has the derivatives by each parameter in units of its
/// range, `series` the residuals of each trial.
pub fn statistics(
    parameters: &[Parameter],
    values: &[f64],
    jacobian: &DMatrix<f64>,
    series: &[Series],
) -> Statistics {
    let count: usize = series.iter().map(|one| one.residuals.len()).sum();
    let squares: f64 = series.iter().flat_map(|one| &one.residuals).map(|r| r * r).sum();
    // Mean square of residuals that are the stated noise.
    let weights: f64 = series.iter().map(|one| one.weight * one.residuals.len() as f64).sum();
    let stated = weights / count.max(1) as f64;
    let freedom = count.saturating_sub(parameters.len()).max(1) as f64;
    let variance = (squares / freedom * inflation(series)).max(stated);
    let at_bound: Vec<bool> =
        parameters.iter().zip(values).map(|(p, &value)| p.is_at_bound(value)).collect();
    let free: Vec<usize> = (0..parameters.len()).filter(|&index| !at_bound[index]).collect();
    let range = |index: usize| {
        let (least, most) = parameters[index].range();
        most - least
    };
    let columns = jacobian.select_columns(&free);
    let information = columns.transpose() * &columns / variance;
    let mut informed = information;
    for (place, &index) in free.iter().enumerate() {
        if let Some(prior) = parameters[index].prior {
            informed[(place, place)] += (range(index) / prior.spread).powi(2);
        }
    }
    let covariance = covariance(&informed);
    let mut estimates = Vec::new();
    let mut undetermined = Vec::new();
    for (index, parameter) in parameters.iter().enumerate() {
        let place = free.iter().position(|&free| free == index);
        let error = place.map(|place| covariance[(place, place)].sqrt() * range(index));
        let spread = parameter.prior.map(|prior| prior.spread);
        // An interval as wide as the range of starts counts as undetermined.
        let wide = error.is_some_and(|error| 2.0 * NORMAL_95 * error >= range(index));
        if spread.is_none() && wide {
            undetermined.push(parameter.name.clone());
        }
        estimates.push(Estimate {
            name: parameter.name.clone(),
            value: values[index],
            standard_error: error,
            at_bound: at_bound[index],
            at_prior: matches!((error, spread), (Some(e), Some(s)) if e > AT_PRIOR * s),
        });
    }
    let mut pairs = Vec::new();
    for (second, &j) in free.iter().enumerate() {
        for (first, &i) in free[..second].iter().enumerate() {
            let scale = (covariance[(first, first)] * covariance[(second, second)]).sqrt();
            let correlation = covariance[(first, second)] / scale;
            if correlation.abs() > TRADE_OFF {
                let names = [parameters[i].name.clone(), parameters[j].name.clone()];
                pairs.push(Pair { names, correlation });
            }
        }
    }
    let noise_ratio = (squares / weights).sqrt();
    Statistics { estimates, pairs, undetermined, noise_ratio }
}

/// Inflation of the variance of a series by autocorrelation.
fn inflation(series: &[Series]) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for Series { residuals, .. } in series {
        products += residuals.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
        squares += residuals.iter().map(|r| r * r).sum::<f64>();
    }
    let correlation = if squares > 0.0 { (products / squares).clamp(0.0, 0.999) } else { 0.0 };
    (1.0 + correlation) / (1.0 - correlation)
}

/// Inverse of an information matrix; a direction without information gets a huge variance.
fn covariance(information: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = information.clone().symmetric_eigen();
    let greatest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let least = (1e-14 * greatest).max(f64::MIN_POSITIVE.sqrt());
    let inverse = eigen.eigenvalues.map(|value| 1.0 / value.max(least));
    &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::parameters::{Place, Prior};

    fn parameter(name: &str, prior: Option<Prior>) -> Parameter {
        let (name, place) = (name.to_owned(), Place::Offset);
        Parameter { name, place, start: 0.0, bounds: (-5.0, 5.0), prior }
    }

    fn series(residuals: Vec<f64>) -> [Series; 1] {
        [Series { weight: 1.0, residuals }]
    }

    /// A straight line a + b t through readings 0.1 apart with residuals of ±1, against the
    /// textbook formulas.
    #[test]
    fn a_straight_line_has_the_textbook_standard_errors() {
        let times: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.1).collect();
        let residuals: Vec<f64> = (0..1000).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let jacobian = DMatrix::from_fn(1000, 2, |row, column| {
            10.0 * if column == 0 { 1.0 } else { times[row] }
        });
        let parameters = [parameter("a", None), parameter("b", None)];
        let found = statistics(&parameters, &[0.5, 0.25], &jacobian, &series(residuals));
        let (n, mean) = (1000.0, 49.95);
        let spread: f64 = times.iter().map(|t| (t - mean).powi(2)).sum();
        let variance: f64 = n / (n - 2.0);
        let slope = (variance / spread).sqrt();
        let offset = (variance * (1.0 / n + mean * mean / spread)).sqrt();
        for (estimate, expected) in found.estimates.iter().zip([offset, slope]) {
            let error = estimate.standard_error.expect("not at a bound");
            assert!((error / expected - 1.0).abs() < 1e-9, "{estimate:?}: {expected}");
            assert!(!estimate.at_bound && !estimate.at_prior);
        }
        assert!(found.undetermined.is_empty());
        assert!((found.noise_ratio - 1.0).abs() < 1e-12);
    }

    /// The error of a mean of 100 readings with a noise of 1 is 0.1, whatever the residuals are.
    #[test]
    fn residuals_below_the_stated_noise_do_not_narrow_the_intervals() {
        for (weight, size) in [(1.0, 0.0), (1.0, 1e-3), (4.0, 1e-3)] {
            // In units of the range, 10.
            let jacobian = DMatrix::from_element(100, 1, 10.0 * f64::sqrt(weight));
            let slow = (0..100).map(|i| size * (f64::from(i) * 0.1).sin()).collect();
            let series = [Series { weight, residuals: slow }];
            let found = statistics(&[parameter("a", None)], &[0.0], &jacobian, &series);
            let error = found.estimates[0].standard_error.expect("not at a bound");
            assert!((error - 0.1).abs() < 1e-9, "{weight} {size}: {error}");
            assert!(found.noise_ratio <= size, "{found:?}");
        }
    }

    #[test]
    fn undetermined_parameters_are_named_or_left_at_their_prior() {
        // The recordings determine only a + b.
        let jacobian = DMatrix::from_element(100, 2, 10.0);
        let residuals: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let series = series(residuals);
        let neither = [parameter("a", None), parameter("b", None)];
        let found = statistics(&neither, &[0.0, 0.0], &jacobian, &series);
        assert_eq!(found.undetermined, ["a", "b"]);
        assert!(found.pairs[0].correlation < -0.95, "{:?}", found.pairs);

        let prior = Prior { mean: 0.0, spread: 0.01 };
        let one = [parameter("a", None), parameter("b", Some(prior))];
        let found = statistics(&one, &[0.0, 0.0], &jacobian, &series);
        assert!(found.estimates[1].at_prior, "{:?}", found.estimates);
        assert!(found.undetermined.is_empty(), "the prior of b determines a");
    }

    #[test]
    fn autocorrelated_residuals_inflate_the_variance() {
        let alternating =
            inflation(&series((0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect()));
        let slow: Vec<f64> = (0..100).map(|i| (f64::from(i) * 0.1).sin()).collect();
        assert_eq!(alternating, 1.0);
        assert!(inflation(&series(slow)) > 100.0);
    }
}
