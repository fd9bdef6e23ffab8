//! The equation of motion of a mass between tendon and fascicles,
//! (m/2) d²x/dt² = F0 (F_se - F_ce'), x = L L_ce0.
//!
//! Active fascicles follow the tendon within 10 to 50 µs; passive fascicles ring on it at about
//! 400 Hz. One implicit midpoint rule covers both cases. Each substep solves the force balance
//! once, at mid-substep, for the mean velocity. The FV branch is chosen by the sign of the net
//! force at V = 0. Around the predicted velocity, FV is replaced by the hyperbola with the same
//! value, slope and curvature; this is exact if only one fibre type is active. The equation left to
//! solve is quadratic, and its root is accurate even if the path velocity jumps.
//!
//! - Ringing: the midpoint rule advances the phase of an oscillation by 2 atan(w h/2) instead of
//!   w h. Inertia is reduced in proportion to the tautness of the tendon, so that on a taut tendon
//!   the phase advances by w h; the energy of the oscillation is conserved.
//! - Damping: with strong damping, the midpoint rule alone makes the velocity error alternate in
//!   sign instead of decaying. [`decay`] corrects this.

use super::decay;
use super::elementwise::{sum, zip};
use crate::domain::FASTEST;
use crate::equations::force_velocity::{Branch, VelocityCurve};
use crate::equations::tendon::Tendon;
use crate::equations::yielding::{SPREAD, Speed};
use crate::fiber::Fiber;
use crate::params::MuscleParams;
use crate::params::class::{Class, Substeps};
use crate::recruitment::RecruitmentTick;
use crate::scalar::cold::cold_path;
use crate::scalar::constant::Constant;
use crate::scalar::float::{square_root, tangent};
use crate::scalar::{Arithmetic, Scalar};
use crate::summed::summed;
use crate::tick::course::Course;
use crate::tick::range::Range;
use crate::tick::time_step::TimeStep;

/// Upper bound of w h in a substep. From half a period (pi) on, no inertia gives the right phase.
const COARSEST_PHASE: f64 = 2.84;
/// Upper bound of the number of substeps; reached only far from human anatomy.
const MOST_SUBSTEPS: u8 = 40;
/// Upper bound of w h/2 in the fit of the inertia. The fitted inertia vanishes at pi/2, and between
/// this bound and pi/2 errors after a force jump grow again.
const FASTEST_RINGING: f64 = 1.1;
/// Largest residual at a predicted velocity at which the mechanics count as settled, F0.
const SETTLED: Constant = Constant::new(0.5);
/// Lower bound on dF_ce/dV, which is a divisor, F0 s/L_ce0: far below any viscosity.
const LEAST_STEEPNESS: Constant = Constant::new(1e-5);
/// Reciprocal of the unit of the variance of speed.
const PER_SPREAD: Constant = Constant::new(1.0 / SPREAD);

/// Motion of the fascicles since the tick's start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<S> {
    /// Change of length, as the constant velocity that would cause it in one tick, L_ce0/s.
    pub(crate) travel: S,
    /// Velocity, L_ce0/s.
    pub(crate) velocity: S,
}

/// Result of a tick of the mechanics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TickResult<S> {
    pub(crate) motion: Motion<S>,
    pub(crate) speed: Speed<S>,
    /// The residuals of all substeps were within the limit.
    pub(crate) settled: bool,
    /// The velocity of a substep was clamped.
    pub(crate) velocity_limited: bool,
}

/// The contractile element during one tick:
/// F_ce' = max(0, passive + Σ gain_i FV_i), forces in F0. Some modes also clamp the passive force
/// to 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contractile<'a, S: Scalar, const N: usize> {
    /// Factor of FV of each type; negative only by rounding.
    pub(crate) gains: [Course<S>; N],
    /// Coefficients of FV of each type.
    pub(crate) fibers: &'a [Fiber<S>; N],
    /// FV of each type during the tick.
    pub(crate) curves: [VelocityCurve<S>; N],
    /// Passive force at V = 0 and the length at the start of the tick.
    pub(crate) passive: Course<S>,
    /// Slope of the passive force, F0 per tick at 1 L_ce0/s.
    pub(crate) passive_slope: S,
}

summed! {
    /// Coefficients of the mechanics.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Contraction<S: Scalar> {
        pub(crate) tendon: Tendon<S>,
        /// eta, F0 s/L_ce0.
        viscosity: S,
        substep: Substep<S>,
        /// Number of substeps in a tick.
        substeps: u8,
        /// A tick, s.
        tick: S::Part,
        /// Ticks per second.
        tick_rate: S::Factor,
        /// V_max of the slowest type, L_ce0/s.
        slowest: S,
    }

    valid: |contraction| {
        (1..=MOST_SUBSTEPS).contains(&contraction.substeps) && contraction.viscosity > S::ZERO
    }
}

