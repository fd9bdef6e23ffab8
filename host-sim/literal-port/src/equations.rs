//! The paper's equations and the coefficients of its validation muscle: 60 % slow, 40 % fast.

use crate::real::Real;

/// Drive of the muscle during a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive<R> {
    /// Natural continuous recruitment at an activation, 0..1.
    Natural(R),
    /// Intramuscular FES at a strength, 0..1, and a frequency, pps.
    Fes(R, R),
}

/// States: L, V, U_eff, f_int and f_eff of slow and fast fibres, Y, S.
pub const STATES: usize = 9;

/// Optimal fascicle and tendon length, m.
const L_CE0: f64 = 0.11;
const L_SE0: f64 = 0.02;
/// Longest fascicle, L_ce0.
const L_MAX: f64 = 1.498_750;
/// F0 of the muscle, N: 31.8 N/cm² × 97.5 g/(1.06 g/cm³ × 11 cm).
pub const F0: f64 = 31.8 * 97.5 / (1.06 * 11.0);
/// F0/(m/2 L_ce0), L_ce0/s² per F0.
const ACCELERATION: f64 = F0 / (0.5 * 0.0975 * L_CE0);
const FRACTION: [f64; 2] = [0.6, 0.4];
/// Activation at which each type starts to be recruited.
const THRESHOLD: [f64; 2] = [0.001, 0.48];

/// ln(exp(x) + 1); x itself where the exponential would overflow.
fn softplus<R: Real>(x: R) -> R {
    if x > R::of(30.0) { x } else { (x.exp() + R::of(1.0)).ln() }
}

fn max<R: Real>(a: R, b: R) -> R {
    if a > b { a } else { b }
}

/// F_se, F0, on a path (m) with fascicles of `length`.
pub fn tendon_force<R: Real>(path: R, length: R) -> R {
    let tendon = (path - length * R::of(L_CE0)) / R::of(L_SE0);
    R::of(27.8 * 0.0047) * softplus((tendon - R::of(0.964)) / R::of(0.0047))
}

/// F_pe1, F0.
fn parallel<R: Real>(length: R, velocity: R) -> R {
    let stretch = (length / R::of(L_MAX) - R::of(1.17)) / R::of(0.046);
    R::of(23.0 * 0.046) * softplus(stretch) + R::of(0.01) * velocity
}

/// F_pe2, F0.
fn compression<R: Real>(length: R) -> R {
    let force = R::of(-0.02) * ((R::of(-21.0) * (length - R::of(0.7))).exp() - R::of(1.0));
    if force > R::of(0.0) { R::of(0.0) } else { force }
}

/// FL.
fn force_length<R: Real>(fast: bool, length: R) -> R {
    let (beta, omega, rho) = if fast { (1.55, 0.75, 2.12) } else { (2.3, 1.12, 1.62) };
    let distance = (length.pow(R::of(beta)) - R::of(1.0)) / R::of(omega);
    (-distance.abs().pow(R::of(rho))).exp()
}

/// FV.
fn force_velocity<R: Real>(fast: bool, length: R, v: R) -> R {
    let vmax = R::of(if fast { -9.15 } else { -7.88 });
    if v <= R::of(0.0) {
        let curvature = if fast { R::of(-5.7) + R::of(9.18) * length } else { R::of(5.88) };
        return (vmax - v) / (vmax + curvature * v);
    }
    let b = R::of(if fast { 0.69 } else { 0.35 });
    let a = if fast {
        R::of(-1.53)
    } else {
        R::of(-4.7) + length * (R::of(8.41) - R::of(5.34) * length)
    };
    (b - a * v) / (b + v)
}

/// Af at a frequency scaled by yield or sag.
fn activation_frequency<R: Real>(fast: bool, length: R, frequency: R) -> R {
    let slope = R::of(if fast { 3.3 } else { 5.0 });
    let n_f = R::of(2.1) + slope * (R::of(1.0) / length - R::of(1.0));
    // A Runge-Kutta stage may overshoot slightly below 0.
    let x = max(frequency, R::of(0.0)) / (R::of(0.56) * n_f);
    R::of(1.0) - (-x.pow(n_f)).exp()
}

/// Inputs of the equations during a tick.
pub struct Excitation<R> {
    fes: bool,
    activation: R,
    /// f_env of each type, f0.5.
    frequency: [R; 2],
}

