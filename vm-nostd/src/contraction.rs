//! The mechanics: a mass between tendon and fascicles,
//! (m/2) d²x/dt² = F0 (F_se - F_ce'), x = L L_ce0.
//!
//! Active, the fascicles follow the tendon within 10 to 50 µs; passive, they ring on it at some
//! 400 Hz. An L-stable, singly diagonally implicit Runge-Kutta pair of stages (gamma = 1 - 1/√2)
//! is sound in both, with the tendon kept nonlinear. Each stage is one scalar equation in V, its
//! residual rising with V, so that the residual's sign at V = 0 tells the sign of the root and
//! with it the branch of FV. On that branch Halley's iteration, exact for a single hyperbola, needs
//! no search and no loop that depends on the data.

use crate::domain::MAXIMUM_SPEED;
use crate::force_velocity::VelocityCurve;
use crate::params::MuscleParams;
use crate::recruitment::Course;
use crate::scalar::Scalar;
use crate::tendon::Tendon;
use crate::time_step::TimeStep;

/// gamma = 1 - 1/√2.
const GAMMA: f64 = 1.0 - core::f64::consts::FRAC_1_SQRT_2;
/// First substep of a tick, s. Inputs jump where a tick begins, and the fascicles follow within
/// 50 µs: a short first substep resolves what they travel meanwhile.
const FIRST_SUBSTEP: f64 = 0.05e-3;
/// Longest of the other substeps, s.
const LONGEST_SUBSTEP: f64 = 0.25e-3;
/// The other substeps resolve the ringing of a passive muscle: of angular frequency w, and of
/// amplitude A in F0 where the path's speed jumps by 1 L_ce0/s, it is w h √A at most. The error
/// of a step that is second order goes with the square of this.
const RINGING: f64 = 0.16;
/// Most of the other substeps: only a muscle far from any anatomy asks for more.
const MOST_SUBSTEPS: u8 = 40;
/// Iterations per stage, after the branch is known.
const ITERATIONS: usize = 2;
/// The mechanics count as settled if no residual before a stage's last iteration is larger, F0.
const SETTLED: f64 = 0.25;

/// Motion of the fascicles since the tick's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<S> {
    /// How much longer they have become, as the velocity that would have done it in a tick,
    /// L_ce0/s.
    pub(crate) travel: S,
    /// L_ce0/s.
    pub(crate) velocity: S,
}

/// A motion found by iteration, and the largest residual (F0) that a last iteration met.
#[derive(Clone, Copy, Debug)]
struct Solved<S> {
    motion: Motion<S>,
    residual: S,
}

/// What a tick has done to the mechanics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Advanced<S> {
    pub(crate) motion: Motion<S>,
    /// No stage left its equation far from solved.
    pub(crate) settled: bool,
}

/// The contractile element during one tick:
/// F_ce' = max(0, passive + Σ gain_i FV_i), forces in F0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contractile<S, const N: usize> {
    /// What multiplies FV of each type.
    pub(crate) gains: [Course<S>; N],
    /// FV of each type.
    pub(crate) curves: [VelocityCurve<S>; N],
    /// Passive force at the length the tick starts with and V = 0.
    pub(crate) passive: Course<S>,
    /// Its slope, F0 per tick at 1 L_ce0/s.
    pub(crate) passive_slope: S,
    /// The least that the passive force may be, F0.
    pub(crate) passive_floor: S,
}

/// Coefficients of the mechanics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contraction<S: Scalar> {
    pub(crate) tendon: Tendon<S>,
    /// eta, F0 s/L_ce0.
    viscosity: S,
    first: Substep<S>,
    other: Substep<S>,
    others: u8,
    /// A tick, s.
    tick: S::Factor,
    speed: S,
    residual: S,
}

/// Coefficients of a substep of a given length.
#[derive(Clone, Copy, Debug)]
struct Substep<S: Scalar> {
    /// As a share of the tick.
    share: S,
    /// gamma times that.
    gamma_share: S,
    /// (1 - gamma) times that.
    carry_share: S,
    /// (1 - gamma)/gamma.
    carry: S,
    /// Mass over gamma times the substep, F0 s/L_ce0.
    inertia: S,
}

impl<S: Scalar> Substep<S> {
    /// A substep of `seconds`, for a mass in F0 s²/L_ce0.
    fn new(seconds: f64, step: TimeStep, mass: f64) -> Self {
        let share = seconds / step.seconds();
        let inertia = mass / (GAMMA * seconds);
        Self {
            share: S::from_f64(share),
            gamma_share: S::from_f64(GAMMA * share),
            carry_share: S::from_f64((1.0 - GAMMA) * share),
            carry: S::from_f64((1.0 - GAMMA) / GAMMA),
            inertia: S::from_f64(inertia),
        }
    }
}