summed! {
    /// Coefficients of a substep of a given length.
    #[derive(Clone, Copy, Debug)]
    struct Substep<S: Scalar> {
        /// Half a substep, in ticks.
        half: S::Part,
        /// Mass over half the substep, F0 s/L_ce0.
        inertia: S,
        /// Reduction of the inertia on a taut tendon, F0 s/L_ce0.
        fitted: S,
        /// Stiffness of the taut tendon times half the substep, F0 s/L_ce0.
        taut: S,
    }

    valid: |substep| {
        let share = Range { least: S::ZERO, most: substep.inertia };
        substep.inertia > S::ZERO && share.contains(substep.fitted) && substep.taut > S::ZERO
    }
}

impl<S: Scalar> Substep<S> {
    /// A substep of `seconds`, for a mass in F0 s²/L_ce0 on a taut tendon in F0/L_ce0.
    fn new(seconds: f64, step: TimeStep, mass: f64, stiffness: f64) -> Self {
        let half = 0.5 * seconds;
        let inertia = mass / half;
        // Half the phase of the ringing in a substep. The midpoint rule gives its tangent.
        let phase = Arithmetic::min(half * square_root(stiffness / mass), FASTEST_RINGING);
        let share = phase / tangent(phase);
        Self {
            half: S::part(half / step.seconds()),
            inertia: S::from_f64(inertia),
            fitted: S::from_f64(inertia * (1.0 - share * share)),
            taut: S::from_f64(stiffness * half),
        }
    }
}

/// Name, in errors, of a derived quantity with a limit in fixed point.
pub(crate) const INERTIA: &str = "fascicle_length: inertia in a substep, F0 s/L_ce0";

/// The moving mass, half that of the muscle, F0 s²/L_ce0.
fn moving_mass<const N: usize>(params: &MuscleParams<N>) -> f64 {
    0.5 * params.mass * params.fascicle_length / params.max_isometric_force()
}

/// Stiffness of the taut tendon, F0/L_ce0.
fn tendon_stiffness<const N: usize>(params: &MuscleParams<N>) -> f64 {
    params.elements.tendon.stiffness * params.fascicle_length / params.tendon_length
}

/// Inertia in a substep, the largest coefficient of the mechanics, F0 s/L_ce0.
pub(crate) fn largest_inertia<const N: usize>(params: &MuscleParams<N>, step: TimeStep) -> f64 {
    let mass = moving_mass(params);
    2.0 * mass * f64::from(substeps(params.class, step, mass, tendon_stiffness(params)))
        / step.seconds()
}

/// Number of substeps in a tick, for an accuracy class, a mass (F0 s²/L_ce0) and a tendon stiffness
/// (F0/L_ce0).
fn substeps(class: Class, step: TimeStep, mass: f64, stiffness: f64) -> u8 {
    // Squares avoid roots: w² = stiffness/mass and A² = stiffness mass.
    let square = |x: f64| x * x;
    let (frequency, amplitude) = (stiffness / mass, stiffness * mass);
    let Substeps { longest, ringing, single } = class.substeps(step);
    (1..MOST_SUBSTEPS)
        .find(|&count| {
            let substep = step.seconds() / f64::from(count);
            substep <= longest * (1.0 + 1e-9)
                && (count > 1 || amplitude <= square(single))
                && square(substep / COARSEST_PHASE) * frequency <= 1.0
                && square(square(substep / ringing) * frequency) * amplitude <= 1.0
        })
        .unwrap_or(MOST_SUBSTEPS)
}

