//! The elements of the model, one function per equation of the paper.
//!
//! Forces in F0, fascicle length L in L_ce0, fascicle velocity V in L_ce0/s (lengthening > 0),
//! tendon length in L_se0, firing frequency in f0.5.

use super::muscle::{Elements, FiberType};

/// `ln(exp(x) + 1)` without overflow.
fn softplus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

/// Tendon: F_se = cT kT ln(exp((L_se - LrT)/kT) + 1).
pub fn tendon(e: &Elements, l_se: f64) -> f64 {
    e.cT * e.kT * softplus((l_se - e.LrT) / e.kT)
}

/// Parallel elastic element: F_pe1 = c1 k1 ln(exp((L/L_max - Lr1)/k1) + 1) + eta V.
pub fn parallel_elastic(e: &Elements, l: f64, l_max: f64, v: f64) -> f64 {
    e.c1 * e.k1 * softplus((l / l_max - e.Lr1) / e.k1) + e.eta * v
}

/// Thick-filament compression: F_pe2 = min(0, c2 (exp(k2 (L - Lr2)) - 1)).
pub fn compression(e: &Elements, l: f64) -> f64 {
    (e.c2 * ((e.k2 * (l - e.Lr2)).exp() - 1.0)).min(0.0)
}

/// FL = exp(-|(L^beta - 1)/omega|^rho).
pub fn force_length(t: &FiberType, l: f64) -> f64 {
    (-((l.powf(t.beta) - 1.0) / t.omega).abs().powf(t.rho)).exp()
}

/// FV, shortening and lengthening branch.
pub fn force_velocity(t: &FiberType, l: f64, v: f64) -> f64 {
    if v <= 0.0 {
        (t.Vmax - v) / (t.Vmax + (t.cV0 + t.cV1 * l) * v)
    } else {
        (t.bV - (t.aV0 + t.aV1 * l + t.aV2 * l * l) * v) / (t.bV + v)
    }
}

/// Af = 1 - exp(-(Y S f / (af n_f))^n_f), n_f = nf0 + nf1 (1/L - 1); L is the effective length in
/// modes that have one.
pub fn activation_frequency(t: &FiberType, f: f64, l: f64, y: f64, s: f64) -> f64 {
    let n_f = t.nf0 + t.nf1 * (1.0 / l - 1.0);
    // A stage of the integrator may give f slightly below 0, where the power is undefined.
    1.0 - (-(y * s * f.max(0.0) / (t.af * n_f)).powf(n_f)).exp()
}

/// Rise or fall time of excitation, s: `rising` = Tf1 L² + Tf2 f_env, else (Tf3 + Tf4 a)/L.
pub fn excitation_time(t: &FiberType, rising: bool, l: f64, f_env: f64, a: f64) -> f64 {
    if rising { t.Tf1 * l * l + t.Tf2 * f_env } else { (t.Tf3 + t.Tf4 * a) / l }
}

/// Yield: dY/dt, 1/s; 0 for a type that does not yield.
pub fn yielding_rate(t: &FiberType, y: f64, v: f64) -> f64 {
    t.yielding.map_or(0.0, |p| (1.0 - p.cY * (1.0 - (-v.abs() / p.VY).exp()) - y) / p.TY)
}

/// Sag: dS/dt, 1/s; 0 for a type that does not sag.
pub fn sag_rate(t: &FiberType, s: f64, sagging: bool) -> f64 {
    t.sag.map_or(0.0, |p| {
        let target = if sagging { p.aS2 } else { p.aS1 };
        (target - s) / p.TS
    })
}

/// Effective length: dL_eff/dt = (L - L_eff)³/(T_L (1 - Af)), 1/s.
pub fn effective_length_rate(t: &FiberType, l: f64, l_eff: f64, af: f64) -> f64 {
    // At Af = 1 the rate is infinite; bounded for the integrator.
    (l - l_eff).powi(3) / (t.TL * (1.0 - af).max(1e-6))
}
