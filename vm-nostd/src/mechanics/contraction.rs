//! The mechanics: a mass between tendon and fascicles,
//! (m/2) d²x/dt² = F0 (F_se - F_ce'), x = L L_ce0.
//!
//! Active, the fascicles follow the tendon within 10 to 50 µs; passive, they ring on it at some
//! 400 Hz. One implicit midpoint rule, fitted to both ends, does for both: a substep's forces are
//! balanced once, at its middle, for the mean velocity there, with the branch of FV told by the
//! sign of the balance at V = 0. From the velocity foreseen, FV is followed as the hyperbola that
//! has its slope and curvature there, which it is where one fibre type acts alone: what is left to
//! solve is quadratic, and its root right even where the path's speed jumps.
//!
//! - Ringing: the rule turns the phase of an oscillation by 2 atan(w h/2) instead of w h; with an
//!   inertia that is less by as much as the tendon is taut, it turns it by w h on a taut tendon,
//!   and neither loses nor gains energy.
//! - Damping: the midpoint rule would leave velocity that damping has long consumed, to alternate
//!   for ever. How much of it is left is taken from the slope of FV; see [`decay`].

use super::abreast::{sum, zip};
use super::decay;
use crate::checksum::summed;
use crate::equations::force_velocity::{Branch, VelocityCurve};
use crate::equations::tendon::Tendon;
use crate::equations::yielding::{SPREAD, Speed};
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::params::class::{Class, Substeps};
use crate::params::limits::MAXIMUM_SPEED;
use crate::recruitment::RecruitmentTick;
use crate::scalar::Scalar;
use crate::scalar::cold::cold_path;
use crate::scalar::float::{square_root, tangent};
use crate::tick::course::Course;
use crate::tick::time_step::TimeStep;

/// From here on a tick counts as one of 1 ms, s: no rounding of its length takes it below.
const COARSE_TICK: f64 = 0.999e-3;
/// The greatest w h of a substep: beyond, a muscle that rings would turn by more than half a period
/// in it, and no inertia could be fitted to that.
const COARSEST_PHASE: f64 = 2.84;
/// Most of the substeps: only a muscle far from any anatomy asks for more.
const MOST_SUBSTEPS: u8 = 40;
/// w h/2 that inertia is fitted for at most: at pi/2 there would be none left, and from here on
/// what little is left makes errors after a jerk grow again.
const FASTEST_RINGING: f64 = 1.1;
/// The mechanics count as settled if no net force at a predicted velocity is more, F0.
const SETTLED: f64 = 0.5;
/// Lower bound on dF_ce/dV, which is a divisor, F0 s/L_ce0: far below any viscosity.
const LEAST_STEEPNESS: f64 = 1e-5;

/// Motion of the fascicles since the tick's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<S> {
    /// How much longer they have become, as the velocity that would have done it in a tick,
    /// L_ce0/s.
    pub(crate) travel: S,
    /// L_ce0/s.
    pub(crate) velocity: S,
}

/// What a tick has done to the mechanics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Advanced<S> {
    pub(crate) motion: Motion<S>,
    pub(crate) speed: Speed<S>,
    /// No substep began far from its balance.
    pub(crate) settled: bool,
    /// A substep held the velocity at the greatest there is.
    pub(crate) held: bool,
}

/// The contractile element during one tick:
/// F_ce' = max(0, passive + Σ gain_i FV_i), forces in F0; in some modes the passive force is itself
/// 0 at least.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contractile<'a, S: Scalar, const N: usize> {
    /// What multiplies FV of each type; never negative, but by rounding.
    pub(crate) gains: [Course<S>; N],
    /// The types, of which FV is asked.
    pub(crate) fibers: &'a [Fiber<S>; N],
    /// What FV of each depends on during the tick.
    pub(crate) curves: [VelocityCurve<S>; N],
    /// Passive force at the length the tick starts with and V = 0.
    pub(crate) passive: Course<S>,
    /// Its slope, F0 per tick at 1 L_ce0/s.
    pub(crate) passive_slope: S,
}

/// Coefficients of the mechanics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contraction<S: Scalar> {
    pub(crate) tendon: Tendon<S>,
    /// eta, F0 s/L_ce0.
    viscosity: S,
    substep: Substep<S>,
    /// How many there are.
    substeps: u8,
    /// A tick, s.
    tick: S::Part,
    /// Ticks per second.
    tick_rate: S::Factor,
    speed: S,
    /// The slowest V_max of the types, L_ce0/s.
    slowest: S,
    /// 1 over the unit of a variance of speeds.
    per_spread: S::Part,
    settled: S,
    least_steepness: S,
}