impl<S: Scalar> Contraction<S> {
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
            slowest: S::from_f64(params.shortening_velocity()),
        }
    }

    /// Change of length (L_ce0) at a velocity (L_ce0/s) constant during a tick.
    pub(crate) fn lengthening(&self, travel: S) -> S {
        travel.rounded_portion(self.tick)
    }

    /// Extension (L_ce0) after a tick in which the path stretched it by `stretch` and the fascicles
    /// lengthened with the velocity `travel`.
    #[inline(always)]
    pub(crate) fn stretched(&self, extension: S::Wide, stretch: S, travel: S) -> S::Wide {
        S::stretched(extension, stretch, travel, self.tick)
    }

    /// Integrates one tick, starting with `velocity`. `extension` is that of the tendon at constant
    /// fascicle length (L_ce0 beyond slack), linear during the tick.
    ///
    /// The state is the extension of the tendon, not the length of the fascicles: extensions are
    /// small near slack, so that in `f32` slow motion is not lost to rounding.
    #[inline(always)]
    pub(crate) fn advance<R: RecruitmentTick<S, N>, const N: usize>(
        &self,
        velocity: S,
        extension: Course<S>,
        contractile: &Contractile<'_, S, N>,
    ) -> TickResult<S> {
        let tick = Tick {
            contraction: self,
            contractile,
            extension,
            path_speed: extension.change.scaled(&self.tick_rate),
            elastic: contractile.passive_slope.portion(self.substep.half),
        };
        let mut motion = Motion { travel: S::ZERO, velocity };
        // Time since mid-tick, in ticks.
        let mut time = S::MINUS_HALF + self.substep.half;
        let (mut largest_residual, mut velocity_limited) = (S::ZERO, false);
        let (mut mean, mut square) = (S::ZERO, S::ZERO);
        let per_spread = S::part_constant(&PER_SPREAD);
        for _ in 0..self.substeps {
            let substep = tick.substep::<R>(&mut motion, time, &mut velocity_limited);
            largest_residual = largest_residual.max(substep.residual.abs());
            mean = mean + substep.distance;
            square = square + substep.distance * substep.speed.portion(per_spread);
            time = time + self.substep.half + self.substep.half;
        }
        TickResult {
            motion,
            speed: Speed {
                mean,
                variance: (square - mean * mean.portion(per_spread)).max(S::ZERO),
            },
            settled: largest_residual <= S::constant(&SETTLED),
            velocity_limited,
        }
    }
}

/// Result of a substep.
struct SubstepResult<S> {
    /// Residual of the force balance at the predicted velocity, F0.
    residual: S,
    /// Magnitude of the mean velocity, L_ce0/s.
    speed: S,
    /// Magnitude of the change of length, as a velocity times ticks, L_ce0/s.
    distance: S,
}

/// One tick of the mechanics.
struct Tick<'a, S: Scalar, const N: usize> {
    contraction: &'a Contraction<S>,
    contractile: &'a Contractile<'a, S, N>,
    extension: Course<S>,
    /// Velocity of the path, L_ce0/s.
    path_speed: S,
    /// Stiffness of the passive elements times half the substep, F0 s/L_ce0.
    elastic: S,
}

impl<S: Scalar, const N: usize> Tick<'_, S, N> {
    /// Integrates one substep with its middle at `time`; advances `motion` from start to end.
    #[inline(always)]
    fn substep<R: RecruitmentTick<S, N>>(
        &self,
        motion: &mut Motion<S>,
        time: S::Part,
        velocity_limited: &mut bool,
    ) -> SubstepResult<S> {
        let (c, element) = (self.contraction, self.contractile);
        let substep = &c.substep;
        let (start, half) = (motion.velocity, substep.half);

        // Tendon force and stiffness at the predicted mid-substep length.
        let predicted_travel = motion.travel + start.portion(half);
        let extension = self.extension.at(time);
        let pull = c.tendon.pull(extension - c.lengthening(predicted_travel));
        let stiffness = substep.taut.by(pull.tautness);
        let inertia = substep.inertia - substep.fitted.by(pull.tautness);
        // inertia (V - start) - F_se = constant + slope V.
        let slope = inertia + stiffness;
        let momentum = slope * start;
        let constant = -(momentum + pull.force);

        let mut gains = element.gains.map(|gain| gain.at(time));
        let passive = element.passive.at(time) + motion.travel.times(element.passive_slope);
        let mut elastic = self.elastic;

        // The FV branch is chosen by the sign of the net force at V = 0, which is that of the
        // velocity. A predicted velocity of the other sign is replaced by 0.
        let mut filaments = sum(&gains);
        let isometric = passive_force::<S, R, N>(passive) + filaments;
        let lengthening = (isometric.of_sign(false) + constant).is_negative();
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

        // F_ce' at the predicted velocity, its slopes, and its change in a tick.
        let mut viscosity = c.viscosity;
        let mut force = passive + velocity.times(viscosity + elastic);
        let mut rise = element.passive.change;
        if R::PASSIVE_ONLY_PULLS && force.is_negative() {
            (force, viscosity, elastic, rise) = (S::ZERO, S::ZERO, S::ZERO, S::ZERO);
        }
        // gain FV = gain + secant V of each type, and the change of their sum in a tick.
        let secants = zip(&gains, &curves, |gain, fv| *gain * fv.secant);
        let mut force = force + filaments + velocity.times(sum(&secants));
        let slopes = zip(&secants, &curves, |secant, fv| *secant * fv.reciprocal);
        let mut steepness = sum(&slopes);
        let mut half_curvature = -sum(&zip(&slopes, &curves, |slope, fv| *slope * fv.bend));
        let changes = element.gains.map(|gain| gain.change);
        let changing = sum(&zip(&changes, &curves, |change, fv| *change * fv.secant));
        rise = rise + sum(&changes) + changing * velocity;
        if force.is_negative() {
            cold_path();
            (force, viscosity, elastic, rise) = (S::ZERO, S::ZERO, S::ZERO, S::ZERO);
            (steepness, half_curvature) = (S::ZERO, S::ZERO);
        }

        let residual = constant + slope * velocity + force;
        let line = slope + (viscosity + elastic);
        let steepness = steepness.max(S::constant(&LEAST_STEEPNESS));
        let balance = residual.hyperbola_root(line, steepness, half_curvature, inertia, viscosity);
        let mut middle = (velocity + balance.root).of_sign(!lengthening);
        let fastest = S::constant(&FASTEST);
        let in_range = middle.abs() < fastest;
        if !in_range {
            cold_path();
            middle = if lengthening { fastest } else { -fastest };
            *velocity_limited = true;
        }

        // Change of net force per half-substep at constant velocity.
        let force_change =
            stiffness * (self.path_speed - middle) - elastic * middle - rise.portion(half);
        let offsets = decay::offsets(&balance, middle - start, force_change);
        let mean = middle + offsets.mean;
        let half_step = mean.portion(half);
        let step = half_step + half_step;
        *motion = Motion { travel: motion.travel + step, velocity: middle + offsets.end };
        SubstepResult { residual, speed: mean.abs(), distance: step.abs() }
    }
}

