//! A synthetic patient: a muscle drawn from the spreads, and its recordings.

use super::bout::{Bout, Setting};
use super::list::{Free, OFFSET};
use crate::engine::{self, Arithmetic, RunError};
use crate::fit::{Parameter, Place, applied};
use crate::model_muscle;
use crate::muscle_file::NamedMuscle;
use crate::muscle_file::curve::{self, CURVE};
use crate::reference::{Mode, Muscle};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;
use vm_nostd::RecruitmentCurveParams;

/// Largest distance of a parameter from its mean, in spreads.
const FARTHEST: f64 = 2.5;
/// Range of fascicle lengths at rest on the paths of the protocol, L_ce0, as limited by a joint.
const LENGTHS: (f64, f64) = (0.6, 1.35);
/// Range of L_max of a patient, L_ce0: the 1.4 of the human muscles is an assumption between 1.3
/// and 1.5.
const LONGEST: (f64, f64) = (1.2, 1.6);
/// Limit of draws until a valid muscle is found.
const DRAWS: usize = 10_000;
/// Noise of a reading (standard deviation), share of F0.
const NOISE: f64 = 0.01;
/// Ticks per reading.
pub const STRIDE: usize = 10;

/// Why a patient could not be drawn or recorded.
#[derive(Debug, thiserror::Error)]
pub enum PatientError {
    /// No draw gave a valid muscle.
    #[error("none of {DRAWS} drawn muscles is valid on the paths of the protocol")]
    None,
    /// A run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Invalid recruitment curve.
    #[error(transparent)]
    Curve(#[from] vm_nostd::ParameterError),
}

/// A muscle with known parameters.
#[derive(Clone, Debug)]
pub struct Patient {
    /// Values of the free parameters, in their order.
    pub truths: Vec<f64>,
    /// The muscle.
    pub muscle: Muscle,
    curve: Option<RecruitmentCurveParams>,
    offset: f64,
    noise: ChaCha8Rng,
}

impl Patient {
    /// The patient with a number; independent of the order of calls.
    pub fn draw(
        named: &NamedMuscle,
        mode: Mode,
        free: &[Free],
        bouts: &[Bout],
        (seed, number): (u64, usize),
    ) -> Result<Self, PatientError> {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number as u64);
        let setting = Setting::of(named, mode);
        for _ in 0..DRAWS {
            let truths: Vec<f64> = free.iter().map(|free| drawn(free, &mut generator)).collect();
            let (muscle, curve, offset) = with(named, free, &truths);
            let noise = generator.clone();
            let patient = Self { truths, muscle, curve, offset, noise };
            if patient.can_be(&setting, bouts) {
                return Ok(patient);
            }
        }
        Err(PatientError::None)
    }

    fn can_be(&self, setting: &Setting, bouts: &[Bout]) -> bool {
        let rests = |path: f64| {
            engine::at_rest(&self.muscle, Mode::Fes, Arithmetic::Fixed, 2e-3, path)
                .is_ok_and(|rest| (LENGTHS.0..=LENGTHS.1).contains(&rest.row().0.fascicle_length))
        };
        let paths = bouts.iter().flat_map(|bout| bout.path.iter().map(|point| point.1));
        let (least, most) = paths.fold((0.0_f64, 0.0_f64), |(l, m), p| (l.min(p), m.max(p)));
        let longest = self.muscle.maximum_fascicle_length();
        model_muscle::validate(&self.muscle).is_ok()
            && (LONGEST.0..=LONGEST.1).contains(&longest)
            && self.curve.is_none_or(|curve| curve.validate().is_ok())
            && [least, most]
                .iter()
                .all(|change| rests(setting.neutral + change * setting.fascicle + self.offset))
    }

    /// Force (N) of the reference at every reading of a bout.
    pub fn forces(
        &self,
        setting: &Setting,
        mode: Mode,
        bout: &Bout,
    ) -> Result<Vec<f64>, PatientError> {
        let trace = bout.inputs(setting, self.curve.as_ref(), self.offset)?;
        let rows = engine::run(&self.muscle, mode, Arithmetic::Reference, &trace)?;
        Ok(rows.iter().step_by(STRIDE).map(|row| row.0.force).collect())
    }

    /// One reading: a force with noise.
    pub fn reading(&mut self, force: f64) -> f64 {
        force + NOISE * self.muscle.f0() * normal(&mut self.noise)
    }
}

/// Muscle, recruitment curve and path offset with given values of the free parameters.
fn with(
    named: &NamedMuscle,
    free: &[Free],
    values: &[f64],
) -> (Muscle, Option<RecruitmentCurveParams>, f64) {
    let parameter = |free: &Free| Parameter {
        name: free.name.clone(),
        place: free.place(),
        start: free.mean,
        bounds: free.bounds,
        prior: None,
    };
    let parameters: Vec<Parameter> = free.iter().map(parameter).collect();
    let muscle = applied(&named.muscle, &parameters, values, true);
    let mut numbers = named.curve.as_ref().map(curve::values);
    let mut offset = 0.0;
    for (free, &value) in free.iter().zip(values) {
        match (free.place(), &mut numbers) {
            (Place::Curve(index), Some(numbers)) => numbers[index] = value,
            (Place::Offset, _) => offset = value,
            _ => {}
        }
    }
    (muscle, numbers.map(curve::of_values), offset)
}

impl Free {
    /// Kind of parameter.
    pub fn place(&self) -> Place {
        match self.name.strip_prefix(CURVE).and_then(curve::key) {
            _ if self.name == OFFSET => Place::Offset,
            Some(index) => Place::Curve(index),
            None => crate::fit::Key::named(&self.name).map_or(Place::Offset, Place::Muscle),
        }
    }
}

/// A normally distributed value, truncated to its bounds.
fn drawn(free: &Free, generator: &mut ChaCha8Rng) -> f64 {
    loop {
        let far = normal(generator);
        let value = free.mean + far * free.spread;
        if far.abs() <= FARTHEST && free.bounds.0 < value && value < free.bounds.1 {
            return value;
        }
    }
}

/// Standard normal number (Box-Muller).
fn normal(generator: &mut ChaCha8Rng) -> f64 {
    // 53 bits in (0, 1].
    let mut share = || ((generator.next_u64() >> 11) + 1) as f64 * 2_f64.powi(-53);
    let radius = (-2.0 * share().ln()).sqrt();
    radius * (TAU * share()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let all: Vec<f64> = (0..10_000).map(|_| normal(&mut generator)).collect();
        let mean = all.iter().sum::<f64>() / 1e4;
        let variance = all.iter().map(|x| x * x).sum::<f64>() / 1e4;
        // Four standard errors; those are 0.01 of the mean and sqrt(2/n) = 0.014 of the variance.
        assert!(mean.abs() < 0.04 && (variance - 1.0).abs() < 0.057, "{mean} {variance}");
        let beyond = all.iter().filter(|x| x.abs() > 1.96).count();
        assert!((412..=588).contains(&beyond), "5 %, four standard errors of 22: {beyond}");
    }
}
