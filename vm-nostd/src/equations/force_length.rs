//! Force-length relation of the filaments: FL = exp(-|(L^beta - 1)/omega|^rho).
//!
//! In the logarithm of the power, rho ln|(L^beta - 1)/omega|, only rho ln|L - 1| is not smooth. The
//! rest, rho ln((L^beta - 1)/((L - 1) omega)), is approximated by a polynomial in L - 1. All types
//! share one logarithm and one reciprocal, and no power of L is computed in a tick.

use crate::error::{ParameterError, within};
use crate::scalar::constant::Constant;
use crate::scalar::float::one_minus_exp;
use crate::scalar::{Arithmetic, Kernels, Scalar};
use crate::summed::summed;
use core::array::from_fn;

/// Coefficients of FL.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceLengthParams {
    /// Width omega; 0.1 to 10.
    #[doc(alias = "omega")]
    pub width: f64,
    /// Skewness beta; 0.1 to 5.
    #[doc(alias = "beta")]
    pub skewness: f64,
    /// Roundness rho; 1 to 10.
    #[doc(alias = "rho")]
    pub roundness: f64,
}

impl ForceLengthParams {
    pub(crate) fn validate(&self) -> Result<(), ParameterError> {
        within("force_length.width", self.width, 0.1, 10.0)?;
        within("force_length.skewness", self.skewness, 0.1, 5.0)?;
        within("force_length.roundness", self.roundness, 1.0, 10.0)
    }
}

/// Largest sum of the magnitudes of the polynomial's terms in fixed point.
const MOST: f64 = 100.0;
/// Number of terms of the polynomial. The error of FL is below 2e-6 for published types and below
/// 1.2e-4 for all valid ones.
const TERMS: usize = 8;
/// Chebyshev nodes in -1..1: cos((2 k + 1) π/16).
const NODES: [f64; TERMS] = [
    -0.980_785_280_403_230_4,
    -0.831_469_612_302_545_2,
    -0.555_570_233_019_602_2,
    -0.195_090_322_016_128_27,
    0.195_090_322_016_128_27,
    0.555_570_233_019_602_2,
    0.831_469_612_302_545_2,
    0.980_785_280_403_230_4,
];

impl ForceLengthParams {
    /// Coefficients of rho ln((L^beta - 1)/((L - 1) omega)) in powers of L - 1, constant first,
    /// interpolated at nodes between two lengths.
    fn smooth(&self, (shortest, longest): (f64, f64)) -> [f64; TERMS] {
        let (middle, half) = (0.5 * (shortest + longest), 0.5 * (longest - shortest));
        let nodes = NODES.map(|node| middle + half * node);
        // Newton's divided differences.
        let mut differences = nodes.map(|length| self.smooth_at(length));
        for order in 1..TERMS {
            for last in (order..TERMS).rev() {
                differences[last] = (differences[last] - differences[last - 1])
                    / (nodes[last] - nodes[last - order]);
            }
        }
        // From the Newton form to powers of L - 1.
        let mut terms = [0.0; TERMS];
        for (difference, node) in differences.iter().zip(&nodes).rev() {
            let distance = 1.0 - node;
            for power in (1..TERMS).rev() {
                terms[power] = terms[power] * distance + terms[power - 1];
            }
            terms[0] = terms[0] * distance + difference;
        }
        terms
    }

    /// rho ln((L^beta - 1)/((L - 1) omega)) at a length.
    fn smooth_at(&self, length: f64) -> f64 {
        let logarithm = Kernels::ln(length);
        // |L^x - 1|; for L > 1 divided by L^x.
        let distance = |exponent: f64| one_minus_exp(exponent * logarithm.abs());
        let ratio =
            if logarithm == 0.0 { self.skewness } else { distance(self.skewness) / distance(1.0) };
        let above = (self.skewness - 1.0) * Arithmetic::max(logarithm, 0.0);
        self.roundness * (Kernels::ln(ratio / self.width) + above)
    }
}

/// Lower bound of |L - 1| in FL, L_ce0: at 0 its logarithm diverges and the slope of |L - 1|^rho
/// has a cusp. At this bound FL is within 1e-4 of 1, within 2e-9 for the paper's types.
const NEAREST: f64 = 1.0 / 524_288.0;
const NEAREST_DISTANCE: Constant = Constant::new(NEAREST);

/// Distance of the fascicles from their optimal length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distance<S: Scalar> {
    /// L - 1, L_ce0.
    offset: S,
    /// ln |L - 1|.
    logarithm: S,
}

impl<S: Scalar> Distance<S> {
    /// Of a fascicle length (L_ce0).
    pub(crate) fn new(fascicle_length: S) -> Self {
        let offset = fascicle_length - S::ONE;
        let nearest = S::constant(&NEAREST_DISTANCE);
        Self { offset, logarithm: offset.abs().max(nearest).ln() }
    }
}

summed! {
    /// FL of one fibre type.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct ForceLength<S: Scalar> {
        roundness: S,
        /// Coefficients of rho ln((L^beta - 1)/((L - 1) omega)) in powers of L - 1, constant first.
        smooth: [S; TERMS],
    }

    valid: |relation| {
        let sum = relation.smooth.iter().fold(S::ZERO, |sum, term| sum + term.abs());
        S::LARGEST_COEFFICIENT > MOST || sum <= S::from_f64(MOST)
    }
}