/// The passive force; clamped to 0 if the mode says so.
fn passive_force<S: Scalar, R: RecruitmentTick<S, N>, const N: usize>(passive: S) -> S {
    if R::PASSIVE_ONLY_PULLS { passive.of_sign(false) } else { passive }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::presets::PAPER_MUSCLE;

    #[test]
    fn on_a_taut_tendon_a_substep_advances_the_phase_by_w_h() {
        let (mass, stiffness) = (2.0e-5, 153.0);
        let substep = Substep::<f64>::new(0.25e-3, TimeStep::MILLISECOND, mass, stiffness);
        let half = 0.125e-3;
        let inertia = substep.inertia - substep.fitted;
        // The midpoint rule advances the phase by 2 atan(h/2 sqrt(stiffness/mass)).
        let found = (stiffness * half / inertia).sqrt().atan();
        assert!((found - half * (stiffness / mass).sqrt()).abs() < 1e-12, "{found}");
    }

    #[test]
    fn number_of_substeps_by_class_and_tick() {
        let count = |class, milliseconds: f64| {
            let step = TimeStep::from_seconds(milliseconds * 1e-3).unwrap();
            let muscle = MuscleParams { class, ..PAPER_MUSCLE };
            substeps(class, step, moving_mass(&muscle), tendon_stiffness(&muscle))
        };
        let counts = [0.1, 0.5, 1.0, 2.0]
            .map(|tick| [Class::Economy, Class::Standard, Class::Fine].map(|c| count(c, tick)));
        assert_eq!(counts, [[1, 1, 2], [1, 4, 8], [1, 4, 16], [2, 8, 32]]);
        // On a tendon this short the muscle would ring by more than half a period in a tick.
        let short = tendon_stiffness(&MuscleParams { tendon_length: 0.01, ..PAPER_MUSCLE });
        let mass = moving_mass(&PAPER_MUSCLE);
        assert_eq!(substeps(Class::Economy, TimeStep::MILLISECOND, mass, short), 2);
    }

    /// Ringing at 1,000 rad/s. Up to 0.06 F0 the economy class takes one substep. An amplitude of
    /// 1 F0 allows substeps of 0.35 and 0.15 ms; one of 16 F0, with the square of its root, a
    /// quarter of that.
    #[test]
    fn the_more_a_muscle_rings_the_more_substeps_it_takes() {
        let count = |class, amplitude: f64| {
            substeps(class, TimeStep::MILLISECOND, 1e-3 * amplitude, 1e3 * amplitude)
        };
        let counts = |class| [0.059, 0.061, 1.0, 16.0].map(|amplitude| count(class, amplitude));
        assert_eq!(counts(Class::Economy), [1, 2, 2, 2]);
        assert_eq!(counts(Class::Standard), [4, 4, 4, 12]);
        assert_eq!(counts(Class::Fine), [16, 16, 16, 27]);
    }

    #[test]
    fn the_largest_coefficient_is_the_inertia_in_a_substep() {
        for class in [Class::Economy, Class::Standard, Class::Fine] {
            for milliseconds in [0.1, 1.0, 2.0] {
                let step = TimeStep::from_seconds(milliseconds * 1e-3).unwrap();
                let muscle = MuscleParams { class, ..PAPER_MUSCLE };
                let built = Contraction::<f64>::new(&muscle, step).substep.inertia;
                let found = largest_inertia(&muscle, step);
                assert!((found / built - 1.0).abs() < 1e-12, "{class:?} {step:?}: {found}");
            }
        }
    }
}