summed!([S: Scalar] Contraction<S> { tendon, viscosity, substep, substeps, tick, tick_rate, speed, slowest, per_spread, settled, least_steepness });

/// Coefficients of a substep of a given length.
#[derive(Clone, Copy, Debug)]
struct Substep<S: Scalar> {
    /// Half of it, in ticks.
    half: S::Part,
    /// Mass over half the substep, F0 s/L_ce0.
    inertia: S,
    /// How much less that is on a taut tendon.
    fitted: S,
    /// Stiffness of the taut tendon times half the substep, F0 s/L_ce0.
    taut: S,
}

summed!([S: Scalar] Substep<S> { half, inertia, fitted, taut });

impl<S: Scalar> Substep<S> {
    /// A substep of `seconds`, for a mass in F0 s²/L_ce0 on a taut tendon in F0/L_ce0.
    fn new(seconds: f64, step: TimeStep, mass: f64, stiffness: f64) -> Self {
        let half = 0.5 * seconds;
        let inertia = mass / half;
        // Half the phase that the ringing turns by; tan of it is what the midpoint rule sees.
        let phase = Scalar::min(half * square_root(stiffness / mass), FASTEST_RINGING);
        let share = phase / tangent(phase);
        Self {
            half: S::part(half / step.seconds()),
            inertia: S::from_f64(inertia),
            fitted: S::from_f64(inertia * (1.0 - share * share)),
            taut: S::from_f64(stiffness * half),
        }
    }
}

/// Name of a derived quantity that fixed point refuses.
pub(crate) const INERTIA: &str = "fascicle_length: inertia in a substep, F0 s/L_ce0";

/// Half the mass of a muscle, F0 s²/L_ce0.
fn moving_mass<const N: usize>(params: &MuscleParams<N>) -> f64 {
    0.5 * params.mass * params.fascicle_length / params.max_isometric_force()
}

/// The tendon's stiffness when it is taut, F0/L_ce0.
fn tendon_stiffness<const N: usize>(params: &MuscleParams<N>) -> f64 {
    params.elements.tendon.stiffness * params.fascicle_length / params.tendon_length
}

/// The largest coefficient of the mechanics of a muscle: its inertia in a substep.
pub(crate) fn largest_inertia<const N: usize>(params: &MuscleParams<N>, step: TimeStep) -> f64 {
    let mass = moving_mass(params);
    2.0 * mass * f64::from(substeps(params.class, step, mass, tendon_stiffness(params)))
        / step.seconds()
}

/// How many substeps a tick has in a class, for a mass (F0 s²/L_ce0) on a tendon (F0/L_ce0).
fn substeps(class: Class, step: TimeStep, mass: f64, stiffness: f64) -> u8 {
    // In powers which take no root: w² = stiffness/mass and A² = stiffness mass.
    let square = |x: f64| x * x;
    let (frequency, amplitude) = (stiffness / mass, stiffness * mass);
    let Substeps { longest: (coarse, fine), ringing } = class.substeps();
    let longest = if step.seconds() >= COARSE_TICK { coarse } else { fine };
    (1..MOST_SUBSTEPS)
        .find(|&count| {
            let substep = step.seconds() / f64::from(count);
            substep <= longest * (1.0 + 1e-9)
                && square(substep / COARSEST_PHASE) * frequency <= 1.0
                && square(square(substep / ringing) * frequency) * amplitude <= 1.0
        })
        .unwrap_or(MOST_SUBSTEPS)
}

impl<S: Scalar> Contraction<S> {
    /// The mechanics of a muscle.
    pub(crate) fn new<const N: usize>(params: &MuscleParams<N>, step: TimeStep) -> Self {
        let (mass, stiffness) = (moving_mass(params), tendon_stiffness(params));
        let substeps = substeps(params.class, step, mass, stiffness);
        let seconds = step.seconds() / f64::from(substeps);
        let tendon = &params.elements.tendon;
        Self {
            tendon: Tendon::new(tendon, params.fascicle_length, params.tendon_length, step),
            viscosity: S::from_f64(params.elements.parallel.viscosity),
            substep: Substep::new(seconds, step, mass, stiffness),
            substeps,
            tick: S::part(step.seconds()),
            tick_rate: S::factor(1.0 / step.seconds()),
            speed: S::from_f64(MAXIMUM_SPEED),
            slowest: S::from_f64(params.shortening_velocity()),
            per_spread: S::part(1.0 / SPREAD),
            settled: S::from_f64(SETTLED),
            least_steepness: S::from_f64(LEAST_STEEPNESS),
        }
    }