/// Half the mass of a muscle, F0 s²/L_ce0.
fn moving_mass<const N: usize>(params: &MuscleParams<N>) -> f64 {
    0.5 * params.mass * params.fascicle_length / params.max_isometric_force()
}

/// The tendon's stiffness when it is taut, F0/L_ce0.
fn tendon_stiffness<const N: usize>(params: &MuscleParams<N>) -> f64 {
    params.elements.tendon.stiffness * params.fascicle_length / params.tendon_length
}

/// The largest coefficient of the mechanics of a muscle: its inertia in the shortest substep.
pub(crate) fn largest_inertia<const N: usize>(params: &MuscleParams<N>, step: TimeStep) -> f64 {
    let mass = moving_mass(params);
    let rest = step.seconds() - FIRST_SUBSTEP;
    let other = rest / f64::from(ringing_substeps(rest, mass, tendon_stiffness(params)));
    mass / (GAMMA * Scalar::min(other, FIRST_SUBSTEP))
}

/// How many substeps cover `rest` (s), for a mass (F0 s²/L_ce0) on a tendon (F0/L_ce0).
fn ringing_substeps(rest: f64, mass: f64, stiffness: f64) -> u8 {
    // w h √A <= RINGING in its fourth power, which takes no root: w² = stiffness/mass and
    // A² = stiffness mass.
    let square = |x: f64| x * x;
    let wanted = square(stiffness / mass) * stiffness * mass;
    (1..MOST_SUBSTEPS)
        .find(|&count| {
            let substep = rest / f64::from(count);
            substep <= LONGEST_SUBSTEP * (1.0 + 1e-9)
                && square(square(substep / RINGING)) * wanted <= 1.0
        })
        .unwrap_or(MOST_SUBSTEPS)
}

impl<S: Scalar> Contraction<S> {
    pub(crate) fn new<const N: usize>(params: &MuscleParams<N>, step: TimeStep) -> Self {
        let mass = moving_mass(params);
        let stiffness = tendon_stiffness(params);
        let rest = step.seconds() - FIRST_SUBSTEP;
        let others = ringing_substeps(rest, mass, stiffness);
        let tendon = &params.elements.tendon;
        Self {
            tendon: Tendon::new(tendon, params.fascicle_length, params.tendon_length, step),
            viscosity: S::from_f64(params.elements.parallel.viscosity),
            first: Substep::new(FIRST_SUBSTEP, step, mass),
            other: Substep::new(rest / f64::from(others), step, mass),
            others,
            tick: S::factor(step.seconds()),
            speed: S::from_f64(MAXIMUM_SPEED),
            residual: S::from_f64(SETTLED),
        }
    }

    /// What the fascicles have travelled, L_ce0, by a travel in L_ce0/s and ticks.
    pub(crate) fn lengthening(&self, travel: S) -> S {
        travel.scaled(&self.tick)
    }

    /// One tick from `velocity`, in which the tendon, were the fascicles to stay as they are, would
    /// go linearly through `extension` (L_ce0 beyond slack).
    ///
    /// The tendon's extension, not the fascicles' length, carries the state: near slack it is a
    /// small number, and in `f32` a slow motion is not lost in the rounding of a large one.
    pub(crate) fn advance<const N: usize>(
        &self,
        velocity: S,
        extension: Course<S>,
        contractile: &Contractile<S, N>,
    ) -> Advanced<S> {
        let start = Motion { travel: S::ZERO, velocity };
        // Time since the tick's middle, in ticks.
        let mut time = -S::HALF;
        let mut all = self.substep(&self.first, start, time, extension, contractile);
        time = time + self.first.share;
        for _ in 0..self.others {
            let one = self.substep(&self.other, all.motion, time, extension, contractile);
            all = Solved { motion: one.motion, residual: all.residual.max(one.residual) };
            time = time + self.other.share;
        }
        Advanced { motion: all.motion, settled: all.residual <= self.residual }
    }

    /// One substep from `start` at `time`: two implicit stages, at gamma and at its end.
    fn substep<const N: usize>(
        &self,
        substep: &Substep<S>,
        start: Motion<S>,
        time: S,
        extension: Course<S>,
        contractile: &Contractile<S, N>,
    ) -> Solved<S> {
        let at_first = time + substep.gamma_share;
        let first = self.stage(substep, start, at_first, extension, contractile, start.velocity);
        let velocity = first.motion.velocity;
        let gained = substep.carry.saturating_mul(velocity - start.velocity);
        let carried = Motion {
            travel: start.travel + substep.carry_share * velocity,
            velocity: start.velocity.saturating_add(gained),
        };
        let at_end = time + substep.share;
        let last = self.stage(substep, carried, at_end, extension, contractile, velocity);
        Solved { motion: last.motion, residual: first.residual.max(last.residual) }
    }