impl<R: Real> Excitation<R> {
    /// The inputs of a drive.
    pub fn of(drive: Drive<R>) -> Self {
        let recruited = |activation: R, threshold: R| {
            let share = (activation - threshold) / (R::of(1.0) - threshold);
            if activation >= threshold { R::of(0.5) + R::of(1.5) * share } else { R::of(0.0) }
        };
        match drive {
            Drive::Natural(activation) => Self {
                fes: false,
                activation,
                frequency: THRESHOLD.map(|threshold| recruited(activation, R::of(threshold))),
            },
            Drive::Fes(activation, pps) => {
                Self { fes: true, activation, frequency: [pps / R::of(12.0), pps / R::of(20.0)] }
            }
        }
    }
}

/// The rate of change of every state, on a path (m).
pub fn rates<R: Real>(excitation: &Excitation<R>, y: &[R; STATES], path: R) -> [R; STATES] {
    let zero = R::of(0.0);
    let [length, v, u_eff, .., yielding, sag] = *y;
    let mut rates = [zero; STATES];
    let (mut active, mut compressing) = (zero, zero);
    let compression = compression(length);

    let excess = THRESHOLD.map(|threshold| max(u_eff - R::of(threshold), zero));
    let sum = excess[0] + excess[1];
    for fast in [false, true] {
        let index = usize::from(fast);
        let (f_int, f_eff) = (y[3 + index], y[5 + index]);
        let f_env = excitation.frequency[index];
        // Input of the two lags, and frequency for Af.
        let (drive, frequency) =
            if excitation.fes { (excitation.activation, f_env) } else { (f_env, f_eff) };
        let scale = if fast { sag } else { yielding };
        let af = activation_frequency(fast, length, scale * frequency);
        let [tf1, tf2, tf3, tf4] = if fast {
            [20.6e-3, 13.6e-3, 28.2e-3, 15.1e-3]
        } else {
            [34.3e-3, 22.7e-3, 47e-3, 25.2e-3]
        };
        let time = if f_int >= f_eff {
            R::of(tf1) * length * length + R::of(tf2) * f_env
        } else {
            let on = R::of(if excitation.activation > zero { 1.0 } else { 0.0 });
            let falling = if excitation.fes { on } else { af };
            (R::of(tf3) + R::of(tf4) * falling) / length
        };
        rates[3 + index] = (drive - f_int) / time;
        rates[5 + index] = (f_int - f_eff) / time;

        let contraction = force_length(fast, length) * force_velocity(fast, length, v);
        if excitation.fes {
            let share = R::of(FRACTION[index]) * af;
            active = active + f_eff * share * contraction;
            compressing = compressing + share * compression;
        } else {
            let weight = if sum > zero { u_eff * excess[index] / sum } else { zero };
            active = active + weight * af * (contraction + compression);
        }
        if fast {
            let target = R::of(if frequency > R::of(0.1) { 0.96 } else { 1.76 });
            rates[8] = (target - sag) / R::of(0.043);
        }
    }
    let yielded = R::of(0.35) * (R::of(1.0) - (-v.abs() / R::of(0.1)).exp());
    rates[7] = (R::of(1.0) - yielded - yielding) / R::of(0.2);

    let passive = parallel(length, v) + compressing;
    let passive = if excitation.fes { max(zero, passive) } else { passive };
    let contractile = max(zero, passive + active);
    rates[0] = v;
    rates[1] = R::of(ACCELERATION) * (tendon_force(path, length) - contractile);
    let lag = R::of(if excitation.activation >= u_eff { 0.03 } else { 0.15 });
    rates[2] = (excitation.activation - u_eff) / lag;
    rates
}

/// Rest on a path (m): equilibrium of the passive forces by bisection.
pub fn rest<R: Real>(path: R) -> [R; STATES] {
    let zero = R::of(0.0);
    let (mut short, mut long) = (R::of(0.4), path / R::of(L_CE0));
    for _ in 0..60 {
        let length = (short + long) * R::of(0.5);
        if tendon_force(path, length) > parallel(length, zero) {
            short = length;
        } else {
            long = length;
        }
    }
    let (yielding, sag) = (R::of(1.0), R::of(1.76));
    [short, zero, zero, zero, zero, zero, zero, yielding, sag]
}