    /// What the fascicles have travelled, L_ce0, by a travel in L_ce0/s and ticks.
    pub(crate) fn lengthening(&self, travel: S) -> S {
        travel.rounded_portion(self.tick)
    }

    /// One tick from `velocity`, in which the tendon, were the fascicles to stay as they are, would
    /// go linearly through `extension` (L_ce0 beyond slack).
    ///
    /// The tendon's extension, not the fascicles' length, carries the state: near slack it is a
    /// small number, and in `f32` a slow motion is not lost in the rounding of a large one.
    #[inline(always)]
    pub(crate) fn advance<R: RecruitmentTick<S, N>, const N: usize>(
        &self,
        velocity: S,
        extension: Course<S>,
        contractile: &Contractile<'_, S, N>,
    ) -> Advanced<S> {
        let tick = Tick {
            contraction: self,
            contractile,
            extension,
            path_speed: extension.change.scaled(&self.tick_rate),
            elastic: contractile.passive_slope.portion(self.substep.half),
        };
        let mut motion = Motion { travel: S::ZERO, velocity };
        // Time since the tick's middle, in ticks.
        let mut time = S::MINUS_HALF + self.substep.half;
        let (mut worst, mut held) = (S::ZERO, false);
        let (mut mean, mut square) = (S::ZERO, S::ZERO);
        for _ in 0..self.substeps {
            let substep = tick.substep::<R>(&mut motion, time, &mut held);
            worst = worst.max(substep.balance.abs());
            mean = mean + substep.step;
            square = square + substep.step * substep.speed.portion(self.per_spread);
            time = time + self.substep.half + self.substep.half;
        }
        Advanced {
            motion,
            speed: Speed {
                mean,
                variance: (square - mean * mean.portion(self.per_spread)).max(S::ZERO),
            },
            settled: worst <= self.settled,
            held,
        }
    }
}

/// What a substep has been like.
struct Passed<S> {
    /// How far the forces were from balance at the predicted velocity, F0.
    balance: S,
    /// The magnitude of its mean velocity, L_ce0/s, and that times its share of the tick.
    speed: S,
    step: S,
}

/// One tick of the mechanics.
struct Tick<'a, S: Scalar, const N: usize> {
    contraction: &'a Contraction<S>,
    contractile: &'a Contractile<'a, S, N>,
    extension: Course<S>,
    /// L_ce0/s.
    path_speed: S,
    /// The passive elements' stiffness times half the substep, F0 s/L_ce0.
    elastic: S,
}