impl<S: Scalar> ForceLength<S> {
    /// FL for fascicle lengths in a range (L_ce0).
    pub(crate) fn new(params: &ForceLengthParams, domain: (f64, f64)) -> Self {
        Self {
            roundness: S::from_f64(params.roundness),
            smooth: params.smooth(domain).map(S::from_f64),
        }
    }
}

/// FL (0..1) of all types at a distance from the optimal length.
#[inline(always)]
pub(crate) fn at<S: Scalar, const N: usize>(
    types: [&ForceLength<S>; N],
    distance: &Distance<S>,
) -> [S; N] {
    let smooth = distance.offset.polynomials(types.map(|t| &t.smooth));
    let powers: [S; N] = from_fn(|i| types[i].roundness * distance.logarithm + smooth[i]);
    powers.map(|power| S::ONE - power.weibull())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::params::FASCICLE_DOMAIN;
    use crate::params::presets::PAPER_MUSCLE;
    use crate::scalar::fixed::Fixed;
    use crate::{ContinuousMuscle, Input, TimeStep};

    /// FL of a type as a function of length.
    pub(crate) fn force_length<S: Scalar>(params: &ForceLengthParams) -> impl Fn(S) -> S {
        let relation = ForceLength::new(params, FASCICLE_DOMAIN);
        move |length| {
            let [value] = at([&relation], &Distance::new(length));
            value
        }
    }

    pub(crate) fn papers_force_length(p: &ForceLengthParams, l: f64) -> f64 {
        (-((l.powf(p.skewness) - 1.0) / p.width).abs().powf(p.roundness)).exp()
    }

    #[test]
    fn fl_is_1_at_the_optimal_length() {
        for p in PAPER_MUSCLE.fibers.map(|fiber| fiber.fiber_type.force_length) {
            let (f32, fixed) = (force_length::<f32>(&p), force_length::<Fixed>(&p));
            assert!(papers_force_length(&p, 1.0 + NEAREST) > 1.0 - 2e-9);
            for units in -300..=300 {
                let length = 1.0 + f64::from(units) * 2_f64.powi(-23);
                let of_f32 = f32(length as f32);
                let of_fixed = fixed(Fixed::from_f64(length)).to_f64();
                for value in [f64::from(of_f32), of_fixed] {
                    assert!((value - 1.0).abs() < 4e-7, "L {length}: {value}");
                }
            }
        }
    }

    #[test]
    fn the_error_of_any_valid_type_is_below_1_2e_4() {
        for skewness in [0.1, 0.12, 0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0] {
            for width in [0.1, 0.104, 0.2, 0.5, 1.0, 3.0, 10.0] {
                for roundness in [1.0, 1.5, 2.0, 3.0, 10.0] {
                    let p = ForceLengthParams { width, skewness, roundness };
                    let (f32, f64) = (force_length::<f32>(&p), force_length::<f64>(&p));
                    for step in 0..=700 {
                        let length = f64::from((0.4 + 0.002 * f64::from(step)) as f32);
                        let exact = papers_force_length(&p, length);
                        for found in [f64(length), f64::from(f32(length as f32))] {
                            let error = (found - exact).abs();
                            assert!(error < 1.2e-4, "{p:?}, L {length}: {found} {exact}");
                        }
                    }
                    assert!(papers_force_length(&p, 1.0 + NEAREST) > 1.0 - 1e-4, "{p:?}");
                    // Limit of fixed point for the sum of terms, and of those of the slope.
                    let terms = p.smooth(FASCICLE_DOMAIN).map(f64::abs);
                    let steep =
                        terms.iter().zip(0_u8..).map(|(term, power)| term * f64::from(power));
                    assert!(terms.iter().sum::<f64>() < 100.0 && steep.sum::<f64>() < 100.0);
                }
            }
        }
    }

    /// A fully active muscle after 1500 ticks on `path`, as a function that runs one tick to a path
    /// length and returns force/F0.
    fn active<S: Scalar>(path: f64) -> impl FnMut(f64) -> f64 + Clone {
        let params = PAPER_MUSCLE;
        let muscle = ContinuousMuscle::<S, 2>::build(&params, TimeStep::MILLISECOND).unwrap();
        let mut state = muscle.rest(S::path_length(path)).unwrap();
        let mut force = move |path| {
            let input = Input {
                activation: S::ONE,
                path_length: S::path_length(path),
                stimulation_frequency: S::quantity(0.0),
            };
            let force = muscle.step(&mut state, input).force;
            S::newtons(force) / params.max_isometric_force()
        };
        for _ in 0..1500 {
            force(path);
        }
        force
    }

    #[test]
    fn force_is_continuous_at_the_optimal_length() {
        let from = f64::from(0.128_f32);
        let (f32, f64) = (active::<f32>(from), active::<f64>(from));
        // The strides are so closely spaced that for some of them a mid-tick L is exactly 1.
        for trial in 0..40_000 {
            let (mut f32, mut f64) = (f32.clone(), f64.clone());
            let stride = 1.1e-4 * (1.0 + 1e-5 * f64::from(trial));
            for tick in 1..60 {
                let path = f64::from((from + stride * f64::from(tick)) as f32);
                let (found, expected) = (f32(path), f64(path));
                assert!((found - expected).abs() < 1e-5, "stride {stride}: {found} {expected}");
            }
        }
    }
}
