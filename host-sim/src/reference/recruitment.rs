//! Recruitment: the modes of Virtual Muscle 4.0.

use super::muscle::Muscle;

/// A recruitment mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Natural discrete recruitment: motor units one by one.
    Discrete,
    /// The same with the effective length of each unit (VM 3.x).
    DiscreteEffectiveLength,
    /// Natural continuous recruitment: one lumped unit per type.
    Continuous,
    /// Intramuscular FES: all types recruited in proportion, at one stimulation frequency.
    Fes,
}

/// Rise and fall time constants of effective activation, s.
const T_U_RISE: f64 = 0.03;
const T_U_FALL: f64 = 0.15;

/// dU_eff/dt = (U - U_eff)/T_U, 1/s.
pub fn effective_activation_rate(u: f64, u_eff: f64) -> f64 {
    (u - u_eff) / if u >= u_eff { T_U_RISE } else { T_U_FALL }
}

/// Weights W_i of the types: the excess of U_eff over each threshold, over the sum of all.
pub fn weights(units: &[Unit], u_eff: f64) -> Vec<f64> {
    let excess: Vec<f64> = units
        .iter()
        .map(|unit| if u_eff >= unit.threshold { u_eff - unit.threshold } else { 0.0 })
        .collect();
    let sum: f64 = excess.iter().sum();
    excess.iter().map(|&e| if sum > 0.0 { e / sum } else { 0.0 }).collect()
}

/// A recruited unit: a fibre type or one of its motor units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Index of its fibre type.
    pub fiber: usize,
    /// Its share of the muscle's cross section.
    pub pcsa: f64,
    /// Recruitment threshold Uth.
    pub threshold: f64,
}

/// The units of a muscle, in order of recruitment.
///
/// Discrete: Uth_j = max(0.001, U_r times the cumulative cross section including unit j).
pub fn units(muscle: &Muscle, mode: Mode) -> Vec<Unit> {
    let fibers = muscle.fibers.iter().enumerate();
    match mode {
        Mode::Continuous | Mode::Fes => fibers
            .zip(muscle.recruitment_thresholds())
            .map(|((fiber, f), threshold)| Unit { fiber, pcsa: f.fraction, threshold })
            .collect(),
        Mode::Discrete | Mode::DiscreteEffectiveLength => fibers
            .flat_map(|(fiber, f)| f.units.iter().map(move |share| (fiber, share * f.fraction)))
            .scan(0.0, |cumulative, (fiber, pcsa)| {
                *cumulative += pcsa;
                // The shares add to 1 within rounding.
                let threshold = (muscle.U_r * *cumulative).clamp(0.001, 1.0);
                Some(Unit { fiber, pcsa, threshold })
            })
            .collect(),
    }
}

/// f_env of each unit, in f0.5, for raw activation `u` and stimulation frequency `f_stim` (pps).
pub fn firing_frequencies(
    muscle: &Muscle,
    mode: Mode,
    units: &[Unit],
    u: f64,
    f_stim: f64,
) -> Vec<f64> {
    units
        .iter()
        .map(|unit| {
            let t = &muscle.fibers[unit.fiber].fiber_type;
            if mode == Mode::Fes {
                f_stim / t.f05
            } else if u < unit.threshold {
                0.0
            } else if unit.threshold >= 1.0 {
                // Recruited at U = 1, where all units fire at fmax.
                t.fmax
            } else {
                t.fmin + (t.fmax - t.fmin) * (u - unit.threshold) / (1.0 - unit.threshold)
            }
        })
        .collect()
}