impl<S: Scalar, const N: usize> Tick<'_, S, N> {
    /// One substep about `time`, which starts with `motion` and leaves it as it is at the end.
    #[inline(always)]
    fn substep<R: RecruitmentTick<S, N>>(
        &self,
        motion: &mut Motion<S>,
        time: S::Part,
        held: &mut bool,
    ) -> Passed<S> {
        let (c, element) = (self.contraction, self.contractile);
        let substep = &c.substep;
        let (start, half) = (motion.velocity, substep.half);

        // The tendon where it would be at the velocity foreseen, and as straight as it is there.
        let foreseen = motion.travel + start.portion(half);
        let extension = self.extension.at(time);
        let pull = c.tendon.pull(extension - c.lengthening(foreseen));
        let stiffness = substep.taut.by(pull.tautness);
        let inertia = substep.inertia - substep.fitted.by(pull.tautness);
        // What does not depend on velocity: inertia (V - start) - F_se is this and a slope times V.
        let slope = inertia + stiffness;
        let momentum = slope * start;
        let constant = -(momentum + pull.force);

        let mut gains = element.gains.map(|gain| gain.at(time));
        let passive = element.passive.at(time) + element.passive_slope * motion.travel;
        let mut elastic = self.elastic;

        // The sign of the net force at V = 0 is that of the velocity.
        let mut filaments = sum(&gains);
        let at_rest = least::<S, R, N>(passive) + filaments;
        let lengthening = (at_rest.of_sign(false) + constant).is_negative();
        let velocity = start.of_sign(!lengthening);

        let mut branches = zip(element.fibers, &element.curves, |fiber, curve| {
            fiber.force_velocity.branch(curve, time, lengthening)
        });
        if velocity <= c.slowest {
            cold_path();
            for (index, fiber) in element.fibers.iter().enumerate() {
                if fiber.force_velocity.is_beyond(velocity) {
                    branches[index] = Branch::beyond(velocity);
                    gains[index] = S::ZERO;
                }
            }
            filaments = sum(&gains);
        }
        let reciprocals =
            velocity.reciprocals_of_one_plus(branches.each_ref().map(|branch| branch.denominator));
        let curves = zip(&branches, &reciprocals, |branch, reciprocal| branch.at(*reciprocal));

        // F_ce', what it gains with velocity and time, at that velocity.
        let mut viscosity = c.viscosity;
        let mut force = passive + (viscosity + elastic) * velocity;
        let mut rise = element.passive.change;
        if R::PASSIVE_ONLY_PULLS && force.is_negative() {
            (force, viscosity, elastic, rise) = (S::ZERO, S::ZERO, S::ZERO, S::ZERO);
        }
        // gain FV = gain + secant V of each type, and the change of that.
        let secants = zip(&gains, &curves, |gain, fv| *gain * fv.secant);
        let slopes = zip(&secants, &curves, |secant, fv| *secant * fv.reciprocal);
        let changes = element.gains.map(|gain| gain.change);
        let changing = sum(&zip(&changes, &curves, |change, fv| *change * fv.secant));
        let mut force = force + filaments + sum(&secants) * velocity;
        let mut steepness = sum(&slopes);
        let mut half_curvature = -sum(&zip(&slopes, &curves, |slope, fv| *slope * fv.bend));
        rise = rise + sum(&changes) + changing * velocity;
        if force.is_negative() {
            cold_path();
            (force, viscosity, elastic, rise) = (S::ZERO, S::ZERO, S::ZERO, S::ZERO);
            (steepness, half_curvature) = (S::ZERO, S::ZERO);
        }

        let balance = constant + slope * velocity + force;
        let line = slope + (viscosity + elastic);
        let steepness = steepness.max(c.least_steepness);
        let balanced = balance.hyperbola_root(line, steepness, half_curvature, inertia, viscosity);
        let mut middle = (velocity + balanced.root).of_sign(!lengthening);
        let usual = middle.abs() < c.speed;
        if !usual {
            cold_path();
            middle = if lengthening { c.speed } else { -c.speed };
            *held = true;
        }

        // What pulls at the fascicles ever more, though velocity stay: F0 in half the substep.
        let growing =
            stiffness * (self.path_speed - middle) - elastic * middle - rise.portion(half);
        let left = decay::left(&balanced, middle - start, growing);
        let mean = middle + left.mean;
        let half_step = mean.portion(half);
        let step = half_step + half_step;
        *motion = Motion { travel: motion.travel + step, velocity: middle + left.end };
        Passed { balance, step: step.abs(), speed: mean.abs() }
    }
}

/// The passive force as the mode takes it.
fn least<S: Scalar, R: RecruitmentTick<S, N>, const N: usize>(passive: S) -> S {
    if R::PASSIVE_ONLY_PULLS { passive.of_sign(false) } else { passive }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::PAPER_MUSCLE;

    #[test]
    fn a_taut_tendon_rings_at_its_own_phase() {
        let (mass, stiffness) = (2.0e-5, 153.0);
        let substep = Substep::<f64>::new(0.25e-3, TimeStep::MILLISECOND, mass, stiffness);
        let half = 0.125e-3;
        let inertia = substep.inertia - substep.fitted;
        // The midpoint rule turns the phase by 2 atan(h/2 sqrt(stiffness/mass)).
        let found = (stiffness * half / inertia).sqrt().atan();
        assert!((found - half * (stiffness / mass).sqrt()).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_class_sets_the_substeps_of_a_tick() {
        let count = |class, milliseconds: f64| {
            let step = TimeStep::from_seconds(milliseconds * 1e-3).unwrap();
            let muscle = MuscleParams { class, ..PAPER_MUSCLE };
            substeps(class, step, moving_mass(&muscle), tendon_stiffness(&muscle))
        };
        let counts = [0.1, 0.5, 1.0, 2.0]
            .map(|tick| [Class::Economy, Class::Standard, Class::Fine].map(|c| count(c, tick)));
        assert_eq!(counts, [[1, 1, 1], [1, 4, 5], [1, 4, 10], [2, 8, 20]]);
        // A tendon that is so short that the muscle would ring by more than half a period in a
        // tick.
        let short = tendon_stiffness(&MuscleParams { tendon_length: 0.01, ..PAPER_MUSCLE });
        let mass = moving_mass(&PAPER_MUSCLE);
        assert_eq!(substeps(Class::Economy, TimeStep::MILLISECOND, mass, short), 2);
    }
}