    /// One implicit stage at `time` from `base`: L = L_b + gamma h V, V = V_b + gamma h dV/dt.
    fn stage<const N: usize>(
        &self,
        substep: &Substep<S>,
        base: Motion<S>,
        time: S,
        extension: Course<S>,
        contractile: &Contractile<S, N>,
        guess: S,
    ) -> Solved<S> {
        let extension = extension.middle + extension.change * time;
        let standstill = self.tendon.pull(extension - self.lengthening(base.travel));
        let stage = Stage {
            contraction: self,
            substep,
            base,
            extension,
            // Drawn out to the tick's ends, a gain that falls fast would pass 0.
            gains: contractile.gains.map(|gain| (gain.middle + gain.change * time).max(S::ZERO)),
            passive: (contractile.passive.middle + contractile.passive.change * time)
                .saturating_add(contractile.passive_slope.saturating_mul(base.travel)),
            contractile,
        };
        let lengthening = stage.residual_at_standstill(standstill.force) < S::ZERO;
        let mut velocity = if (guess > S::ZERO) == lengthening { guess } else { S::ZERO };
        let mut residual = S::ZERO;
        for _ in 0..ITERATIONS {
            let found = stage.residual(lengthening, velocity);
            let correction = found.value.halley(found.slope, found.half_curvature);
            let next = velocity.saturating_add(-correction);
            velocity = if lengthening {
                next.max(S::ZERO).min(self.speed)
            } else {
                next.min(S::ZERO).max(-self.speed)
            };
            residual = found.value.abs();
        }
        let travel = base.travel + substep.gamma_share * velocity;
        Solved { motion: Motion { travel, velocity }, residual }
    }
}

/// One stage's equation: inertia (V - V_b) + F_ce'(V) - F_se(L_b + gamma h V) = 0.
struct Stage<'a, S: Scalar, const N: usize> {
    contraction: &'a Contraction<S>,
    substep: &'a Substep<S>,
    contractile: &'a Contractile<S, N>,
    base: Motion<S>,
    extension: S,
    gains: [S; N],
    passive: S,
}

/// The residual of a stage's equation and how it goes on with V.
struct Residual<S> {
    /// F0.
    value: S,
    /// By V; always positive.
    slope: S,
    /// Half the second derivative by V, of FV alone: the tendon's toe is too narrow to follow.
    half_curvature: S,
}

impl<S: Scalar, const N: usize> Stage<'_, S, N> {
    /// The residual, F0, at V = 0, where FV is 1, with the tendon's force there.
    fn residual_at_standstill(&self, pull: S) -> S {
        let passive = self.passive.max(self.contractile.passive_floor);
        let force = self.gains.iter().fold(passive, |sum, gain| sum.saturating_add(*gain));
        self.substep
            .inertia
            .saturating_mul(-self.base.velocity)
            .saturating_add(force.max(S::ZERO))
            .saturating_add(-pull)
    }

    /// The residual, F0, on one branch of FV.
    fn residual(&self, lengthening: bool, velocity: S) -> Residual<S> {
        let (c, substep) = (self.contraction, self.substep);
        let resistance = c.viscosity + self.contractile.passive_slope * substep.gamma_share;
        let mut force = self.passive.saturating_add(resistance.saturating_mul(velocity));
        let (mut slope, mut half_curvature) = (resistance, S::ZERO);
        if force < self.contractile.passive_floor {
            (force, slope) = (self.contractile.passive_floor, S::ZERO);
        }
        for (gain, curve) in self.gains.iter().zip(&self.contractile.curves) {
            let (value, steepness, bend) = curve.at(lengthening, velocity);
            force = force.saturating_add(*gain * value);
            slope = slope.saturating_add(*gain * steepness);
            half_curvature = half_curvature.saturating_add(*gain * bend);
        }
        if force < S::ZERO {
            (force, slope, half_curvature) = (S::ZERO, S::ZERO, S::ZERO);
        }
        let travel = self.base.travel + substep.gamma_share * velocity;
        let pull = c.tendon.pull(self.extension - c.lengthening(travel));
        let acceleration = substep.inertia.saturating_mul(velocity - self.base.velocity);
        Residual {
            value: acceleration.saturating_add(force).saturating_add(-pull.force),
            slope: slope.saturating_add(substep.inertia + pull.stiffness * substep.gamma_share),
            half_curvature,
        }
    }
}
