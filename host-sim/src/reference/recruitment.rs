//! How activation becomes recruitment: the modes of Virtual Muscle 4.0.

use super::muscle::Muscle;

/// A recruitment mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Natural continuous recruitment: one lumped unit per type.
    Continuous,
    /// Intramuscular FES: every type recruited alike, at one stimulation frequency.
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
pub fn weights(thresholds: &[f64], u_eff: f64) -> Vec<f64> {
    let excess: Vec<f64> = thresholds
        .iter()
        .map(|&threshold| if u_eff >= threshold { u_eff - threshold } else { 0.0 })
        .collect();
    let sum: f64 = excess.iter().sum();
    excess.iter().map(|&e| if sum > 0.0 { e / sum } else { 0.0 }).collect()
}

/// f_env of each type, in f0.5, for raw activation `u` and stimulation frequency `f_stim` (pps).
pub fn firing_frequencies(muscle: &Muscle, mode: Mode, u: f64, f_stim: f64) -> Vec<f64> {
    let thresholds = muscle.recruitment_thresholds();
    muscle
        .fibers
        .iter()
        .zip(thresholds)
        .map(|(fiber, threshold)| {
            let t = &fiber.fiber_type;
            match mode {
                Mode::Continuous if u >= threshold => {
                    t.fmin + (t.fmax - t.fmin) * (u - threshold) / (1.0 - threshold)
                }
                Mode::Continuous => 0.0,
                Mode::Fes => f_stim / t.f05,
            }
        })
        .collect()
}
